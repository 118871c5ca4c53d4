#include "assembly/actions/directions.hpp"

#include "assembly/specification/errors.hpp"
#include "assembly/specification/schedule.hpp"
#include "core/base/index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia {

namespace {

/// The prescribed value along a direction at a factor.
double value(const Simulation& s, int motion, bool rotation, const Vec3d& X, const Vec3d& direction, double factor) {
  if (motion < 0) return 0;
  const PrescribedMotion& m = s.model.motions[at(motion)];
  return dot(direction, rotation ? m.axis * (m.angle * factor) : m.displacement(X, factor));
}

/// Factors at which motions are compared: no motion comes back to its start at all of them.
constexpr double kSamples[] = {0.371943, 0.718282, 1.0};

/// Size of what a motion prescribes: rounding is judged against it.
double scale_of(const Simulation& s, int motion, bool rotation, const Vec3d& X) {
  if (motion < 0) return 1e-300;
  const PrescribedMotion& m = s.model.motions[at(motion)];
  return rotation ? std::abs(m.angle) : norm(m.translation) + (m.angle != 0 ? norm(X - m.center) : 0.0);
}

bool same_schedule(const Simulation& s, int a, int b) {
  const Schedule &first = s.schedules[at(s.model.motions[at(a)].schedule)],
                 &second = s.schedules[at(s.model.motions[at(b)].schedule)];
  if (first.dial != second.dial) return false;
  const bool statics = s.scene.solver.kind == SolverKind::statics;
  for (const double t : {0.0, 0.013, 0.11, 0.371943, 0.718282, 1.0, 3.7, 41.0})
    if (std::abs(schedule_factor(first, t, statics) - schedule_factor(second, t, statics)) > 1e-12) return false;
  return true;
}

}  // namespace

void add_direction(const Simulation& s, Directions& d, const Vec3d& direction, int motion, bool rotation,
                   const Vec3d& X, const Constraint& constraint) {
  const auto driven = [&](int m) { return m >= 0 && s.model.motions[at(m)].driven; };
  const auto moves = [&](int m) {
    if (driven(m)) return true;
    double largest = 0;
    for (const double f : kSamples) largest = std::max(largest, std::abs(value(s, m, rotation, X, direction, f)));
    return largest > 1e-12 * scale_of(s, m, rotation, X);
  };
  if (!moves(motion)) motion = -1;
  Vec3d rest = direction;
  bool oblique_motion = false, other_driver = false;
  double difference = 0;
  for (const double factor : kSamples) {
    double known = 0;
    for (std::size_t k = 0; k < d.axis.size(); ++k)
      known += dot(direction, d.axis[k]) * value(s, d.motion[k], rotation, X, d.axis[k], factor);
    difference = std::max(difference, std::abs(known - value(s, motion, rotation, X, direction, factor)));
  }
  for (std::size_t k = 0; k < d.axis.size(); ++k) {
    const double overlap = dot(direction, d.axis[k]);
    rest -= d.axis[k] * overlap;
    if (std::abs(overlap) > 1e-9 && (driven(motion) || driven(d.motion[k])))
      other_driver = other_driver || motion != d.motion[k];
    oblique_motion = oblique_motion || (std::abs(overlap) > 1e-9 && (motion >= 0 || d.motion[k] >= 0));
  }
  if (norm(rest) < 1e-6) {
    const bool other_time = std::any_of(d.motion.begin(), d.motion.end(), [&](int other) {
      return motion >= 0 && other >= 0 && !same_schedule(s, motion, other);
    });
    const bool other_value = !driven(motion) && difference > 1e-9 * scale_of(s, motion, rotation, X);
    if (other_driver || other_time || other_value)
      throw SceneError(
          {{constraint.place, fmt::format("prescribes another value than an earlier constraint on the same axis "
                                          "at ({:.6g}, {:.6g}, {:.6g}); name each axis once",
                                          X[0], X[1], X[2])}});
    return;
  }
  if (oblique_motion)
    throw SceneError(
        {{constraint.place, fmt::format("moves what is at ({:.6g}, {:.6g}, {:.6g}) along an axis that is neither "
                                        "parallel nor perpendicular to that of another constraint; use one set of axes",
                                        X[0], X[1], X[2])}});
  d.axis.push_back(normalized(rest));
  d.motion.push_back(motion);
}

}  // namespace fascia
