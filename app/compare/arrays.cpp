#include "app/compare/arrays.hpp"

#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "io/files.hpp"
#include "io/result_reader.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

/// A quantity's differences, as long as its magnitude is not known.
struct Distance {
  double largest = 0, magnitude = 0, at = 0;
  std::size_t numbers = 0;

  void add(double x, double y, double time) {
    const bool one_missing = std::isfinite(x) != std::isfinite(y);
    if (std::isfinite(x)) magnitude = std::max(magnitude, std::abs(x));
    if (std::isfinite(y)) magnitude = std::max(magnitude, std::abs(y));
    ++numbers;
    const double apart = one_missing ? std::numeric_limits<double>::infinity() : std::isfinite(x) ? std::abs(x - y) : 0;
    if (apart <= largest) return;
    largest = apart;
    at = time;
  }
};

using Distances = std::map<std::string, Distance>;

Scales scales_of(const Distances& distances) {
  Scales scales;
  double stress = 0, strain = 0;
  for (const auto& [name, d] : distances) {
    if (name.ends_with(": points")) scales.length = std::max(scales.length, d.magnitude);
    if (name.ends_with(": stress")) stress = std::max(stress, d.magnitude);
    if (name.ends_with(": strain")) strain = std::max(strain, d.magnitude);
  }
  if (strain > 0) scales.modulus = stress / strain;
  return scales;
}

/// "beam: stress" → "stress"; of a probe what it measures.
std::string quantity_of(const std::string& name, const nlohmann::ordered_json& summary) {
  if (const std::size_t colon = name.find(": "); colon != std::string::npos) return name.substr(colon + 2);
  const auto probes = summary.find("probes");
  return probes != summary.end() && probes->contains(name) ? probes->at(name).value("quantity", "") : "";
}

/// "tip.x", "tip[3].xy" → "tip": what is scaled together.
std::string probe_of(const std::string& column) { return column.substr(0, column.find_first_of(".[")); }

void compare_tables(const fs::path& a, const fs::path& b, ResultDifference& difference, Distances& distances) {
  const io::NumberTable x = io::read_number_table(a / "probes.csv"), y = io::read_number_table(b / "probes.csv");
  if (x.columns != y.columns) difference.structure.emplace_back("probes.csv has other columns");
  std::map<std::string, std::size_t> there;
  for (std::size_t c = 0; c < y.columns.size(); ++c) there[y.columns[c]] = c;
  if (x.rows.size() != y.rows.size())
    difference.structure.push_back(
        fmt::format("probes.csv has {} rows in the first and {} in the second", x.rows.size(), y.rows.size()));
  for (std::size_t r = 0; r < std::min(x.rows.size(), y.rows.size()); ++r)
    for (std::size_t c = 0; c < x.columns.size(); ++c)
      if (const auto other = there.find(x.columns[c]); other != there.end())
        distances[probe_of(x.columns[c])].add(x.rows[r][c], y.rows[r][other->second], x.rows[r][0]);
}

void compare_states(const fs::path& a, const fs::path& b, const io::CollectionEntry& x, const io::CollectionEntry& y,
                    ResultDifference& difference, Distances& distances) {
  const io::ResultArrays p = io::read_result_arrays(a / x.file), q = io::read_result_arrays(b / y.file);
  for (const auto& [name, values] : p) {
    const auto found = q.find(name);
    if (found == q.end() || found->second.size() != values.size()) {
      difference.structure.push_back(fmt::format("{}: \"{}\" is of another size in {}", x.file, name, y.file));
      continue;
    }
    Distance& distance = distances[x.body + ": " + name];
    for (std::size_t i = 0; i < values.size(); ++i) distance.add(values[i], found->second[i], x.time);
  }
  for (const auto& [name, values] : q)
    if (!p.contains(name)) difference.structure.push_back(fmt::format("{} alone has \"{}\"", y.file, name));
}

std::string status_of(const nlohmann::ordered_json& summary) { return summary.value("status", ""); }

}  // namespace

double rounding_of(const std::string& quantity, const Scales& scales) {
  constexpr double kRounding = 1e-13;
  const auto is_one_of = [&](std::initializer_list<const char*> names) {
    return std::find(names.begin(), names.end(), quantity) != names.end();
  };
  const double volume = scales.length * scales.length * scales.length;
  if (is_one_of({"rotation", "strain"}) || quantity.starts_with("axis_")) return kRounding;
  if (is_one_of({"points", "rest_position", "displacement", "position", "max_displacement", "mean_displacement"}))
    return kRounding * scales.length;
  if (is_one_of({"stress", "von_mises", "stress_outer", "stress_inner"})) return kRounding * scales.modulus;
  if (quantity == "energy_density") return kRounding * kRounding * scales.modulus;
  if (quantity == "energy") return kRounding * kRounding * scales.modulus * volume;
  if (quantity == "force") return kRounding * scales.modulus * scales.length * scales.length;
  if (quantity == "moment") return kRounding * scales.modulus * volume;
  return 0;
}

fs::path collection_of(const fs::path& directory, const nlohmann::ordered_json& summary) {
  fs::path file = directory / (fs::path(summary.value("scene", "")).stem().string() + ".pvd");
  std::error_code none;
  if (fs::exists(file, none)) return file;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory))
    if (entry.path().extension() == ".vtu")
      throw InputError(fmt::format("{}: is missing, and lists the states of this result", file.string()));
  return {};
}

double ResultDifference::largest() const {
  double most = 0;
  for (const QuantityDifference& q : quantities) most = std::max(most, q.relative);
  return most;
}

bool ResultDifference::exact() const {
  return structure.empty() &&
         std::all_of(quantities.begin(), quantities.end(), [](const QuantityDifference& q) { return q.absolute == 0; });
}

std::size_t ResultDifference::numbers() const {
  std::size_t sum = 0;
  for (const QuantityDifference& q : quantities) sum += q.numbers;
  return sum;
}

nlohmann::ordered_json read_summary(const fs::path& directory) {
  const fs::path file = directory / "summary.json";
  std::error_code none;
  if (!fs::exists(file, none))
    throw FileError(fmt::format("{}: is no directory of results: it has no summary.json", directory.string()));
  auto summary = nlohmann::ordered_json::parse(io::read_file(file), nullptr, false);
  if (!summary.is_object() || !summary.contains("fascia"))
    throw InputError(fmt::format("{}: is no summary of this program", file.string()));
  return summary;
}

ResultDifference compare_results(const fs::path& a, const fs::path& b) try {
  const nlohmann::ordered_json x = read_summary(a), y = read_summary(b);
  ResultDifference difference;
  Distances distances;
  if (status_of(x) != status_of(y))
    difference.structure.push_back(
        fmt::format("the first ended as \"{}\", the second as \"{}\"", status_of(x), status_of(y)));
  compare_tables(a, b, difference, distances);
  const fs::path first = collection_of(a, x), second = collection_of(b, y);
  if (first.empty() != second.empty()) difference.structure.emplace_back("one of the two has no saved state");
  if (!first.empty() && !second.empty()) {
    const std::vector<io::CollectionEntry> p = io::read_collection(first), q = io::read_collection(second);
    if (p.size() != q.size())
      difference.structure.push_back(
          fmt::format("{} files of states in the first and {} in the second", p.size(), q.size()));
    for (std::size_t i = 0; i < std::min(p.size(), q.size()); ++i) {
      if (p[i].body == q[i].body && p[i].time == q[i].time)
        compare_states(a, b, p[i], q[i], difference, distances);
      else if (p[i].body == q[i].body)
        difference.structure.push_back(
            fmt::format("{} is of the time {:.6g}, {} of {:.6g}", p[i].file, p[i].time, q[i].file, q[i].time));
      else
        difference.structure.push_back(fmt::format("{} is of another body than {}", p[i].file, q[i].file));
    }
  }
  const Scales scales = scales_of(distances);
  for (const auto& [name, d] : distances) {
    const bool rounding = d.largest <= rounding_of(quantity_of(name, x), scales);
    const double relative = rounding || d.largest == 0 ? 0
                            : std::isfinite(d.largest) ? d.largest / d.magnitude
                                                       : d.largest;
    difference.quantities.push_back({name, relative, d.largest, d.at, d.numbers});
  }
  std::stable_sort(difference.quantities.begin(), difference.quantities.end(),
                   [](const QuantityDifference& p, const QuantityDifference& q) { return p.relative > q.relative; });
  return difference;
} catch (const nlohmann::json::exception& e) {
  throw InputError(fmt::format("{} or {}: summary.json is damaged: {}", a.string(), b.string(), e.what()));
}

bool print_difference(const ResultDifference& difference, double tolerance) {
  constexpr std::size_t shown = 12;
  for (const std::string& s : difference.structure) fmt::print("{}\n", s);
  if (difference.numbers() == 0) fmt::print("the results hold no numbers\n");
  if (difference.exact()) {
    fmt::print("equal in every digit: {} numbers of {} quantities\n", difference.numbers(),
               difference.quantities.size());
    return true;
  }
  for (std::size_t i = 0; i < std::min(shown, difference.quantities.size()); ++i) {
    const QuantityDifference& q = difference.quantities[i];
    if (q.relative == 0) break;
    if (std::isfinite(q.relative))
      fmt::print("{}: {:.3g} of its largest value apart at {:.6g}\n", q.name, q.relative, q.at);
    else
      fmt::print("{}: missing in one of the two at {:.6g}\n", q.name, q.at);
  }
  const bool within = difference.largest() <= tolerance;
  fmt::print("{} numbers of {} quantities: {} the tolerance {:g}\n", difference.numbers(), difference.quantities.size(),
             within ? "within" : "above", tolerance);
  return within && difference.structure.empty();
}

}  // namespace fascia::app
