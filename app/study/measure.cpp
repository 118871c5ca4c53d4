#include "app/study/evaluation.hpp"
#include "app/study/richardson.hpp"
#include "core/base/errors.hpp"
#include "io/result_reader.hpp"

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

using Json = nlohmann::ordered_json;

/// Numbers of a nested value in their order, as probes.csv has them.
void flatten(const Json& value, std::vector<double>& numbers) {
  if (value.is_array())
    for (const Json& item : value) flatten(item, numbers);
  else if (value.is_number())
    numbers.push_back(value.get<double>());
}

std::size_t count_of(const Json& value) {
  std::vector<double> numbers;
  flatten(value, numbers);
  return numbers.size();
}

/// The flat range that an entry of a nested value stands for; empty where there is none.
struct Range {
  std::size_t begin = 0, end = 0;
};
Range range_of(const Json& value, const std::vector<std::size_t>& entry) {
  const Json* at = &value;
  std::size_t begin = 0;
  for (const std::size_t index : entry) {
    if (!at->is_array() || index >= at->size()) return {};
    for (std::size_t i = 0; i < index; ++i) begin += count_of((*at)[i]);
    at = &(*at)[index];
  }
  return {begin, begin + count_of(*at)};
}

bool belongs_to(const std::string& column, const std::string& probe) {
  return column == probe || (column.starts_with(probe) && (column[probe.size()] == '.' || column[probe.size()] == '['));
}

/// The measure's numbers in each saved row that has them all.
RunMeasure curve_of(const std::filesystem::path& csv, const std::string& probe, const Range& range) {
  const io::NumberTable table = io::read_number_table(csv);
  std::vector<std::size_t> columns;
  for (std::size_t c = 1; c < table.columns.size(); ++c)
    if (belongs_to(table.columns[c], probe)) columns.push_back(c);
  RunMeasure curve;
  if (range.end > columns.size()) return curve;
  for (const std::vector<double>& row : table.rows) {
    std::vector<double> numbers;
    for (std::size_t i = range.begin; i < range.end; ++i) numbers.push_back(row[columns[i]]);
    if (!std::all_of(numbers.begin(), numbers.end(), [](double v) { return std::isfinite(v); })) continue;
    curve.times.push_back(row[0]);
    curve.value.insert(curve.value.end(), numbers.begin(), numbers.end());
  }
  return curve;
}

/// Values of a curve at a time, linear between its own; a time outside gives the nearest end.
std::vector<double> at_time(const RunMeasure& curve, double time) {
  const std::size_t width = curve.value.size() / curve.times.size();
  const auto row = [&](std::size_t i) { return curve.value.begin() + static_cast<std::ptrdiff_t>(i * width); };
  const auto after = std::lower_bound(curve.times.begin(), curve.times.end(), time);
  const auto i = static_cast<std::size_t>(after - curve.times.begin());
  std::vector<double> values;
  if (i == 0 || i == curve.times.size()) {
    const std::size_t end = i == 0 ? 0 : i - 1;
    values.assign(row(end), row(end + 1));
    return values;
  }
  const double part = (time - curve.times[i - 1]) / (curve.times[i] - curve.times[i - 1]);
  for (std::size_t k = 0; k < width; ++k)
    values.push_back(row(i - 1)[static_cast<std::ptrdiff_t>(k)] * (1 - part) +
                     row(i)[static_cast<std::ptrdiff_t>(k)] * part);
  return values;
}

}  // namespace

RunMeasure measure_run(const StudyMeasure& measure, const RunRecord& record,
                       const std::filesystem::path& directory) try {
  RunMeasure measured;
  if (!measure.field.empty()) return measured;
  const auto probe = record.probes.find(measure.probe);
  if (probe == record.probes.end() || !probe->contains("value")) return measured;
  const Json& value = probe->at("value");
  const Range range = range_of(value, measure.entry);
  if (measure.moment == Moment::end) {
    std::vector<double> numbers;
    flatten(value, numbers);
    for (std::size_t i = range.begin; i < range.end; ++i) measured.value.push_back(numbers[i]);
    return measured;
  }
  measured = curve_of(directory / "probes.csv", measure.probe, range);
  if (measure.moment == Moment::curve || measured.times.empty()) return measured;
  const std::size_t width = measured.value.size() / measured.times.size();
  std::vector<double> largest;
  for (std::size_t i = 0; i < measured.times.size(); ++i) {
    const auto begin = measured.value.begin() + static_cast<std::ptrdiff_t>(i * width);
    std::vector<double> row(begin, begin + static_cast<std::ptrdiff_t>(width));
    if (largest.empty() || norm_of(row) > norm_of(largest)) largest = std::move(row);
  }
  return {std::move(largest), {}, {}, ""};
} catch (const FileError&) {
  return {};  // its table is gone
} catch (const InputError&) {
  return {};
}

std::optional<double> relative_error(const RunMeasure& value, const RunMeasure& reference) {
  if (value.value.empty() || reference.value.empty() || value.times.empty() != reference.times.empty())
    return std::nullopt;
  std::vector<double> expected = reference.value;
  if (!value.times.empty()) {
    expected.clear();
    for (const double t : value.times)
      for (const double v : at_time(reference, t)) expected.push_back(v);
  }
  const double size = norm_of(expected);
  if (expected.size() != value.value.size() || !(size > 0)) return std::nullopt;
  return distance(value.value, expected) / size;
}

}  // namespace fascia::app
