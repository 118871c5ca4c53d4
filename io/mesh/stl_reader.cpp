#include "io/mesh/stl_reader.hpp"

#include "core/base/errors.hpp"
#include "io/mesh/text_numbers.hpp"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace fascia::io {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is read as it lies in memory");

/// A header of any bytes, the number of triangles, and of each its normal, corners and two more bytes.
constexpr std::size_t kStartOfText = 512;
constexpr std::size_t kHeader = 80, kStart = kHeader + sizeof(std::uint32_t), kTriangle = 50, kNormal = 12;

class StlParser {
 public:
  StlParser(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {
    points_->SetDataTypeToDouble();
  }

  vtkSmartPointer<vtkDataSet> parse(std::vector<std::string>& messages) {
    const BareText bare(bytes_);
    if (is_binary(bare.text)) {
      parse_binary();
    } else {
      bare.report(name_, messages);
      bytes_ = bare.text;
      parse_text();
    }
    const auto mesh = vtkSmartPointer<vtkPolyData>::New();
    mesh->SetPoints(points_);
    mesh->SetPolys(faces_);
    return mesh;
  }

 private:
  template <class T>
  T at(std::size_t place) const {
    T value;
    std::memcpy(&value, bytes_.data() + place, sizeof value);
    return value;
  }

  /// Some binary files begin with "solid" too: their length tells them apart, or the words of a first triangle, or a
  /// zero byte, which no text should have.
  /// @param text  the file, if it is text
  bool is_binary(std::string_view text) const {
    if (bytes_.size() >= kStart && bytes_.size() == kStart + kTriangle * at<std::uint32_t>(kHeader)) return true;
    const std::string_view start = text.substr(0, kStartOfText);
    if (start.find("facet") != std::string_view::npos && start.find("vertex") != std::string_view::npos) return false;
    if (text.find('\0') != std::string_view::npos) return true;
    const std::size_t begin = text.find_first_not_of(" \t\r\n");
    if (begin == std::string_view::npos) return false;
    return !is_word(text.substr(begin, 5), "solid");
  }

  void parse_binary() {
    const std::size_t count = bytes_.size() < kStart ? 0 : at<std::uint32_t>(kHeader);
    const std::size_t there = bytes_.size() < kStart ? 0 : (bytes_.size() - kStart) / kTriangle;
    if (bytes_.size() < kStart || there != count)  // fewer bytes than a triangle may follow
      throw InputError(name_ + ": is no readable .stl mesh (it should hold " + std::to_string(count) +
                       " triangles and holds " + std::to_string(there) +
                       "); it may be cut off or of another format: write it again");
    for (std::size_t t = 0; t < count; ++t) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        std::array<double, 3> x{};
        for (std::size_t c = 0; c < 3; ++c)
          x[c] = at<float>(kStart + kTriangle * t + kNormal + sizeof(float) * (3 * corner + c));
        if (!std::isfinite(x[0] + x[1] + x[2]))
          throw InputError(name_ + ": a coordinate of triangle " + std::to_string(t + 1) +
                           " is not finite; write the file again");
        points_->InsertNextPoint(x.data());
      }
      add_triangle();
    }
  }

  void parse_text() {
    for (std::string_view word = keyword(); !word.empty(); word = keyword()) {
      if (is_word(word, "solid") || is_word(word, "endsolid")) {
        ends_ = word.size() > std::string_view("solid").size();
        skip_line();  // a name of any words
      } else if (is_word(word, "facet")) {
        expect("normal");
        for (int c = 0; c < 3; ++c) next();  // follows from the corners
        expect("outer");
        expect("loop");
        for (int corner = 0; corner < 3; ++corner) add_corner();
        expect("endloop");
        expect("endfacet");
        add_triangle();
      } else {
        fail("found " + quoted(word) + "; must be facet or endsolid");
      }
    }
    if (!ends_) fail("the file ends without endsolid: it may be cut off; write it again");
  }

  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(name_ + ":" + std::to_string(line_) + ": " + message);
  }

  static bool is_word(std::string_view word, std::string_view lower_case) {
    if (word.size() != lower_case.size()) return false;
    for (std::size_t i = 0; i < word.size(); ++i) {
      const char c = word[i] >= 'A' && word[i] <= 'Z' ? static_cast<char>(word[i] - 'A' + 'a') : word[i];
      if (c != lower_case[i]) return false;
    }
    return true;
  }

  /// The next word, whatever line it is on; nothing at the end.
  std::string_view next() {
    for (; place_ < bytes_.size() && is_blank(bytes_[place_]); ++place_)
      if (bytes_[place_] == '\n') ++line_;
    const std::size_t begin = place_;
    while (place_ < bytes_.size() && !is_blank(bytes_[place_])) ++place_;
    return bytes_.substr(begin, place_ - begin);
  }

  /// The next word; one that is written in two, as "end solid", in one.
  std::string_view keyword() {
    const std::string_view word = next();
    if (!is_word(word, "end")) return word;
    const std::string_view what = next();
    for (const std::string_view ending : {"endsolid", "endfacet", "endloop"})
      if (is_word(what, ending.substr(3))) return ending;
    fail("found \"end\" and then " + said(what) + "; must be endsolid, endfacet or endloop");
  }

  void skip_line() { place_ = line_end(bytes_, place_).end; }

  static std::string said(std::string_view word) { return word.empty() ? "the end of the file" : quoted(word); }

  void expect(std::string_view wanted) {
    const std::string_view word = keyword();
    if (!is_word(word, wanted)) fail("found " + said(word) + "; must be " + std::string(wanted));
  }

  void add_corner() {
    expect("vertex");
    std::array<double, 3> x{};
    for (double& value : x) {
      const std::string_view word = next();
      const std::optional<double> number = to_number(word);
      if (!number) fail("expected a coordinate, found " + said(word) + "; must be a finite number");
      value = *number;
    }
    points_->InsertNextPoint(x.data());
  }

  /// Makes a triangle of the last three points.
  void add_triangle() {
    const vtkIdType count = points_->GetNumberOfPoints();
    const std::array<vtkIdType, 3> corners{count - 3, count - 2, count - 1};
    faces_->InsertNextCell(3, corners.data());
  }

  std::string_view bytes_;
  std::string name_;
  std::size_t place_ = 0;
  int line_ = 1;
  bool ends_ = false;  ///< the last solid of a text is complete
  vtkNew<vtkPoints> points_;
  vtkNew<vtkCellArray> faces_;
};

}  // namespace

vtkSmartPointer<vtkDataSet> parse_stl(std::string_view bytes, const std::string& name,
                                      std::vector<std::string>& messages) {
  return StlParser(bytes, name).parse(messages);
}

}  // namespace fascia::io
