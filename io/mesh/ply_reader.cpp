#include "io/mesh/ply_reader.hpp"

#include "core/base/errors.hpp"
#include "io/mesh/ply_header.hpp"
#include "io/mesh/text_numbers.hpp"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

namespace fascia::io {
namespace {

/// The numbers of a binary file, one after the other.
class PlyBytes {
 public:
  PlyBytes(std::string_view bytes, std::string name, bool little)
      : rest_(bytes), name_(std::move(name)), swapped_(little != (std::endian::native == std::endian::little)) {}

  /// @param of  whose number it is, for messages
  double take(const PlyType& type, const std::string& of) {
    if (rest_.size() < type.size) fail("ends within " + of + "; it is cut off: write it again");
    std::array<char, sizeof(double)> bytes{};
    const auto end = std::copy_n(rest_.begin(), type.size, bytes.begin());
    if (swapped_) std::reverse(bytes.begin(), end);
    rest_.remove_prefix(type.size);
    return type.value(bytes.data());
  }
  std::size_t left() const { return rest_.size(); }
  [[noreturn]] void fail(const std::string& message) const { throw InputError(name_ + ": " + message); }

 private:
  std::string_view rest_;
  std::string name_;
  bool swapped_;
};

class PlyParser {
 public:
  PlyParser(TextLines& lines, PlyHeader header, PlyBytes* bytes)
      : lines_(lines), header_(std::move(header)), bytes_(bytes) {
    points_->SetDataTypeToDouble();
  }

  vtkSmartPointer<vtkDataSet> parse() {
    for (const PlyElement& element : header_.elements) read(element);
    if (bytes_ == nullptr && lines_.next())
      lines_.fail("found " + lines_.found(0) + " behind the last element; correct the numbers of the header");
    const auto mesh = vtkSmartPointer<vtkPolyData>::New();
    mesh->SetPoints(points_);
    mesh->SetPolys(faces_);
    return mesh;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    if (bytes_ != nullptr) bytes_->fail(message);
    lines_.fail(message);
  }

  void read(const PlyElement& element) {
    const bool vertices = element.name == "vertex", faces = element.name == "face";
    std::array<std::size_t, 3> x{};
    std::size_t corners = 0;
    if (vertices) x = {place_of(element, {"x"}), place_of(element, {"y"}), place_of(element, {"z"})};
    if (faces) corners = place_of(element, {"vertex_indices", "vertex_index"});
    for (std::int64_t k = 0; k < element.count; ++k) {
      const std::string name = element.name + " " + std::to_string(k);
      if (bytes_ != nullptr)
        take_bytes(element, name);
      else
        take_line(element, name);
      if (vertices) add_vertex(name, x);
      if (faces) add_face(name, corners);
    }
  }

  /// The number of the property of one of these names.
  std::size_t place_of(const PlyElement& element, std::initializer_list<std::string_view> names) const {
    for (std::size_t k = 0; k < element.properties.size(); ++k)
      if (std::find(names.begin(), names.end(), element.properties[k].name) != names.end()) return k;
    fail("the header gives a " + element.name + " no property " + std::string(*names.begin()) +
         "; write the file again");
  }

  void take_bytes(const PlyElement& element, const std::string& name) {
    values_.clear();
    begin_.assign(1, 0);
    for (const PlyProperty& p : element.properties) {
      double size = 1;
      if (p.length) size = bytes_->take(*p.length, name);
      if (!(size >= 0) || size != std::floor(size) || size > static_cast<double>(bytes_->left()))
        fail(p.name + " of " + name + " has a length that the file does not hold; it is damaged: write it again");
      for (double k = 0; k < size; ++k) values_.push_back(bytes_->take(p.type, name));
      begin_.push_back(values_.size());
    }
  }

  void take_line(const PlyElement& element, const std::string& name) {
    lines_.next();
    values_.clear();
    begin_.assign(1, 0);
    std::size_t word = 0;
    for (const PlyProperty& p : element.properties) {
      std::size_t size = 1;
      if (p.length) size = length_at(word++, p.name + " of " + name);
      for (std::size_t k = 0; k < size; ++k, ++word) values_.push_back(value_at(word, p.name + " of " + name));
      begin_.push_back(values_.size());
    }
    if (word < lines_.words().size())
      fail("found " + lines_.found(word) + " behind the last property of " + name + "; correct the line");
  }
  std::size_t length_at(std::size_t word, const std::string& of) const {
    const std::vector<std::string_view>& words = lines_.words();
    const std::optional<std::int64_t> size = word < words.size() ? to_integer(words[word]) : std::nullopt;
    if (!size || *size < 0)
      fail("expected the length of " + of + ", found " + lines_.found(word) + "; must be a whole number");
    const std::size_t left = words.size() - word - 1;
    if (static_cast<std::uint64_t>(*size) > left)
      fail(of + " has " + std::to_string(left) + " values, and says " + std::to_string(*size) + "; correct the line");
    return static_cast<std::size_t>(*size);
  }
  double value_at(std::size_t word, const std::string& of) const {
    const std::optional<double> value = word < lines_.words().size() ? to_number(lines_.words()[word]) : std::nullopt;
    if (!value) fail("expected " + of + ", found " + lines_.found(word) + "; must be a finite number");
    return *value;
  }

  void add_vertex(const std::string& name, const std::array<std::size_t, 3>& x) {
    std::array<double, 3> place{};
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t at = begin_[x[c]];
      if (begin_[x[c] + 1] != at + 1 || !std::isfinite(values_[at]))
        fail("a coordinate of " + name + " is no finite number; correct it");
      place[c] = values_[at];
    }
    points_->InsertNextPoint(place.data());
  }

  void add_face(const std::string& name, std::size_t corners) {
    const std::size_t begin = begin_[corners], end = begin_[corners + 1];
    if (end - begin < 3) fail(name + " has " + std::to_string(end - begin) + " vertices; must have at least 3");
    const vtkIdType vertices = points_->GetNumberOfPoints();
    corners_.clear();
    for (std::size_t k = begin; k < end; ++k) {
      const double vertex = values_[k];
      if (!(vertex >= 0) || vertex >= static_cast<double>(vertices) || vertex != std::floor(vertex))
        fail(name + " uses vertex " + number_text(vertex) + ", but there are " + std::to_string(vertices) +
             ", counted from 0; correct the face");
      corners_.push_back(static_cast<vtkIdType>(vertex));
    }
    faces_->InsertNextCell(static_cast<vtkIdType>(corners_.size()), corners_.data());
  }
  static std::string number_text(double value) {
    std::string text = std::to_string(value);
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
    return text;
  }

  TextLines& lines_;
  PlyHeader header_;
  PlyBytes* bytes_;  ///< none: of text
  std::vector<double> values_;
  std::vector<std::size_t> begin_;  ///< (properties + 1): of an element among its values
  std::vector<vtkIdType> corners_;
  vtkNew<vtkPoints> points_;
  vtkNew<vtkCellArray> faces_;
};

}  // namespace

vtkSmartPointer<vtkDataSet> parse_ply(std::string_view text, const std::string& name,
                                      std::vector<std::string>& messages) {
  const BareText bare(text);
  TextLines whole(text.substr(static_cast<std::size_t>(bare.text.data() - text.data())), name, 0);
  if (PlyHeader header = read_ply_header(whole); header.kind != PlyKind::text) {
    PlyBytes bytes(whole.rest(), name, header.kind == PlyKind::little_endian);
    vtkSmartPointer<vtkDataSet> mesh = PlyParser(whole, std::move(header), &bytes).parse();
    if (bytes.left() > 0)
      messages.push_back(name + ": left out " + std::to_string(bytes.left()) + " bytes behind the last element");
    return mesh;
  }
  bare.report(name, messages);
  TextLines lines(bare.text, name, 0);
  PlyHeader header = read_ply_header(lines);
  return PlyParser(lines, std::move(header), nullptr).parse();
}

}  // namespace fascia::io
