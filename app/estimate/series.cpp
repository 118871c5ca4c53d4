#include "app/estimate/series.hpp"

#include "core/base/index.hpp"
#include "io/result_reader.hpp"

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

double euclidean(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

/// Calls act(row of a, row of b) for the times that both have.
template <class Act>
void for_common_times(const Series& a, const Series& b, Act&& act) {
  constexpr double same = 1e-6;  // of the time between rows: steps of another length add up to others' rounding
  std::size_t j = 0;
  for (std::size_t i = 0; i < a.times.size(); ++i) {
    const double apart = same * (i > 0                ? a.times[i] - a.times[i - 1]
                                 : a.times.size() > 1 ? a.times[1] - a.times[0]
                                                      : 1);
    while (j < b.times.size() && b.times[j] < a.times[i] - apart) ++j;
    if (j < b.times.size() && std::abs(b.times[j] - a.times[i]) <= apart && a.values[i].size() == b.values[j].size())
      act(i, j);
  }
}

/// Frequencies below this part of the largest are free motions, which have none.
constexpr double kNoFrequency = 1e-6;

}  // namespace

double Series::largest() const {
  double most = 0;
  for (const std::vector<double>& v : values) most = std::max(most, euclidean(v));
  return most;
}

std::optional<double> distance(const Series& a, const Series& b, SeriesNorm norm) {
  std::optional<double> most;
  for_common_times(a, b, [&](std::size_t i, std::size_t j) {
    const std::vector<double>&x = a.values[i], &y = b.values[j];
    std::vector<double> d(x.size());
    double far = 0;
    for (std::size_t k = 0; k < x.size(); ++k) d[k] = x[k] - y[k];
    const double scale =
        x.empty() ? 0 : std::abs(*std::ranges::max_element(x, {}, [](double v) { return std::abs(v); }));
    for (std::size_t k = 0; k < x.size() && norm == SeriesNorm::largest_relative; ++k)
      if (std::abs(x[k]) > kNoFrequency * scale) far = std::max(far, std::abs(d[k] / x[k]));
    if (norm == SeriesNorm::euclidean) far = euclidean(d);
    most = std::max(most.value_or(0), far);
  });
  return most;
}

void add_last_difference(const Series& a, const Series& b, double factor, std::vector<double>& to) {
  std::vector<double> last;
  for_common_times(a, b, [&](std::size_t i, std::size_t j) {
    last.assign(a.values[i].size(), 0);
    for (std::size_t k = 0; k < last.size(); ++k) last[k] = factor * std::abs(a.values[i][k] - b.values[j][k]);
  });
  to.resize(std::max(to.size(), last.size()));
  for (std::size_t k = 0; k < last.size(); ++k) to[k] += last[k];
}

Series mixed(const Series& a, const Series& b, double factor) {
  Series result;
  for_common_times(a, b, [&](std::size_t i, std::size_t j) {
    result.times.push_back(a.times[i]);
    std::vector<double> v = a.values[i];
    for (std::size_t k = 0; k < v.size(); ++k) v[k] += factor * (b.values[j][k] - v[k]);
    result.values.push_back(std::move(v));
  });
  return result;
}

ProbeTable::ProbeTable(const std::filesystem::path& directory) {
  io::NumberTable table = io::read_number_table(directory / "probes.csv");
  columns_ = std::move(table.columns);
  rows_ = std::move(table.rows);
}

Series ProbeTable::series(const std::string& probe, SolverKind kind) const {
  std::vector<std::size_t> own;
  for (std::size_t c = 0; c < columns_.size(); ++c)
    if (columns_[c].substr(0, columns_[c].find_first_of(".[")) == probe) own.push_back(c);
  Series series;
  if (own.empty()) return series;
  const bool modes = kind == SolverKind::modes;
  for (std::size_t r = is_dynamic(kind) || modes ? 0 : rows_.size() - std::min<std::size_t>(1, rows_.size());
       r < rows_.size(); ++r) {
    std::vector<double> values;
    values.reserve(own.size());
    for (const std::size_t c : own) values.push_back(rows_[r][c]);
    if (std::any_of(values.begin(), values.end(), [](double v) { return !std::isfinite(v); })) continue;
    if (modes && !series.values.empty()) {
      series.values[0].insert(series.values[0].end(), values.begin(), values.end());
      continue;
    }
    series.times.push_back(is_dynamic(kind) ? rows_[r][0] : 1);
    series.values.push_back(std::move(values));
  }
  return series;
}

}  // namespace fascia::app
