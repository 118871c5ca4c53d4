#include "app/compare/probes.hpp"

#include "io/result_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace fascia::app {
namespace {

using Json = nlohmann::ordered_json;

/// Columns of a probe's point, by its name: "tip[3].xy" is a column of "tip[3]".
using Columns = std::map<std::string, std::vector<std::size_t>>;

const Json& probes_of(const Json& summary) {
  static const Json none = Json::object();
  const auto found = summary.find("probes");
  return found == summary.end() ? none : *found;
}

/// "quantity in unit" of a probe; empty where the summary does not say, as that of a run that goes on.
std::pair<std::string, std::string> measured(const Json& summary, const std::string& column) {
  const Json& probes = probes_of(summary);
  const auto found = probes.find(column.substr(0, column.find('[')));
  if (found == probes.end()) return {};
  return {found->value("quantity", ""), found->value("unit", "")};
}

Columns columns_of(const io::NumberTable& table) {
  Columns columns;
  for (std::size_t c = 1; c < table.columns.size(); ++c) {
    const std::string& name = table.columns[c];
    if (name != "time_step") columns[name.substr(0, name.find('.'))].push_back(c);
  }
  return columns;
}

std::vector<double> times_of(const io::NumberTable& table) {
  std::vector<double> times;
  for (const auto& row : table.rows) times.push_back(row.at(0));
  return times;
}

std::vector<double> values_at(const io::NumberTable& table, const std::vector<std::size_t>& columns,
                              const TimePlace& place) {
  std::vector<double> values;
  values.reserve(columns.size());
  const auto &below = table.rows[place.below], &above = table.rows[place.above];
  for (const std::size_t c : columns)
    values.push_back(place.fraction == 0 ? below[c] : below[c] + place.fraction * (above[c] - below[c]));
  return values;
}

bool has_value(const std::vector<double>& v) {
  return std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); });
}

double length(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

void add_row(ProbeDifference& d, std::vector<double> a, std::vector<double> b, double time) {
  if (!has_value(a) && !has_value(b)) return;
  double apart = std::numeric_limits<double>::infinity();
  if (has_value(a)) d.magnitude = std::max(d.magnitude, length(a));
  if (has_value(b)) d.magnitude = std::max(d.magnitude, length(b));
  if (has_value(a) && has_value(b)) {
    std::vector<double> difference = a;
    for (std::size_t i = 0; i < a.size(); ++i) difference[i] -= b[i];
    apart = length(difference);
  }
  if (!d.a.empty() && apart <= d.largest) return;
  d.largest = apart;
  d.time = time;
  d.a = std::move(a);
  d.b = std::move(b);
}

/// True where the pairs are all rows of two tables, each with the row of its number.
bool are_rows(const TimePairs& times, std::size_t rows_of_a, std::size_t rows_of_b) {
  const auto is_row = [](const TimePair& t) {
    return t.a.fraction == 0 && t.b.fraction == 0 && t.a.below == t.b.below;
  };
  return rows_of_a == rows_of_b && times.pairs.size() == rows_of_a &&
         std::all_of(times.pairs.begin(), times.pairs.end(), is_row);
}

void tell_others(const Columns& x, const Columns& y, const char* which, ProbeComparison& result) {
  std::vector<std::string> alone;
  for (const auto& [name, columns] : x)
    if (!y.contains(name)) alone.push_back(name);
  if (!alone.empty())
    result.structure.push_back(
        fmt::format("probes.csv has other columns: {} alone has {}", which, fmt::join(alone, ", ")));
}

}  // namespace

ProbeComparison compare_probes(const ProbeSource& a, const ProbeSource& b) {
  const io::NumberTable x = io::read_number_table(a.directory / "probes.csv");
  const io::NumberTable y = io::read_number_table(b.directory / "probes.csv");
  const Columns of_a = columns_of(x), of_b = columns_of(y);
  ProbeComparison result;
  tell_others(of_a, of_b, "A", result);
  tell_others(of_b, of_a, "B", result);
  if (of_a.empty() && of_b.empty()) return result;
  TimePairs times = pair_times(times_of(x), a.kind, times_of(y), b.kind, "rows of probes.csv");
  const bool by_time = a.kind == b.kind && (a.kind == RunKind::statics || a.kind == RunKind::dynamics);
  result.same_rows = !by_time || are_rows(times, x.rows.size(), y.rows.size());
  result.structure.insert(result.structure.end(), times.structure.begin(), times.structure.end());
  result.notes = std::move(times.notes);
  for (const auto& [name, columns] : of_a) {
    const auto other = of_b.find(name);
    if (other == of_b.end()) continue;
    const auto what = measured(a.summary, name), there = measured(b.summary, name);
    if (columns.size() != other->second.size() || (!what.first.empty() && !there.first.empty() && what != there)) {
      result.structure.push_back(
          fmt::format("probe \"{}\": measures \"{}\" in A, \"{}\" in B", name, what.first, there.first));
      continue;
    }
    ProbeDifference& d = result.probes.emplace_back();
    d.name = name;
    d.unit = what.second;
    for (const TimePair& time : times.pairs)
      add_row(d, values_at(x, columns, time.a), values_at(y, other->second, time.b), time.time);
    d.relative = d.largest == 0 ? 0 : std::isfinite(d.largest) ? d.largest / d.magnitude : d.largest;
  }
  std::stable_sort(result.probes.begin(), result.probes.end(),
                   [](const auto& p, const auto& q) { return p.relative > q.relative; });
  return result;
}

}  // namespace fascia::app
