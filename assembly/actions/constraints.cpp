#include "assembly/actions/actions.hpp"
#include "assembly/actions/directions.hpp"
#include "assembly/simulation/regions.hpp"
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

bool holds_rotations(const Constraint& c) { return c.fixed[3] || c.fixed[4] || c.fixed[5]; }
bool holds_positions(const Constraint& c) { return c.fixed[0] || c.fixed[1] || c.fixed[2]; }
bool is_moved(const Constraint& c) { return c.motion || !c.driver.empty(); }

/// Nodes that span a face, not those of a hinge.
bool span_face(const Simulation& s, const std::vector<int>& nodes) {
  const auto X = [&](std::size_t i) { return s.model.rest_position[at(nodes[i])]; };
  std::size_t far = 0;
  for (std::size_t i = 1; i < nodes.size(); ++i)
    if (squared_norm(X(i) - X(0)) > squared_norm(X(far) - X(0))) far = i;
  if (far == 0) return false;
  const Vec3d along = X(far) - X(0);
  for (std::size_t i = 1; i < nodes.size(); ++i)
    if (norm(cross(along, X(i) - X(0))) > 1e-6 * squared_norm(along)) return true;
  return false;
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
  const bool place = c.fixed[0] && c.fixed[1] && c.fixed[2];
  if (!(place || (is_moved(c) && holds_positions(c))) || holds_rotations(c)) return;
  const int body = body_index(s, c.body);
  if (s.scene.bodies[at(body)].model != BodyModel::meshless) return;
  const std::vector<int> nodes = find_nodes(s, body, c.where);
  const auto turns = [&](int node) {
    const auto found = held.find(node);
    return found == held.end() || found->second.rotation.axis.size() < 3;
  };
  if (std::none_of(nodes.begin(), nodes.end(), turns)) return;
  if (is_moved(c))
    s.warnings.add("rotations", c.place,
                   "prescribes positions without rotations, which leaves the displacement between frames free (the "
                   "force comes out too small); add \"rx\", \"ry\", \"rz\" to axes");
  else if (span_face(s, nodes))
    s.warnings.add(
        "rotations", c.place,
        "prescribes positions without rotations on a face, which leaves the displacement between frames free "
        "(the body comes out too soft); use fix = \"all\" or \"symmetry\", or name rotations too");
}

/// A rigid body is one frame at its mass centre: that is what a constraint holds, whatever points its region has.
void warn_of_place(Simulation& s, const Constraint& c, const std::map<int, Held>& held) {
  const int body = body_index(s, c.body);
  const auto found = held.find(s.bodies[at(body)].body->first_node());
  const bool turns = found == held.end() || found->second.rotation.axis.size() < 3;
  if (s.scene.bodies[at(body)].model != BodyModel::rigid || !holds_positions(c) || !turns) return;
  const SimulatedBody& b = s.bodies[at(body)];
  if (b.body->surface().points.empty()) return;
  const std::vector<bool> chosen = select(c.where, b.selectable_surface());
  if (std::all_of(chosen.begin(), chosen.end(), [](bool in) { return in; })) return;
  const Vec3d& X = s.model.rest_position[at(b.body->first_node())];
  s.warnings.add("rigid", c.place,
                 fmt::format("holds the mass centre of the rigid body, ({:.6g}, {:.6g}, {:.6g}), and not the points in "
                             "where; use where = \"all\" where that is meant, or hold points by a spring of "
                             "[couplings]",
                             X[0], X[1], X[2]));
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

/// Keeps what constraints hold, by node.
struct Holds {
  std::map<int, Held> held;
  TiedPlaces places;
  std::vector<SharedHold> shared;
};

void add_constraint(Simulation& s, PointSetBuilder& points, const Constraint& c, Holds& holds) {
  const int motion = add_motion(s, c);
  const int body = body_index(s, c.body);
  const bool interpolates = s.bodies[at(body)].body->interpolates();
  const Body& described = s.scene.bodies[at(body)];
  const bool thin = described.radius || !described.thickness.empty();
  const bool vertices = is_mesh_model(described);
  if (vertices) check_vertex_rotations(s, body, c);
  const int tied = interpolates ? 0 : add_tethers(s, points, body, c, motion, holds.places);
  const bool enough = tied > 0 && (thin || holds_positions(c));
  check_affine_turn(s, body, c);
  check_driver(s, body, c);
  const bool whole = std::all_of(c.fixed.begin(), c.fixed.end(), [](bool f) { return f; });
  for (const int node : enough ? find_nodes(s, body, c.where) : select_nodes(s, body, c.where)) {
    const Vec3d& X = s.model.rest_position[at(node)];
    if (!interpolates && std::binary_search(s.bodies[at(body)].body->shared_nodes().begin(),
                                            s.bodies[at(body)].body->shared_nodes().end(), node))
      holds.shared.push_back({&c, node, motion});
    if (!interpolates && thin) continue;  // tethers hold all of it
    Held& held = holds.held[node];
    held.whole = held.whole || whole;
    for (int k = 0; k < 3; ++k) {
      if (c.fixed[at(k)] && interpolates) add_direction(s, held.translation, c.axes.row(k), motion, false, X, c);
      if (c.fixed[at(3 + k)] && !vertices && s.model.kind(node) != FrameKind::vertex)
        add_direction(s, held.rotation, c.axes.row(k), motion, true, X, c);
    }
  }
}

}  // namespace

void add_constraints(Simulation& s, PointSetBuilder& points) {
  Holds holds;
  SceneErrors errors;
  for (const Constraint& c : s.scene.constraints) errors.gather([&] { add_constraint(s, points, c, holds); });
  errors.tell();
  const std::map<int, Held>& held = holds.held;
  check_shared(s, holds.shared, held);
  for (const Constraint& c : s.scene.constraints) {
    warn_of_free_rotations(s, c, held);
    warn_of_place(s, c, held);
  }
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
