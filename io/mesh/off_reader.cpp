#include "io/mesh/off_reader.hpp"

#include "core/base/errors.hpp"
#include "io/mesh/text_numbers.hpp"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <array>

namespace fascia::io {
namespace {

class OffParser {
 public:
  OffParser(std::string_view text, const std::string& name) : text_(text), name_(name) {
    points_->SetDataTypeToDouble();
  }

  vtkSmartPointer<vtkDataSet> parse() {
    next_line();
    read_header();
    if (words_.empty()) next_line();
    constexpr std::int64_t shortest = 6;  // "0 0 0" and the end of the line
    const std::int64_t vertices = count(0, "vertices", shortest), faces = count(1, "faces", shortest);
    for (std::int64_t v = 0; v < vertices; ++v) read_vertex(v);
    for (std::int64_t f = 0; f < faces; ++f) read_face(f, vertices);
    next_line();
    if (!words_.empty())
      fail("found " + quoted(words_[0]) + " behind the last face; correct the numbers of vertices and faces");
    const auto mesh = vtkSmartPointer<vtkPolyData>::New();
    mesh->SetPoints(points_);
    mesh->SetPolys(faces_);
    return mesh;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(name_ + ":" + std::to_string(line_) + ": " + message);
  }

  /// Words of the next line that has any, without its comment; none at the end.
  void next_line() {
    words_.clear();
    while (words_.empty() && place_ < text_.size()) {
      const LineEnd at = line_end(text_, place_);
      std::string_view line = text_.substr(place_, at.end - place_);
      place_ = at.next;
      ++line_;
      line = line.substr(0, line.find('#'));
      for (std::size_t begin = 0, stop = 0; begin < line.size(); begin = stop) {
        while (begin < line.size() && is_blank(line[begin])) ++begin;
        for (stop = begin; stop < line.size() && !is_blank(line[stop]);) ++stop;
        if (stop > begin) words_.push_back(line.substr(begin, stop - begin));
      }
    }
  }

  /// Takes the word OFF off the line, with what it says of the vertices; the numbers may follow it at once ("OFF8 6
  /// 0").
  void read_header() {
    if (words_.empty()) fail("the file is empty; must start with OFF");
    const std::size_t off = words_[0].find("OFF");
    if (off == std::string_view::npos) {
      if (!to_integer(words_[0])) fail("is no OFF mesh: found " + quoted(words_[0]) + "; must start with OFF");
      return;
    }
    const std::string_view kind = words_[0].substr(0, off);
    constexpr std::array<std::string_view, 8> known{"", "C", "N", "CN", "ST", "STC", "STN", "STCN"};
    if (std::find(known.begin(), known.end(), kind) == known.end())
      fail("files of the kind " + quoted(words_[0]) + " are not supported; save three coordinates a vertex, as OFF");
    words_[0].remove_prefix(off + 3);
    if (words_[0].empty()) words_.erase(words_.begin());
    if (!words_.empty() && words_[0] == "BINARY") fail("binary files are not supported; save as ASCII");
  }

  /// A number of the line that is read.
  std::int64_t count(std::size_t word, const char* what, std::int64_t shortest) const {
    const std::optional<std::int64_t> number = word < words_.size() ? to_integer(words_[word]) : std::nullopt;
    if (!number || *number < 0)
      fail(std::string("expected the number of ") + what + ", found " + found(word) + "; must be a whole number");
    if (*number > static_cast<std::int64_t>(text_.size()) / shortest)
      fail(std::string("the number of ") + what + " is " + std::to_string(*number) + ", but the file has only " +
           std::to_string(text_.size()) + " bytes; it is cut off or the number is wrong: write it again");
    return *number;
  }

  std::string found(std::size_t word) const {
    return word < words_.size() ? quoted(words_[word]) : words_.empty() ? "the end of the file" : "the end of the line";
  }

  void read_vertex(std::int64_t number) {
    next_line();
    std::array<double, 3> x{};
    for (std::size_t c = 0; c < 3; ++c) {
      const std::optional<double> value = c < words_.size() ? to_number(words_[c]) : std::nullopt;
      if (!value)
        fail("expected a coordinate of vertex " + std::to_string(number) + ", found " + found(c) +
             "; must be a finite number");
      x[c] = *value;
    }
    points_->InsertNextPoint(x.data());
  }

  /// The number of its vertices, these, and perhaps a colour.
  void read_face(std::int64_t face, std::int64_t vertices) {
    next_line();
    const std::string name = "face " + std::to_string(face);
    const std::optional<std::int64_t> size = words_.empty() ? std::nullopt : to_integer(words_[0]);
    if (!size) fail("expected the number of vertices of " + name + ", found " + found(0) + "; must be a whole number");
    if (*size < 3) fail(name + " has " + std::to_string(*size) + " vertices; must have at least 3");
    std::vector<vtkIdType> corners;
    for (std::size_t w = 1; corners.size() < static_cast<std::size_t>(*size); ++w) {
      const std::optional<std::int64_t> vertex = w < words_.size() ? to_integer(words_[w]) : std::nullopt;
      if (!vertex) fail("expected a vertex of " + name + ", found " + found(w) + "; must be a whole number");
      if (*vertex < 0 || *vertex >= vertices)
        fail(name + " uses vertex " + std::to_string(*vertex) + ", but there are " + std::to_string(vertices) +
             ", counted from 0; correct the face");
      corners.push_back(*vertex);
    }
    faces_->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.data());
  }

  std::string_view text_;
  std::string name_;
  std::size_t place_ = 0;
  int line_ = 0;
  std::vector<std::string_view> words_;
  vtkNew<vtkPoints> points_;
  vtkNew<vtkCellArray> faces_;
};

}  // namespace

vtkSmartPointer<vtkDataSet> parse_off(std::string_view text, const std::string& name,
                                      std::vector<std::string>& messages) {
  const BareText bare(text);
  bare.report(name, messages);
  return OffParser(bare.text, name).parse();
}

}  // namespace fascia::io
