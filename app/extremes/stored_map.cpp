#include "app/extremes/map.hpp"
#include "app/report/csv.hpp"
#include "core/model/errors.hpp"
#include "io/files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <map>

namespace fascia::app {
namespace {

/// extremes.csv begins with these; a later version that means something else by them has other names.
const std::vector<std::string> kColumns{"row",        "axis",         "value",   "verdict", "status",
                                        "difference", "theory_error", "seconds", "reason"};

std::string key_of(const std::string& row, const std::string& axis, const std::string& value) {
  return row + ": " + axis + " " + value;
}

/// Two digits: more would change from one processor to the next.
std::string rounded(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? fmt::format("{:.1e}", *value) : "";
}

std::map<std::string, CellVerdict> read_stored(const std::filesystem::path& path) {
  const auto fail = [&](std::size_t line, const std::string& what) {
    throw InputError(
        fmt::format("{}:{}: {}; must be an extremes.csv as fascia extremes writes it: make the map again "
                    "with fascia extremes --output DIR",
                    path.string(), line, what));
  };
  std::vector<std::vector<std::string>> rows;
  try {
    rows = read_csv(io::read_file(path));
  } catch (const InputError& e) {
    throw InputError(fmt::format("{}: {}", path.string(), e.what()));
  }
  if (rows.empty() || rows.front() != kColumns)
    fail(1, fmt::format("the columns are not {}", fmt::join(kColumns, ",")));
  std::map<std::string, CellVerdict> stored;
  for (std::size_t r = 1; r < rows.size(); ++r) {
    const std::vector<std::string>& row = rows[r];
    if (row.size() != kColumns.size())
      fail(r + 1, fmt::format("{} cells in the place of {}", row.size(), kColumns.size()));
    const std::optional<CellVerdict> verdict = verdict_of(row[3]);
    if (!verdict) fail(r + 1, fmt::format("\"{}\" is no verdict", row[3]));
    if (!stored.emplace(key_of(row[0], row[1], row[2]), *verdict).second)
      fail(r + 1, fmt::format("\"{}\" stands there twice", key_of(row[0], row[1], row[2])));
  }
  return stored;
}

/// Refused and stopped are as good as one another.
int rank(CellVerdict v) {
  return v == CellVerdict::stopped ? static_cast<int>(CellVerdict::refused) : static_cast<int>(v);
}

}  // namespace

std::string csv_of(const ExtremesMap& map) {
  std::string text = csv_row(kColumns);
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    const ExtremeCell& c = map.cells[i];
    const CellOutcome& o = map.outcomes[i];
    text += csv_row({c.row, c.axis, c.value, name_of(o.verdict), o.status, rounded(o.difference),
                     rounded(o.theory_error), fmt::format("{:.2g}", o.seconds), o.reason});
  }
  return text;
}

void compare_with_stored(ExtremesMap& map, const std::filesystem::path& path) {
  const std::map<std::string, CellVerdict> stored = read_stored(path);
  std::size_t unknown = 0;
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    const ExtremeCell& c = map.cells[i];
    const auto found = stored.find(key_of(c.row, c.axis, c.value));
    if (found == stored.end()) {
      ++unknown;
      continue;
    }
    const CellOutcome& now = map.outcomes[i];
    if (rank(now.verdict) == rank(found->second)) continue;
    const bool worse = rank(now.verdict) > rank(found->second);
    (worse ? map.regressions : map.gains)
        .push_back(fmt::format("{}: was {}, is {}{}{}", c.name(), name_of(found->second), name_of(now.verdict),
                               now.reason.empty() ? "" : ": ", now.reason));
  }
  if (unknown == map.cells.size())
    throw InputError(
        fmt::format("{}: has none of these {} cells: a map of another scene or version; make it again with "
                    "fascia extremes --output DIR",
                    path.string(), map.cells.size()));
}

}  // namespace fascia::app
