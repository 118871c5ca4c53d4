#include "app/report/heat_map.hpp"

#include "app/report/markup.hpp"

#include <fmt/format.h>

#include <map>
#include <stdexcept>

namespace fascia::app {
namespace {

constexpr ResultState kStates[] = {ResultState::right,    ResultState::refused, ResultState::stopped,
                                   ResultState::doubtful, ResultState::wrong,   ResultState::none};

void check_sizes(const HeatMap& map) {
  if (map.cells.size() != map.rows.size()) throw std::invalid_argument("heat map: one row of cells a name");
  for (const auto& row : map.cells)
    if (row.size() != map.columns.size()) throw std::invalid_argument("heat map: one cell a column");
}

std::string sign_of(const HeatCell& cell) {
  return cell.sign.empty() ? state_sign(cell.state) : shortened(cell.sign, 3);
}

std::string legend_of(const HeatMap& map) {
  std::map<ResultState, std::size_t> counts;
  for (const auto& row : map.cells)
    for (const HeatCell& cell : row) ++counts[cell.state];
  std::string text = "<ul class=\"states\">";
  for (const ResultState state : kStates) {
    if (counts[state] == 0) continue;
    text += fmt::format("<li><span class=\"state {}\">{}</span> {}: {}</li>", state_class(state), state_sign(state),
                        state_name(state), counts[state]);
  }
  return text + "</ul>\n";
}

std::string html_of(const HeatCell& cell, const std::string& place) {
  const std::string sign = escaped(sign_of(cell)), name = state_class(cell.state);
  if (cell.state == ResultState::none && cell.detail.empty() && cell.command.empty())
    return fmt::format("<td class=\"{}\">{}</td>", name, sign);
  const auto attribute = [](const char* key, const std::string& value) {
    return value.empty() ? "" : fmt::format(" data-{}=\"{}\"", key, escaped(value));
  };
  const std::string words = place + ": " + state_name(cell.state) + (cell.detail.empty() ? "" : "\n" + cell.detail);
  return fmt::format("<td class=\"{}\"><button type=\"button\" title=\"{}\" aria-label=\"{}\"{}{}>{}</button></td>",
                     name, escaped(words), escaped(place + ": " + state_name(cell.state)),
                     attribute("command", cell.command), attribute("anchor", cell.anchor), sign);
}

}  // namespace

std::string html_of(const HeatMap& map) {
  check_sizes(map);
  std::string html = fmt::format(
      "<div class=\"map\">\n{}<div class=\"scroll\" tabindex=\"0\"><table>\n<caption>{}</caption>\n<thead><tr><th "
      "scope=\"col\">"
      "{} <span aria-hidden=\"true\">↓</span> {} <span aria-hidden=\"true\">→</span></th>",
      legend_of(map), escaped(map.caption), escaped(map.row_title), escaped(map.column_title));
  for (const std::string& column : map.columns) html += fmt::format("<th scope=\"col\">{}</th>", escaped(column));
  html += "</tr></thead>\n<tbody>\n";
  for (std::size_t r = 0; r < map.rows.size(); ++r) {
    html += fmt::format("<tr><th scope=\"row\">{}</th>", escaped(map.rows[r]));
    for (std::size_t c = 0; c < map.columns.size(); ++c)
      html += html_of(map.cells[r][c], map.rows[r] + ", " + map.columns[c]);
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n<div class=\"chosen\" aria-live=\"polite\" hidden=\"\"></div>\n</div>\n";
}

}  // namespace fascia::app
