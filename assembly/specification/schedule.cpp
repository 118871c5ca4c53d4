#include "assembly/specification/schedule.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fascia {

namespace {

double interpolate(const TableProfile& table, double t) {
  const auto& points = table.points;
  if (t <= points.front()[0]) return points.front()[1];
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (t > points[i][0]) continue;
    const double s = (t - points[i - 1][0]) / (points[i][0] - points[i - 1][0]);
    return points[i - 1][1] + s * (points[i][1] - points[i - 1][1]);
  }
  return points.back()[1];
}

}  // namespace

double schedule_factor(const Schedule& schedule, double time, bool statics) {
  if (const auto* table = std::get_if<TableProfile>(&schedule.profile))
    return interpolate(*table, statics ? time * table->points.back()[0] : time);
  if (const auto* sine = std::get_if<SineProfile>(&schedule.profile))
    return std::sin(2 * std::numbers::pi * time / sine->period);
  const double over = statics ? 1.0 : schedule.over;
  const double s = over > 0 ? std::clamp(time / over, 0.0, 1.0) : 1.0;
  return std::holds_alternative<SmoothProfile>(schedule.profile) ? s * s * (3 - 2 * s) : s;
}

double path_factor(const Schedule& schedule, double load_factor) {
  const auto* table = std::get_if<TableProfile>(&schedule.profile);
  if (table == nullptr) return load_factor;
  const auto& points = table->points;
  const std::size_t last = points.size() - 1;
  const double t = load_factor * points[last][0];
  const bool before = t < 0 && points[0][0] <= 0, after = t > points[last][0];
  if (last == 0 || (!before && !after)) return interpolate(*table, t);
  const auto &a = points[before ? 0 : last - 1], &b = points[before ? 1 : last];
  return a[1] + (b[1] - a[1]) * (t - a[0]) / (b[0] - a[0]);
}

}  // namespace fascia
