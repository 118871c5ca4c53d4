#include "io/mesh/obj_reader.hpp"

#include "core/base/errors.hpp"
#include "io/mesh/text_numbers.hpp"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <array>
#include <vector>

namespace fascia::io {
namespace {

/// Statements that say nothing of the shape.
constexpr std::array<std::string_view, 16> ignored{"vt",     "vn",     "vp",         "g",        "o",      "s",
                                                   "l",      "p",      "lod",        "mg",       "usemtl", "mtllib",
                                                   "usemap", "maplib", "shadow_obj", "trace_obj"};

class ObjParser {
 public:
  ObjParser(std::string_view text, const std::string& name) : text_(text), name_(name) {
    points_->SetDataTypeToDouble();
  }

  vtkSmartPointer<vtkDataSet> parse() {
    std::vector<std::string_view> words;
    while (next_statement(words)) {
      if (words.empty()) continue;
      if (words[0] == "v")
        add_vertex(words);
      else if (words[0] == "f")
        add_face(words);
      else if (std::find(ignored.begin(), ignored.end(), words[0]) == ignored.end())
        fail(quoted(words[0]) + " is no statement of an OBJ file; write the file again");
    }
    const auto mesh = vtkSmartPointer<vtkPolyData>::New();
    mesh->SetPoints(points_);
    mesh->SetPolys(faces_);
    return mesh;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(name_ + ":" + std::to_string(line_) + ": " + message);
  }

  /// The words of a line, and of those that it continues on, without its comment; false at the end.
  bool next_statement(std::vector<std::string_view>& words) {
    words.clear();
    if (place_ >= text_.size()) return false;
    line_ = next_line_;
    for (bool continued = true; continued && place_ < text_.size();) {
      const LineEnd at = line_end(text_, place_);
      std::string_view line = text_.substr(place_, at.end - place_);
      place_ = at.next;
      ++next_line_;
      line = line.substr(0, line.find('#'));
      while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
      continued = !line.empty() && line.back() == '\\';
      if (continued) line.remove_suffix(1);
      split(line, words);
    }
    return true;
  }

  static void split(std::string_view line, std::vector<std::string_view>& words) {
    std::size_t place = 0;
    while (true) {
      while (place < line.size() && is_blank(line[place])) ++place;
      const std::size_t begin = place;
      while (place < line.size() && !is_blank(line[place])) ++place;
      if (place == begin) return;
      words.push_back(line.substr(begin, place - begin));
    }
  }

  void add_vertex(const std::vector<std::string_view>& words) {
    std::array<double, 3> x{};
    for (std::size_t c = 0; c < 3; ++c) {
      const std::optional<double> value = c + 1 < words.size() ? to_number(words[c + 1]) : std::nullopt;
      if (!value)
        fail("expected a coordinate, found " +
             (c + 1 < words.size() ? quoted(words[c + 1]) : std::string("the end of the line")) +
             "; must be a finite number");
      x[c] = *value;
    }
    points_->InsertNextPoint(x.data());
  }

  /// Words of the form vertex, vertex/texture, vertex//normal or vertex/texture/normal; vertices count from 1, or
  /// backwards from −1.
  void add_face(const std::vector<std::string_view>& words) {
    if (words.size() < 4) fail("a face has " + std::to_string(words.size() - 1) + " vertices; must have at least 3");
    const std::int64_t count = points_->GetNumberOfPoints();
    std::vector<vtkIdType> corners;
    for (std::size_t w = 1; w < words.size(); ++w) {
      const std::string_view word = words[w].substr(0, words[w].find('/'));
      const std::optional<std::int64_t> number = to_integer(word);
      if (!number) fail("expected a vertex number, found " + quoted(words[w]) + "; must be a whole number");
      if (*number == 0 || *number > count || *number < -count)
        fail("a face uses vertex " + std::to_string(*number) + ", but there are " + std::to_string(count) +
             " up to here; correct the face");
      corners.push_back(*number > 0 ? *number - 1 : count + *number);
    }
    faces_->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.data());
  }

  std::string_view text_;
  std::string name_;
  std::size_t place_ = 0;
  int line_ = 0, next_line_ = 1;
  vtkNew<vtkPoints> points_;
  vtkNew<vtkCellArray> faces_;
};

}  // namespace

vtkSmartPointer<vtkDataSet> parse_obj(std::string_view text, const std::string& name,
                                      std::vector<std::string>& messages) {
  const BareText bare(text);
  bare.report(name, messages);
  return ObjParser(bare.text, name).parse();
}

}  // namespace fascia::io
