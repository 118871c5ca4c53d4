#include "app/scene/errors.hpp"
#include "app/schedule.hpp"

#include "app/simulation.hpp"
#include "core/math/index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace fascia::app {

namespace {

/// Prescribed directions of a frame's translation or rotation, orthonormal.
struct Directions {
  std::vector<Vec3d> axis;
  std::vector<int> motion;  ///< −1: held
};

struct Held {
  Directions translation, rotation;
  bool whole = false;  ///< by one constraint
};

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
  const bool statics = s.scene.solver.kind == SolverKind::statics;
  for (const double t : {0.0, 0.013, 0.11, 0.371943, 0.718282, 1.0, 3.7, 41.0})
    if (std::abs(schedule_factor(first, t, statics) - schedule_factor(second, t, statics)) > 1e-12) return false;
  return true;
}

/// Adds a direction; one that is already there must ask for the same.
void add_direction(const Simulation& s, Directions& d, const Vec3d& direction, int motion, bool rotation,
                   const Vec3d& X, const Constraint& constraint) {
  const auto moves = [&](int m) {
    double largest = 0;
    for (const double f : kSamples) largest = std::max(largest, std::abs(value(s, m, rotation, X, direction, f)));
    return largest > 1e-12 * scale_of(s, m, rotation, X);
  };
  if (!moves(motion)) motion = -1;
  Vec3d rest = direction;
  bool oblique_motion = false;
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
    oblique_motion = oblique_motion || (std::abs(overlap) > 1e-9 && (motion >= 0 || d.motion[k] >= 0));
  }
  if (norm(rest) < 1e-6) {
    const bool other_time = std::any_of(d.motion.begin(), d.motion.end(), [&](int other) {
      return motion >= 0 && other >= 0 && !same_schedule(s, motion, other);
    });
    if (other_time || difference > 1e-9 * scale_of(s, motion, rotation, X))
      throw SceneError(
          {{constraint.place, fmt::format("prescribes another value than an earlier constraint on the same axis "
                                          "of the frame at ({:.6g}, {:.6g}, {:.6g}); name each axis once",
                                          X[0], X[1], X[2])}});
    return;
  }
  if (oblique_motion)
    throw SceneError(
        {{constraint.place, fmt::format("moves the frame at ({:.6g}, {:.6g}, {:.6g}) along an axis that is neither "
                                        "parallel nor perpendicular to that of another constraint; use one set of axes",
                                        X[0], X[1], X[2])}});
  d.axis.push_back(normalized(rest));
  d.motion.push_back(motion);
}

/// Rows: the prescribed directions, completed to an orthonormal basis.
Mat3d completed(const Directions& d) {
  std::vector<Vec3d> rows = d.axis;
  for (int k = 0; k < 3 && rows.size() < 3; ++k) {
    Vec3d e;
    e[k] = 1;
    for (const Vec3d& r : rows) e -= r * dot(r, e);
    if (norm(e) > 0.5) rows.push_back(normalized(e));
  }
  return transpose(Mat3d::from_columns(rows[0], rows[1], rows[2]));
}

int add_motion(Simulation& s, const Constraint& c) {
  if (!c.motion) return -1;
  PrescribedMotion m;
  m.schedule = new_schedule(s, c.schedule, c.place);
  m.translation = c.motion->translate;
  m.axis = normalized(c.motion->axis);
  m.center = c.motion->center;
  m.angle = c.motion->angle;
  s.model.motions.push_back(m);
  return static_cast<int>(s.model.motions.size()) - 1;
}

bool moves_positions_only(const Constraint& c) { return c.motion && !(c.fixed[3] || c.fixed[4] || c.fixed[5]); }

/// An affine frame that turns through an angle must know all of its A.
void check_affine_turn(const Simulation& s, int body, const Constraint& c) {
  const bool all = std::all_of(c.fixed.begin(), c.fixed.end(), [](bool f) { return f; });
  const bool turns = c.motion && c.motion->angle != 0 && (c.fixed[3] || c.fixed[4] || c.fixed[5]);
  if (turns && !all && s.scene.bodies[at(body)].affine)
    throw SceneError({{c.place, "turns affine frames about some axes only; let it hold all six axes (remove axes)"}});
}

void warn_of_free_rotations(Simulation& s, const Constraint& c, const std::map<int, Held>& held) {
  if (!moves_positions_only(c)) return;
  const std::vector<int> nodes = find_nodes(s, body_index(s, c.body), c.where);
  const auto turns = [&](int node) {
    const auto found = held.find(node);
    return found == held.end() || found->second.rotation.axis.size() < 3;
  };
  if (std::none_of(nodes.begin(), nodes.end(), turns)) return;
  s.warnings.push_back(
      fmt::format("{}: prescribes positions without rotations, which leaves the displacement between "
                  "frames free (the force comes out too small); add \"rx\", \"ry\", \"rz\" to axes",
                  c.place.key));
}

}  // namespace

void add_constraints(Simulation& s, PointSetBuilder& points) {
  std::map<int, Held> held;
  for (const Constraint& c : s.scene.constraints) {
    const int motion = add_motion(s, c);
    const int body = body_index(s, c.body);
    const bool interpolates = s.bodies[at(body)].meshless->interpolates();
    const Body& described = s.scene.bodies[at(body)];
    const bool thin = described.radius || !described.thickness.empty();
    const int tied = interpolates ? 0 : add_tethers(s, points, body, c, motion);
    check_affine_turn(s, body, c);
    const bool whole = std::all_of(c.fixed.begin(), c.fixed.end(), [](bool f) { return f; });
    for (const int node : tied > 0 ? find_nodes(s, body, c.where) : select_nodes(s, body, c.where)) {
      const Vec3d& X = s.model.rest_position[at(node)];
      held[node].whole = held[node].whole || (whole && interpolates);
      for (int k = 0; k < 3; ++k) {
        if (c.fixed[at(k)] && interpolates)
          add_direction(s, held[node].translation, c.axes.row(k), motion, false, X, c);
        if (c.fixed[at(3 + k)] && (interpolates || !thin))
          add_direction(s, held[node].rotation, c.axes.row(k), motion, true, X, c);
      }
    }
  }
  for (const Constraint& c : s.scene.constraints) warn_of_free_rotations(s, c, held);
  for (const auto& [node, h] : held) {
    FrameConstraint c;
    c.node = node;
    c.whole = h.whole;
    c.translations = static_cast<int>(h.translation.axis.size());
    c.rotations = static_cast<int>(h.rotation.axis.size());
    c.translation_axes = c.translations == 0 ? Mat3d::identity() : completed(h.translation);
    c.rotation_axes = c.rotations == 0 ? Mat3d::identity() : completed(h.rotation);
    for (int k = 0; k < c.translations; ++k) c.translation_motion[at(k)] = h.translation.motion[at(k)];
    for (int k = 0; k < c.rotations; ++k) c.rotation_motion[at(k)] = h.rotation.motion[at(k)];
    s.model.constraints.push_back(c);
  }
}

}  // namespace fascia::app
