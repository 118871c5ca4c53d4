#include "assembly/actions/tethers.hpp"

#include "assembly/simulation/regions.hpp"
#include "assembly/simulation/simulation.hpp"
#include "core/base/index.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace fascia {

namespace {

/// Stiffness of a tether over that of the matter of one frame: what is held gives way by about a ten-thousandth of the
/// deformation around it, and the linear system stays well conditioned.
constexpr double kPenalty = 1e4;
/// The same of couplings under central differences, whose steps shorten with its root.
constexpr double kExplicitPenalty = 100;
/// Places nearer than this to another one add nothing [spacings].
constexpr double kApart = 0.3;

/// Frames, vertices of the surface and integration points in the region, thinned out.
std::vector<Vec3d> places_in(const SimulatedBody& b, const Region& region, double spacing) {
  std::vector<Vec3d> candidates;
  const auto add = [&](const std::vector<Vec3d>& positions, const std::vector<char>& boundary) {
    if (positions.empty()) return;
    const std::vector<bool> chosen = select(region, {positions, boundary, nullptr, {}, b.body->size()});
    for (std::size_t i = 0; i < positions.size(); ++i)
      if (chosen[i]) candidates.push_back(positions[i]);
  };
  add(b.nodes, b.node_on_boundary);
  if (!names_frames(region)) {
    const std::vector<Vec3d>& surface = b.body->surface().points;
    add(surface, std::vector<char>(surface.size(), 1));
    std::vector<Vec3d> middles;
    for (const BodyPoint& p : b.body->points()) middles.push_back(p.middle);
    add(middles, std::vector<char>(middles.size(), 0));
  }
  std::vector<Vec3d> places;
  const double apart = kApart * spacing;
  for (const Vec3d& x : candidates)
    if (std::none_of(places.begin(), places.end(), [&](const Vec3d& y) { return norm(x - y) < apart; }))
      places.push_back(x);
  return places;
}

int nearest_frame(const SimulatedBody& b, const Vec3d& x) {
  const auto nearer = [&](const Vec3d& p, const Vec3d& q) {
    return squared_norm(p - x) < squared_norm(q - x) * (1 - 1e-9);
  };
  const auto found = std::min_element(b.nodes.begin(), b.nodes.end(), nearer);
  return b.node_ids[static_cast<std::size_t>(found - b.nodes.begin())];
}

/// A tether as a point: the first column of its H is the displacement of the material (core/physics/point_physics.hpp).
PointSample tether_sample(const Attachment& a, const std::vector<int>& nodes, const Mat3d& stiffness) {
  PointSample sample;
  sample.volume = 1;
  sample.lambda = trace(stiffness);  // for the rounding estimate
  sample.axes = stiffness;
  for (const int node : nodes) {
    Influence i;
    for (std::size_t k = 0; k < a.nodes.size(); ++k) {
      if (a.nodes[k] != node) continue;
      i.g[0] = a.influences[k].w;
      for (int q = 0; q < 3; ++q) i.B(q, 0) = a.influences[k].b[q];
    }
    sample.influences.push_back(i);
  }
  return sample;
}

/// The stiffest of a body's materials [Pa]; 0 of a rigid one.
double young_of(const Body& body) {
  double young = 0;
  for (const MaterialUse& use : body.materials) young = std::max(young, use.material.young());
  return young;
}

/// Collects tethers into groups of points.
class TetherBuilder {
 public:
  /// @param modulus  of the springs: Young's of what is tied, times the penalty [Pa]
  TetherBuilder(Simulation& s, PointSetBuilder& points, int body, int motion, double modulus)
      : s_(s), points_(points), motion_(motion), spacing_(mean_spacing(s.bodies[at(body)])) {
    const SimulatedBody& b = s.bodies[at(body)];
    stiffness_ = modulus * b.body->volume() / (static_cast<double>(b.nodes.size()) * spacing_ * spacing_);
  }

  double spacing() const { return spacing_; }

  /// @param shape  selects the directions, a sum of projectors
  /// @return  its number in the model
  int add(const Vec3d& X, const Vec3d& arm, Attachment a, const Mat3d& shape) {
    std::set<int> joined = nodes_;
    joined.insert(a.nodes.begin(), a.nodes.end());
    if (!pending_.empty() && (pending_.size() == kGroupSize || joined.size() > kMaxSlots)) flush();
    nodes_.insert(a.nodes.begin(), a.nodes.end());
    s_.model.tethers.push_back({0, 0, X, motion_, arm});
    pending_.push_back(std::move(a));
    shapes_.push_back(shape * stiffness_);
    return static_cast<int>(s_.model.tethers.size()) - 1;
  }

  void flush() {
    if (pending_.empty()) return;
    const std::vector<int> list(nodes_.begin(), nodes_.end());
    std::vector<PointSample> samples;
    const std::size_t first = s_.model.tethers.size() - pending_.size();
    for (std::size_t k = 0; k < pending_.size(); ++k) {
      samples.push_back(tether_sample(pending_[k], list, shapes_[k]));
      s_.model.tethers[first + k].group = points_.group_count();
      s_.model.tethers[first + k].lane = static_cast<int>(k);
    }
    points_.add_points(list, samples, spacing_, {Law::tether, Stabilization::none, false});
    pending_.clear();
    shapes_.clear();
    nodes_.clear();
  }

 private:
  Simulation& s_;
  PointSetBuilder& points_;
  int motion_;
  double spacing_, stiffness_ = 0;
  std::vector<Attachment> pending_;
  std::vector<Mat3d> shapes_;
  std::set<int> nodes_;
};

/// How far the matter of a thin body reaches off its middle [m].
double arm_length(const Body& body) {
  double arm = body.radius.value_or(0);
  for (const ThicknessUse& use : body.thickness) arm = std::max(arm, 0.5 * use.value);
  return arm;
}

/// The blended rotation, seen as the displacement of an arm: Σ (Q − I) w arm.
Attachment director(const Attachment& field, const Vec3d& arm) {
  Attachment a = field;
  for (Influence& i : a.influences) {
    i.b = arm * i.w;
    i.w = 0;
  }
  return a;
}

/// All rotations: three arms, which hold every entry of the blended rotation. Single ones: arms across each held axis;
/// one that turns far keeps the plane of its turn, one that is held only its direction.
template <class Hold>
void hold_rotations(const Constraint& c, const Vec3d& X, const Attachment& field, double length, const Hold& hold) {
  const bool turns = c.motion && c.motion->angle != 0, all = c.fixed[3] && c.fixed[4] && c.fixed[5];
  for (int k = 0; k < 3; ++k) {
    if (!c.fixed[at(3 + k)]) continue;
    if (all) {
      const Vec3d arm = c.axes.row(k) * length;
      hold(X, arm, director(field, arm), Mat3d::identity(), {c.axes.row(k)});
      continue;
    }
    const Vec3d axis = c.axes.row(k);
    for (const int other : {(k + 1) % 3, (k + 2) % 3}) {
      const Vec3d arm = c.axes.row(other) * length, across = normalized(cross(axis, arm));
      const Mat3d shape = turns ? Mat3d::identity() - outer(axis, axis) : outer(across, across);
      hold(X, arm, director(field, arm), shape, {axis});
    }
  }
}

/// Their motion apart: nodes of one less those of the other.
Attachment difference(const Attachment& one, const Attachment& other) {
  std::map<int, Influence> influences;
  for (std::size_t k = 0; k < one.nodes.size(); ++k) influences[one.nodes[k]] = one.influences[k];
  for (std::size_t k = 0; k < other.nodes.size(); ++k) {
    Influence& i = influences[other.nodes[k]];
    i.w -= other.influences[k].w;
    i.b -= other.influences[k].b;
  }
  Attachment a;
  for (const auto& [node, influence] : influences) {
    a.nodes.push_back(node);
    a.influences.push_back(influence);
  }
  return a;
}

}  // namespace

int add_tethers(Simulation& s, PointSetBuilder& points, int body, const Constraint& c, int motion, TiedPlaces& tied) {
  const SimulatedBody& b = s.bodies[at(body)];
  std::vector<Vec3d> axes;
  Mat3d shape;
  for (int k = 0; k < 3; ++k) {
    if (!c.fixed[at(k)]) continue;
    axes.push_back(c.axes.row(k));
    shape += outer(c.axes.row(k), c.axes.row(k));
  }
  TetherBuilder builder(s, points, body, motion, kPenalty * young_of(s.scene.bodies[at(body)]));
  const auto hold = [&](const Vec3d& X, const Vec3d& along, const Attachment& a, const Mat3d& directions,
                        const std::vector<Vec3d>& held) {
    s.tethered.push_back({builder.add(X, along, a, directions), body, nearest_frame(b, X), held, a});
  };
  const double arm = arm_length(s.scene.bodies[at(body)]);
  const std::vector<Vec3d> places = places_in(b, c.where, builder.spacing());
  for (const Vec3d& X : places) {
    HeldDirections& known = tied[{body, {X[0], X[1], X[2]}}];
    for (const Vec3d& axis : axes) add_direction(s, known.translation, axis, motion, false, X, c);
    for (int k = 0; k < 3 && arm > 0; ++k)
      if (c.fixed[at(3 + k)]) add_direction(s, known.rotation, c.axes.row(k), motion, true, X, c);
    const Attachment field = b.body->attach(X);
    if (!axes.empty()) hold(X, {}, field, shape, axes);
    if (arm > 0) hold_rotations(c, X, field, arm, hold);
  }
  builder.flush();
  return static_cast<int>(places.size());
}

void tie_material(Simulation& s, PointSetBuilder& points, const Coupling& c, BuiltCoupling& built,
                  const HostOf& host_of) {
  const int body = body_index(s, c.body);
  const SimulatedBody& b = s.bodies[at(body)];
  const Body &own = s.scene.bodies[at(body)], &other = s.scene.bodies[at(body_index(s, c.to))];
  const double young = young_of(own), of_host = young_of(other);
  const double penalty = s.scene.solver.kind == SolverKind::central_differences ? kExplicitPenalty : kPenalty;
  TetherBuilder builder(s, points, body, -1, penalty * (of_host > 0 ? std::min(young, of_host) : young));
  const auto tie = [&](const Vec3d& X, const Vec3d& arm, const Attachment& field, const Attachment& host) {
    built.ties.push_back({{builder.add(X, arm, difference(field, host), Mat3d::identity()),
                           body,
                           nearest_frame(b, X),
                           {{{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}},
                           field},
                          host});
  };
  // Welds hold rotations too, of solids by arms within the reach of a frame.
  const double thin = arm_length(own), length = thin > 0 ? thin : 0.5 * builder.spacing();
  for (const Vec3d& X : places_in(b, c.where, builder.spacing())) {
    const std::optional<Attachment> host = host_of(X);
    if (!host) continue;
    const Attachment field = b.body->attach(X);
    tie(X, {}, field, *host);
    for (int k = 0; k < 3 && c.kind == CouplingKind::weld; ++k) {
      Vec3d arm;
      arm[k] = length;
      tie(X, arm, director(field, arm), director(*host, arm));
    }
  }
  builder.flush();
}

}  // namespace fascia
