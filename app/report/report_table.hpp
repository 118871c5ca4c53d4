#pragma once

#include "app/report/result_state.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fascia::app {

struct ReportColumn {
  std::string name;
  std::string unit;      ///< below the name, in brackets; may be empty
  bool numeric = false;  ///< numbers stand at the right and are sorted by value
};

struct ReportCell {
  std::string text;
  std::optional<double> value;            ///< by which it is sorted in a numeric column; none: behind all others
  ResultState state = ResultState::none;  ///< gives its sign and colour
  std::string anchor;                     ///< of a heading in the same page, to which the text leads; may be empty

  ReportCell() = default;
  ReportCell(std::string words) : text(std::move(words)) {}  // NOLINT(google-explicit-constructor)
  ReportCell(const char* words) : text(words) {}             // NOLINT(google-explicit-constructor)
  ReportCell(std::string words, double number) : text(std::move(words)), value(number) {}
};

/// A number with at most this many digits, sorted by its exact value. Sorted last: "–" of what
/// is no number, "∞".
ReportCell number_cell(double value, int digits = 4);
/// The same; "–" where there is none.
ReportCell number_cell(const std::optional<double>& value, int digits = 4);
/// The state's sign and name, or another text with its sign.
ReportCell state_cell(ResultState state, const std::string& text = "");

/// A table that sorts by a click on a head and, from nine rows on, has a field that filters.
struct ReportTable {
  std::string caption;
  std::vector<ReportColumn> columns;
  std::vector<std::vector<ReportCell>> rows;
};

/// The table as an HTML element. @throws std::invalid_argument  a row has not one cell a column
std::string html_of(const ReportTable& table);

}  // namespace fascia::app
