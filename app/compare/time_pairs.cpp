#include "app/compare/time_pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace fascia::app {
namespace {

/// Times that differ by less of the whole range are the same: steps add up with rounding.
constexpr double kSameTime = 1e-7;

/// @param times  ascending
std::optional<std::size_t> entry_at(const std::vector<double>& times, double time, double apart) {
  const auto found = std::lower_bound(times.begin(), times.end(), time - apart);
  if (found == times.end() || *found > time + apart) return {};
  return static_cast<std::size_t>(found - times.begin());
}

double range_of(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (const auto* times : {&a, &b})
    for (const double t : *times) most = std::max(most, std::abs(t));
  return most;
}

TimePairs last_ones(const std::vector<double>& a, const std::vector<double>& b, const std::string& entries) {
  TimePairs result;
  result.pairs.push_back({a.back(), {a.size() - 1, a.size() - 1, 0}, {b.size() - 1, b.size() - 1, 0}});
  if (a.size() > 1 || b.size() > 1)
    result.notes.push_back(
        fmt::format("{}: the last of both are compared, of {} in A and {} in B", entries, a.size(), b.size()));
  return result;
}

TimePairs common_ones(const std::vector<double>& a, const std::vector<double>& b, const std::string& entries) {
  TimePairs result;
  const double apart = kSameTime * range_of(a, b);
  for (std::size_t i = 0; i < a.size(); ++i)
    if (const auto k = entry_at(b, a[i], apart)) result.pairs.push_back({a[i], {i, i, 0}, {*k, *k, 0}});
  if (const std::size_t n = result.pairs.size(); n < a.size() || n < b.size())
    result.notes.push_back(
        fmt::format("{}: {} that both have are compared, of {} in A and {} in B", entries, n, a.size(), b.size()));
  return result;
}

TimePairs in_time(const std::vector<double>& a, const std::vector<double>& b, const std::string& entries) {
  TimePairs result;
  const bool a_leads = a.size() <= b.size();
  const std::vector<double>&few = a_leads ? a : b, &many = a_leads ? b : a;
  const double apart = kSameTime * range_of(a, b);
  std::size_t between = 0;
  for (std::size_t i = 0; i < few.size(); ++i) {
    TimePlace there;
    if (const auto k = entry_at(many, few[i], apart)) {
      there = {*k, *k, 0};
    } else {
      const auto above = std::upper_bound(many.begin(), many.end(), few[i]);
      if (above == many.begin() || above == many.end()) continue;  // one does not reach there
      const auto after = static_cast<std::size_t>(above - many.begin());
      there = {after - 1, after, (few[i] - many[after - 1]) / (many[after] - many[after - 1])};
      ++between;
    }
    const TimePlace here{i, i, 0};
    result.pairs.push_back({few[i], a_leads ? here : there, a_leads ? there : here});
  }
  if (between > 0)
    result.notes.push_back(fmt::format("{}: {} of {} times lie between two of {}, which is interpolated linearly",
                                       entries, between, result.pairs.size(), a_leads ? "B" : "A"));
  else if (result.pairs.size() < many.size())
    result.notes.push_back(fmt::format("{}: {} that both have are compared, of {} in A and {} in B", entries,
                                       result.pairs.size(), a.size(), b.size()));
  return result;
}

}  // namespace

TimePairs pair_times(const std::vector<double>& a, RunKind kind_a, const std::vector<double>& b, RunKind kind_b,
                     const std::string& entries) {
  if (a.empty() && b.empty()) return {};
  if (a.empty() || b.empty()) return {{}, {fmt::format("{}: {} has none", entries, a.empty() ? "A" : "B")}, {}};
  if (kind_a != kind_b || kind_a == RunKind::path) return last_ones(a, b, entries);
  TimePairs result = kind_a == RunKind::dynamics ? in_time(a, b, entries) : common_ones(a, b, entries);
  if (result.pairs.empty() && kind_a == RunKind::statics) result = last_ones(a, b, entries);
  if (std::abs(a.back() - b.back()) > kSameTime * range_of(a, b))
    result.structure.push_back(
        fmt::format("{}: the last of A is at {:.6g}, that of B at {:.6g}", entries, a.back(), b.back()));
  if (result.pairs.empty()) result.structure.push_back(fmt::format("{}: the two have no time in common", entries));
  return result;
}

}  // namespace fascia::app
