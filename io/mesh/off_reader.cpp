#include "io/mesh/off_reader.hpp"

#include "io/mesh/text_lines.hpp"
#include "io/mesh/text_numbers.hpp"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <array>

namespace fascia::io {
namespace {

/// Takes the word OFF off the line, with what it says of the vertices; the numbers may follow it at once ("OFF8 6
/// 0").
void read_header(TextLines& lines) {
  std::vector<std::string_view>& words = lines.words();
  if (words.empty()) lines.fail("the file is empty; must start with OFF");
  const std::size_t off = words[0].find("OFF");
  if (off == std::string_view::npos) {
    if (!to_integer(words[0])) lines.fail("is no OFF mesh: found " + quoted(words[0]) + "; must start with OFF");
    return;
  }
  const std::string_view kind = words[0].substr(0, off);
  constexpr std::array<std::string_view, 8> known{"", "C", "N", "CN", "ST", "STC", "STN", "STCN"};
  if (std::find(known.begin(), known.end(), kind) == known.end())
    lines.fail("files of the kind " + quoted(words[0]) + " are not supported; save three coordinates a vertex, as OFF");
  words[0].remove_prefix(off + 3);
  if (words[0].empty()) words.erase(words.begin());
  if (!words.empty() && words[0] == "BINARY") lines.fail("binary files are not supported; save as ASCII");
}

/// The number of its vertices, these, and perhaps a colour.
std::vector<vtkIdType> read_face(const TextLines& lines, const std::string& name, std::int64_t vertices) {
  const std::optional<std::int64_t> size = lines.words().empty() ? std::nullopt : to_integer(lines.words()[0]);
  if (!size)
    lines.fail("expected the number of vertices of " + name + ", found " + lines.found(0) + "; must be a whole number");
  if (*size < 3) lines.fail(name + " has " + std::to_string(*size) + " vertices; must have at least 3");
  std::vector<vtkIdType> corners;
  for (std::size_t w = 1; corners.size() < static_cast<std::size_t>(*size); ++w)
    corners.push_back(lines.vertex(w, name, vertices));
  return corners;
}

}  // namespace

vtkSmartPointer<vtkDataSet> parse_off(std::string_view text, const std::string& name,
                                      std::vector<std::string>& messages) {
  const BareText bare(text);
  bare.report(name, messages);
  TextLines lines(bare.text, name, '#');
  lines.next();
  read_header(lines);
  if (lines.words().empty()) lines.next();
  constexpr std::int64_t shortest = 6;  // "0 0 0" and the end of the line
  const std::int64_t vertices = lines.count(0, "vertices", shortest), faces = lines.count(1, "faces", shortest);
  const vtkNew<vtkPoints> points;
  const vtkNew<vtkCellArray> cells;
  points->SetDataTypeToDouble();
  for (std::int64_t v = 0; v < vertices; ++v) {
    lines.next();
    const std::string vertex = "vertex " + std::to_string(v);
    points->InsertNextPoint(lines.coordinate(0, vertex), lines.coordinate(1, vertex), lines.coordinate(2, vertex));
  }
  for (std::int64_t f = 0; f < faces; ++f) {
    lines.next();
    const std::vector<vtkIdType> corners = read_face(lines, "face " + std::to_string(f), vertices);
    cells->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.data());
  }
  if (lines.next())
    lines.fail("found " + lines.found(0) + " behind the last face; correct the numbers of vertices and faces");
  const auto mesh = vtkSmartPointer<vtkPolyData>::New();
  mesh->SetPoints(points);
  mesh->SetPolys(cells);
  return mesh;
}

}  // namespace fascia::io
