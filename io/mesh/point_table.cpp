#include "io/mesh/point_table.hpp"

#include "core/base/errors.hpp"
#include "io/files.hpp"
#include "io/mesh/text_numbers.hpp"

#include <algorithm>
#include <array>
#include <system_error>

namespace fascia::io {
namespace {

enum Column : std::size_t { x, y, z, rx, ry, rz, volume, column_count };
constexpr std::array<std::string_view, column_count> column_names{"x", "y", "z", "rx", "ry", "rz", "volume"};

struct Cell {
  std::string_view word;
  std::size_t column = 0;  ///< of its first character, from one
};

class PointTableParser {
 public:
  PointTableParser(std::string_view text, const std::string& name) : text_(text), name_(name) {
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);
  }

  PointTable parse() {
    if (!next_row()) fail_file("holds no points; must have a line for each");
    const auto is_number = [](const Cell& cell) { return to_number(cell.word).has_value(); };
    if (std::any_of(row_.begin(), row_.end(), is_number)) {
      assume_columns();
      add_row();
    } else {
      read_header();
    }
    while (next_row()) add_row();
    if (table_.position.empty()) fail_file("holds no points below its header; must have a line for each");
    return std::move(table_);
  }

 private:
  [[noreturn]] void fail(std::size_t column, const std::string& message) const {
    throw InputError(name_ + ":" + std::to_string(line_) + ":" + std::to_string(column) + ": " + message);
  }
  [[noreturn]] void fail_file(const std::string& message) const { throw InputError(name_ + ": " + message); }

  /// The cells of the next line that has any; false at the end.
  bool next_row() {
    row_.clear();
    while (row_.empty() && place_ < text_.size()) {
      const std::size_t end = std::min(text_.find('\n', place_), text_.size());
      const std::string_view line = text_.substr(place_, end - place_);
      place_ = end + 1;
      ++line_;
      split(line.substr(0, line.find('#')));
    }
    return !row_.empty();
  }

  void split(std::string_view line) {
    if (std::all_of(line.begin(), line.end(), is_blank)) return;
    for (std::size_t begin = 0; begin <= line.size();) {
      const std::size_t end = std::min(line.find(',', begin), line.size());
      std::size_t first = begin, last = end;
      while (first < last && is_blank(line[first])) ++first;
      while (last > first && is_blank(line[last - 1])) --last;
      row_.push_back({line.substr(first, last - first), first + 1});
      begin = end + 1;
    }
  }

  void assume_columns() {
    if (row_.size() != 3 && row_.size() != 6)
      fail(1, "has " + std::to_string(row_.size()) +
                  " columns and no header; must have 3 (x, y, z) or 6 (with rx, ry, "
                  "rz), or a first line that names them");
    for (std::size_t c = 0; c < row_.size(); ++c) columns_.push_back(static_cast<Column>(c));
  }

  void read_header() {
    for (const Cell& cell : row_) {
      std::string_view word = cell.word;
      if (word.size() >= 2 && word.front() == '"' && word.back() == '"') word = word.substr(1, word.size() - 2);
      const auto found = std::find(column_names.begin(), column_names.end(), word);
      if (found == column_names.end())
        fail(cell.column,
             quoted(word) + " is no known column; must be x, y, z, rx, ry, rz or volume, separated by commas");
      const auto column = static_cast<Column>(found - column_names.begin());
      if (has(column)) fail(cell.column, "column " + std::string(word) + " appears twice; remove one");
      columns_.push_back(column);
    }
    require({x, y, z}, "; must have x, y and z");
    if (has(rx) || has(ry) || has(rz)) require({rx, ry, rz}, "; rotation vectors need rx, ry and rz");
  }

  bool has(Column column) const { return std::find(columns_.begin(), columns_.end(), column) != columns_.end(); }

  void require(std::initializer_list<Column> columns, const std::string& remedy) const {
    for (const Column column : columns)
      if (!has(column)) fail(1, "column " + std::string(column_names[column]) + " is missing" + remedy);
  }

  void add_row() {
    if (row_.size() != columns_.size())
      fail(row_.back().column, "the line ends after " + std::to_string(row_.size()) + " cells; must have " +
                                   std::to_string(columns_.size()) + ", separated by commas");
    std::array<double, column_count> values{};
    for (std::size_t c = 0; c < row_.size(); ++c) values[columns_[c]] = number(row_[c], columns_[c]);
    table_.position.push_back({{values[x], values[y], values[z]}});
    if (has(rx)) table_.rotation.push_back({{values[rx], values[ry], values[rz]}});
    if (has(volume)) table_.volume.push_back(values[volume]);
  }

  double number(const Cell& cell, Column column) const {
    const std::string name(column_names[column]);
    const std::optional<double> value = to_number(cell.word);
    if (!value) fail(cell.column, name + " is " + quoted(cell.word) + "; must be a finite number");
    if (column == volume && !(*value > 0))
      fail(cell.column, name + " is " + std::string(cell.word) + "; must be above 0");
    return *value;
  }

  std::string_view text_;
  std::string name_;
  std::size_t place_ = 0;
  int line_ = 0;
  std::vector<Cell> row_;
  std::vector<Column> columns_;
  PointTable table_;
};

}  // namespace

PointTable parse_point_table(std::string_view text, const std::string& name) {
  return PointTableParser(text, name).parse();
}

PointTable read_point_table(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    throw FileError(path.string() + ": is no ordinary file; give a table of comma-separated values");
  if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(path, error) == 0)
    throw InputError(path.string() + ": the file is empty; must have a line for each point");
  return parse_point_table(read_file(path), path.string());
}

}  // namespace fascia::io
