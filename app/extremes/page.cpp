#include "app/extremes/map.hpp"
#include "app/report/html_page.hpp"
#include "app/results/provenance.hpp"
#include "app/version.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

/// Deviations from the theory of beams that are told by a star: coarse elements and locking, which are no fault of a
/// solver.
constexpr double kStarred = 0.1;

bool is_starred(const CellOutcome& o) {
  return o.verdict == CellVerdict::right && o.theory_error && std::abs(*o.theory_error) > kStarred;
}

ResultState state_of(CellVerdict verdict) {
  switch (verdict) {
    case CellVerdict::right:
    case CellVerdict::beyond:
    case CellVerdict::sensitive:
    case CellVerdict::branch:
      return ResultState::right;
    case CellVerdict::refused:
      return ResultState::refused;
    case CellVerdict::stopped:
      return ResultState::stopped;
    case CellVerdict::warned:
    case CellVerdict::unconfirmed:
    case CellVerdict::limit:
      return ResultState::doubtful;
    default:
      return ResultState::wrong;
  }
}

std::string sign_of(const CellOutcome& o) {
  switch (o.verdict) {
    case CellVerdict::right:
      return is_starred(o) ? "✓*" : "✓";
    case CellVerdict::beyond:
      return "✓L";
    case CellVerdict::sensitive:
      return "✓~";
    case CellVerdict::branch:
      return "✓2";
    case CellVerdict::warned:
      return "W";
    case CellVerdict::unconfirmed:
      return "?";
    case CellVerdict::limit:
      return "T";
    case CellVerdict::crashed:
      return "!";
    default:
      return "";
  }
}

std::string detail_of(const ExtremeCell& c, const CellOutcome& o, const std::string& other) {
  std::string text = fmt::format("{}: {}", c.name(), name_of(o.verdict));
  if (o.status != name_of(o.verdict)) text += fmt::format(" ({})", o.status);
  if (o.difference) text += fmt::format(", differs from its twin by {:.1e}", *o.difference);
  if (o.theory_error) text += fmt::format(", tip {:+.2g} % from the theory of beams", 100 * *o.theory_error);
  text += fmt::format(", {:.2g} s", o.seconds);
  for (const std::string& line : {o.reason, other})
    if (!line.empty()) text += "\n" + line;
  return text;
}

template <class T>
std::size_t place(std::vector<T>& all, const T& one) {
  const auto found = std::find(all.begin(), all.end(), one);
  if (found != all.end()) return static_cast<std::size_t>(found - all.begin());
  all.push_back(one);
  return all.size() - 1;
}

/// Rows against the values of one axis.
HeatMap map_of(const ExtremesMap& map, const std::string& axis, const std::filesystem::path& scenes) {
  HeatMap heat;
  heat.caption = axis;
  heat.row_title = "model, kind, solver";
  heat.column_title = axis;
  std::vector<std::pair<std::size_t, std::size_t>> at;
  for (const ExtremeCell& c : map.cells) {
    const bool here = c.axis == axis;
    at.emplace_back(here ? place(heat.rows, c.row) : 0, here ? place(heat.columns, c.value) : 0);
  }
  heat.cells.assign(heat.rows.size(), std::vector<HeatCell>(heat.columns.size()));
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    if (map.cells[i].axis != axis) continue;
    HeatCell& cell = heat.cells[at[i].first][at[i].second];
    cell.state = state_of(map.outcomes[i].verdict);
    cell.sign = sign_of(map.outcomes[i]);
    cell.detail = detail_of(map.cells[i], map.outcomes[i], map.others.empty() ? "" : map.others[i]);
    cell.command = "fascia run " + quoted_for_shell((scenes / map.files[i]).string());
  }
  return heat;
}

std::string sentence_of(const ExtremesMap& map) {
  const std::vector<std::size_t> counts = count(map);
  const std::size_t all = map.cells.size();
  std::string text = fmt::format("{} cells: ", all);
  for (std::size_t v = 0; v < counts.size(); ++v)
    if (counts[v] > 0)
      text += fmt::format("{} {} ({:.1f} %), ", counts[v], name_of(static_cast<CellVerdict>(v)),
                          100.0 * static_cast<double>(counts[v]) / static_cast<double>(all));
  text.resize(text.size() - 2);
  return text;
}

/// Pairs have no columns: a list of those that are not right.
ReportTable pair_table(const ExtremesMap& map) {
  ReportTable table{
      "Pairs that are not right", {{"model, kind, solver", ""}, {"values", ""}, {"verdict", ""}, {"reason", ""}}, {}};
  for (std::size_t i = 0; i < map.cells.size(); ++i)
    if (map.cells[i].axis == "pairs" && map.outcomes[i].verdict != CellVerdict::right)
      table.rows.push_back({map.cells[i].row, map.cells[i].value,
                            state_cell(state_of(map.outcomes[i].verdict), name_of(map.outcomes[i].verdict)),
                            map.outcomes[i].reason});
  return table;
}

ReportTable row_table(const ExtremesMap& map) {
  std::vector<std::string> rows;
  std::vector<std::vector<std::size_t>> counts;
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    const std::size_t r = place(rows, map.cells[i].row);
    if (r == counts.size()) counts.emplace_back(static_cast<std::size_t>(CellVerdict::crashed) + 1, 0);
    ++counts[r][static_cast<std::size_t>(map.outcomes[i].verdict)];
  }
  ReportTable table{"Cells by model, kind and solver", {{"model, kind, solver", ""}}, {}};
  for (std::size_t v = 0; v <= static_cast<std::size_t>(CellVerdict::crashed); ++v)
    table.columns.push_back({name_of(static_cast<CellVerdict>(v)), "", true});
  for (std::size_t r = 0; r < rows.size(); ++r) {
    std::vector<ReportCell> cells{rows[r]};
    for (const std::size_t c : counts[r]) cells.push_back(number_cell(static_cast<double>(c)));
    table.rows.push_back(std::move(cells));
  }
  return table;
}

}  // namespace

std::string html_of(const ExtremesMap& map, const std::filesystem::path& scenes) {
  HtmlPage page("fascia: " + map.title);
  const std::vector<std::size_t> counts = count(map);
  if (map.regressions.empty())
    page.paragraph(sentence_of(map) + ".");
  else
    page.notice(sentence_of(map) + fmt::format(". {} cells are worse than in the stored map.", map.regressions.size()));
  page.paragraph(
      "A cell is right where its run converged and a twin agrees to 1e-6 in every probe: the same scene in other units "
      "of mass, length and time, by Cholesky, to a hundredth of the tolerance; in statics what nothing holds is right "
      "where it is refused for that reason. ✓ right, ✓* right but more than 10 % from the "
      "theory of slender beams (coarse or locking), ✓L stopped where a closed form says that the law gives way, and "
      "names the law as the cause, ✓~ differs from the twin no more than the scene answers a "
      "disturbance of 1e-8 of its forces, ✓2 another solution of the same equations than that of the twin, W differs "
      "from the twin and warns itself that there may be other solutions, R refused before the run with a reason, "
      "S stopped by the program with a reason, ? converged but the twin did not, T took too long or too much memory, ✗ "
      "differs from the twin, "
      "! crashed. Click a cell for its numbers, its reason and the command that repeats it.");
  page.table(row_table(map));
  for (const auto& [title, lines] : {std::pair{"Worse than in the stored map", &map.regressions},
                                     std::pair{"Better than in the stored map", &map.gains}}) {
    if (lines->empty()) continue;
    page.heading(title);
    page.list(*lines);
  }
  std::vector<std::string> axes;
  for (const ExtremeCell& c : map.cells) place(axes, c.axis);
  for (const std::string& axis : axes) {
    page.heading(axis);
    if (axis == "pairs")
      page.table(pair_table(map));
    else
      page.map(map_of(map, axis, scenes));
  }
  page.footer(fmt::format("{} runs at once, at most {:g} s and {:.3g} GB each; {:.0f} s in all. {}", map.settings.jobs,
                          map.settings.time_limit, map.settings.memory_limit / 1e9, map.seconds, version_text()));
  return page.text();
}

std::string text_of(const ExtremesMap& map) {
  std::string text;
  for (std::size_t i = 0; i < map.cells.size(); ++i)
    if (leads_astray(map.outcomes[i].verdict))
      text +=
          fmt::format("{}: {}: {}\n", name_of(map.outcomes[i].verdict), map.cells[i].name(), map.outcomes[i].reason);
  for (const std::string& line : map.gains) text += "better: " + line + "\n";
  for (const std::string& line : map.regressions) text += "worse: " + line + "\n";
  return text + fmt::format("{}; {:.0f} s\n", sentence_of(map), map.seconds);
}

}  // namespace fascia::app
