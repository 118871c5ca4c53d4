#include "assembly/actions/actions.hpp"
#include "assembly/actions/directions.hpp"
#include "assembly/simulation/simulation.hpp"
#include "assembly/specification/errors.hpp"
#include "core/base/index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace fascia {

namespace {

struct Held : HeldDirections {
  bool whole = false;  ///< by one constraint
};

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

/// The motion that a driver gives; one for all constraints that it moves.
int add_driver(Simulation& s, const Constraint& c) {
  if (c.motion)
    throw SceneError({{c.place, "has a motion and a driver, which gives it another one; remove one of them"}});
  for (const Driver& known : s.drivers)
    if (known.name == c.driver) return known.motion;
  PrescribedMotion m;
  m.schedule = new_schedule(s, {}, c.place);
  m.driven = true;
  s.model.motions.push_back(m);
  s.drivers.push_back({c.driver, static_cast<int>(s.model.motions.size()) - 1});
  return s.drivers.back().motion;
}

int add_motion(Simulation& s, const Constraint& c) {
  if (!c.motion && !c.schedule.dial.empty())
    throw SceneError({{c.place, fmt::format("names the dial \"{}\" without a motion that it could multiply; remove it, "
                                            "or give the motion",
                                            c.schedule.dial)}});
  if (!c.driver.empty()) return add_driver(s, c);
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

bool moves_positions_only(const Constraint& c) {
  return (c.motion || !c.driver.empty()) && !(c.fixed[3] || c.fixed[4] || c.fixed[5]);
}

/// A frame that a driver turns turns about any axis.
void check_driver(const Simulation& s, int body, const Constraint& c) {
  const int turns = c.fixed[3] + c.fixed[4] + c.fixed[5];
  if (c.driver.empty() || turns == 0 || turns == 3 || s.bodies[at(body)].vertices) return;
  throw SceneError({{c.place, fmt::format("is moved by the driver \"{}\" and holds some rotations only; name \"rx\", "
                                          "\"ry\" and \"rz\" in axes, or none of them",
                                          c.driver)}});
}

/// An affine frame that turns through an angle must know all of its A.
void check_affine_turn(const Simulation& s, int body, const Constraint& c) {
  const bool all = std::all_of(c.fixed.begin(), c.fixed.end(), [](bool f) { return f; });
  const bool moves = !c.driver.empty() || (c.motion && c.motion->angle != 0);
  const bool turns = moves && (c.fixed[3] || c.fixed[4] || c.fixed[5]);
  if (turns && !all && s.scene.bodies[at(body)].affine)
    throw SceneError({{c.place, "turns affine frames about some axes only; let it hold all six axes (remove axes)"}});
}

/// Vertices have no rotations: all six axes mean their position, a symmetry plane its normal; other rotations would be
/// lost without a word.
void check_vertex_rotations(const Simulation& s, int body, const Constraint& c) {
  const int places = c.fixed[0] + c.fixed[1] + c.fixed[2], turns = c.fixed[3] + c.fixed[4] + c.fixed[5];
  bool symmetry = places == 1 && turns == 2;
  for (std::size_t k = 0; k < 3; ++k) symmetry = symmetry && c.fixed[k] != c.fixed[3 + k];
  if (turns == 0 || (places > 0 && turns == 3) || symmetry) return;
  throw SceneError({{c.place, fmt::format("holds rotations, which nodes of {} do not have; name \"x\", \"y\" and \"z\" "
                                          "only (a hinge: hold the position of the nodes on its axis)",
                                          s.bodies[at(body)].body->model_name())}});
}

void warn_of_free_rotations(Simulation& s, const Constraint& c, const std::map<int, Held>& held) {
  if (!moves_positions_only(c)) return;
  const int body = body_index(s, c.body);
  if (s.scene.bodies[at(body)].model != BodyModel::meshless) return;
  const std::vector<int> nodes = find_nodes(s, body, c.where);
  const auto turns = [&](int node) {
    const auto found = held.find(node);
    return found == held.end() || found->second.rotation.axis.size() < 3;
  };
  if (std::none_of(nodes.begin(), nodes.end(), turns)) return;
  s.warnings.add("rotations", c.place,
                 "prescribes positions without rotations, which leaves the displacement between frames free (the force "
                 "comes out too small); add \"rx\", \"ry\", \"rz\" to axes");
}

/// A node that another body shares: what holds that body's material there, and what holds the node itself, must agree.
struct SharedHold {
  const Constraint* constraint = nullptr;
  int node = 0, motion = -1;
};

void check_shared(const Simulation& s, const std::vector<SharedHold>& shared, const std::map<int, Held>& held) {
  for (const SharedHold& hold : shared) {
    const auto found = held.find(hold.node);
    if (found == held.end()) continue;
    Directions known = found->second.translation;
    for (int k = 0; k < 3; ++k)
      if (hold.constraint->fixed[at(k)])
        add_direction(s, known, hold.constraint->axes.row(k), hold.motion, false, s.model.rest_position[at(hold.node)],
                      *hold.constraint);
  }
}

}  // namespace

void add_constraints(Simulation& s, PointSetBuilder& points) {
  std::map<int, Held> held;
  TiedPlaces places;
  std::vector<SharedHold> shared;
  for (const Constraint& c : s.scene.constraints) {
    const int motion = add_motion(s, c);
    const int body = body_index(s, c.body);
    const bool interpolates = s.bodies[at(body)].body->interpolates();
    const Body& described = s.scene.bodies[at(body)];
    const bool thin = described.radius || !described.thickness.empty();
    const bool vertices = is_mesh_model(described);
    if (vertices) check_vertex_rotations(s, body, c);
    const int tied = interpolates ? 0 : add_tethers(s, points, body, c, motion, places);
    const bool enough = tied > 0 && (thin || c.fixed[0] || c.fixed[1] || c.fixed[2]);
    check_affine_turn(s, body, c);
    check_driver(s, body, c);
    const bool whole = std::all_of(c.fixed.begin(), c.fixed.end(), [](bool f) { return f; });
    for (const int node : enough ? find_nodes(s, body, c.where) : select_nodes(s, body, c.where)) {
      const Vec3d& X = s.model.rest_position[at(node)];
      if (!interpolates && std::binary_search(s.bodies[at(body)].body->shared_nodes().begin(),
                                              s.bodies[at(body)].body->shared_nodes().end(), node))
        shared.push_back({&c, node, motion});
      if (!interpolates && thin) continue;  // tethers hold all of it
      held[node].whole = held[node].whole || whole;
      for (int k = 0; k < 3; ++k) {
        if (c.fixed[at(k)] && interpolates)
          add_direction(s, held[node].translation, c.axes.row(k), motion, false, X, c);
        if (c.fixed[at(3 + k)] && !vertices && s.model.kind(node) != FrameKind::vertex)
          add_direction(s, held[node].rotation, c.axes.row(k), motion, true, X, c);
      }
    }
  }
  check_shared(s, shared, held);
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

}  // namespace fascia
