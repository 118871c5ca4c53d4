#include "app/report/report_table.hpp"

#include "app/report/markup.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace fascia::app {
namespace {

constexpr std::size_t kFilteredRows = 9;

std::string head_of(const ReportColumn& column) {
  const std::string unit =
      column.unit.empty() ? "" : fmt::format(" <span class=\"unit\">[{}]</span>", escaped(column.unit));
  return fmt::format("<th scope=\"col\" aria-sort=\"none\"{}><button type=\"button\">{}{}</button></th>",
                     column.numeric ? " class=\"number\"" : "", escaped(column.name), unit);
}

std::string html_of(const ReportCell& cell, bool numeric) {
  std::string names = numeric ? "number" : "";
  if (cell.state != ResultState::none) names += (names.empty() ? "" : " ") + std::string(state_class(cell.state));
  std::string html = "<td";
  if (!names.empty()) html += fmt::format(" class=\"{}\"", names);
  if (numeric && cell.value && std::isfinite(*cell.value))
    html += fmt::format(" data-value=\"{}\"", exact_text(*cell.value));
  html += ">";
  if (cell.state != ResultState::none)
    html += fmt::format("<span class=\"state {}\">{}</span> ", state_class(cell.state), state_sign(cell.state));
  const std::string text = escaped(cell.text);
  return html + (cell.anchor.empty() ? text : fmt::format("<a href=\"#{}\">{}</a>", escaped(cell.anchor), text)) +
         "</td>";
}

}  // namespace

ReportCell number_cell(double value, int digits) {
  return std::isfinite(value) ? ReportCell(number_text(value, digits), value) : ReportCell(number_text(value, digits));
}

ReportCell number_cell(const std::optional<double>& value, int digits) {
  return value ? number_cell(*value, digits) : ReportCell("–");
}

ReportCell state_cell(ResultState state, const std::string& text) {
  ReportCell cell(text.empty() ? state_name(state) : text);
  cell.state = state;
  return cell;
}

std::string html_of(const ReportTable& table) {
  std::string html = "<div class=\"table\">\n";
  if (table.rows.size() >= kFilteredRows)
    html +=
        "<p class=\"filter\" hidden=\"\"><label>Filter <input type=\"search\" autocomplete=\"off\" "
        "placeholder=\"words of a row\"></label> <output></output></p>\n";
  html += "<div class=\"scroll\" tabindex=\"0\"><table>\n";
  if (!table.caption.empty()) html += fmt::format("<caption>{}</caption>\n", escaped(table.caption));
  html += "<thead><tr>";
  for (const ReportColumn& column : table.columns) html += head_of(column);
  html += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    if (row.size() != table.columns.size()) throw std::invalid_argument("report table: one cell a column");
    html += "<tr>";
    for (std::size_t c = 0; c < row.size(); ++c) html += html_of(row[c], table.columns[c].numeric);
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n</div>\n";
}

}  // namespace fascia::app
