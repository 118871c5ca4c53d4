#include "app/extremes/stored_map.hpp"
#include "app/report/csv.hpp"
#include "core/base/errors.hpp"
#include "io/files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstdlib>

namespace fascia::app {
namespace {

/// extremes.csv begins with these; a later version that means something else by them has other names.
const std::vector<std::string> kColumns{"row",        "axis",         "value", "verdict", "status",
                                        "difference", "theory_error", "size",  "seconds", "reason"};

/// Two digits: more would change from one processor to the next.
std::string rounded(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? fmt::format("{:.1e}", *value) : "";
}

/// A right cell whose displacement is another one by more is a regression: twins share a fault of a formula, an older
/// map does not. Verdicts allow a tenth of it.
constexpr double kAllowedChange = 1e-5;

/// A number, or none where the cell is empty.
std::optional<double> number_or_none(const std::string& cell) {
  return cell.empty() ? std::nullopt : std::optional(std::strtod(cell.c_str(), nullptr));
}

/// Refused and stopped are as good as one another.
int rank(CellVerdict v) {
  return v == CellVerdict::stopped ? static_cast<int>(CellVerdict::refused) : static_cast<int>(v);
}

}  // namespace

StoredMap read_stored(const std::filesystem::path& path) {
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
  StoredMap stored;
  for (std::size_t r = 1; r < rows.size(); ++r) {
    const std::vector<std::string>& row = rows[r];
    if (row.size() != kColumns.size())
      fail(r + 1, fmt::format("{} cells in the place of {}", row.size(), kColumns.size()));
    const std::optional<CellVerdict> verdict = verdict_of(row[3]);
    if (!verdict) fail(r + 1, fmt::format("\"{}\" is no verdict", row[3]));
    CellOutcome outcome;
    outcome.verdict = *verdict;
    outcome.status = row[4];
    outcome.difference = number_or_none(row[5]);
    outcome.theory_error = number_or_none(row[6]);
    outcome.size = number_or_none(row[7]);
    outcome.seconds = number_or_none(row[8]).value_or(0);
    outcome.reason = row[9];
    const std::string name = ExtremeCell{row[0], row[1], row[2], "", std::nullopt}.name();
    if (!stored.emplace(name, outcome).second) fail(r + 1, fmt::format("\"{}\" stands there twice", name));
  }
  return stored;
}

std::string csv_of(const ExtremesMap& map) {
  std::string text = csv_row(kColumns);
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    if (!map.has_ended(i)) continue;
    const ExtremeCell& c = map.cells[i];
    const CellOutcome& o = map.outcomes[i];
    text +=
        csv_row({c.row, c.axis, c.value, name_of(o.verdict), o.status, rounded(o.difference), rounded(o.theory_error),
                 o.size ? fmt::format("{:.9g}", *o.size) : "", fmt::format("{:.2g}", o.seconds), o.reason});
  }
  return text;
}

void keep_quick(std::vector<ExtremeCell>& cells, const std::filesystem::path& path, double seconds) {
  const StoredMap stored = read_stored(path);
  std::erase_if(cells, [&](const ExtremeCell& c) {
    const auto found = stored.find(c.name());
    return found == stored.end() || found->second.seconds > seconds;
  });
}

void read_beside(ExtremesMap& map, const std::filesystem::path& path) {
  const std::vector<std::vector<std::string>> rows = read_csv(io::read_file(path));
  if (rows.empty() || rows.front().size() != 4)
    throw InputError(
        fmt::format("{}:1: must have four columns: cell, fascia, the other program's name, difference", path.string()));
  std::map<std::string, std::string> said;
  for (std::size_t r = 1; r < rows.size(); ++r) {
    if (rows[r].size() != 4) throw InputError(fmt::format("{}:{}: must have four cells", path.string(), r + 1));
    said["cells/" + rows[r][0] + ".toml"] =
        fmt::format("{}: {}{}", rows.front()[2], rows[r][2],
                    rows[r][3].empty() ? "" : fmt::format(", differs from it by {}", rows[r][3]));
  }
  std::size_t known = 0;
  for (const std::string& file : map.files) {
    const auto found = said.find(file);
    map.others.push_back(found == said.end() ? "" : found->second);
    known += found != said.end() ? 1 : 0;
  }
  if (known == 0) throw InputError(fmt::format("{}: none of its rows is a cell of this map", path.string()));
}

void compare_with_stored(ExtremesMap& map, const std::filesystem::path& path) {
  const StoredMap stored = read_stored(path);
  std::size_t unknown = 0;
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    const ExtremeCell& c = map.cells[i];
    const auto found = stored.find(c.name());
    if (found == stored.end()) {
      ++unknown;
      continue;
    }
    const CellOutcome& now = map.outcomes[i];
    const CellVerdict before = found->second.verdict;
    const double size = found->second.size.value_or(0);
    if (before == CellVerdict::right && now.verdict == CellVerdict::right && size > 0 && now.size &&
        !(std::abs(*now.size - size) <= kAllowedChange * size))
      map.regressions.push_back(
          fmt::format("{}: the largest displacement was {:.9g} m, is {:.9g} m", c.name(), size, *now.size));
    if (rank(now.verdict) == rank(before)) continue;
    const bool worse = rank(now.verdict) > rank(before);
    (worse ? map.regressions : map.gains)
        .push_back(fmt::format("{}: was {}, is {}{}{}", c.name(), name_of(before), name_of(now.verdict),
                               now.reason.empty() ? "" : ": ", now.reason));
  }
  if (unknown == map.cells.size())
    throw InputError(
        fmt::format("{}: has none of these {} cells: a map of another scene or version; make it again with "
                    "fascia extremes --output DIR",
                    path.string(), map.cells.size()));
}

}  // namespace fascia::app
