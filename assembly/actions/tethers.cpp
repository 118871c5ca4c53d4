#include "assembly/actions/directions.hpp"
#include "assembly/simulation/regions.hpp"
#include "assembly/simulation/simulation.hpp"
#include "assembly/specification/errors.hpp"
#include "core/base/index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace fascia {

namespace {

/// Stiffness of a tether over that of the matter of one frame: what is held gives way by about a ten-thousandth of the
/// deformation around it, and the linear system stays well conditioned.
constexpr double kPenalty = 1e4;
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

/// Collects tethers into groups of points.
class TetherBuilder {
 public:
  TetherBuilder(Simulation& s, PointSetBuilder& points, int body, int motion)
      : s_(s), points_(points), body_(body), motion_(motion), spacing_(mean_spacing(s.bodies[at(body)])) {
    const SimulatedBody& b = s.bodies[at(body)];
    double young = 0;
    for (const MaterialUse& use : s.scene.bodies[at(body)].materials) young = std::max(young, use.material.young());
    stiffness_ = kPenalty * young * b.body->volume() / (static_cast<double>(b.nodes.size()) * spacing_ * spacing_);
  }

  double spacing() const { return spacing_; }

  /// @param shape  selects the directions, a sum of projectors; axes: the same for the check of supports
  void add(const Vec3d& X, const Vec3d& arm, Attachment a, const Mat3d& shape, std::vector<Vec3d> axes) {
    std::set<int> joined = nodes_;
    joined.insert(a.nodes.begin(), a.nodes.end());
    if (!pending_.empty() && (pending_.size() == kGroupSize || joined.size() > kMaxSlots)) flush();
    nodes_.insert(a.nodes.begin(), a.nodes.end());
    s_.tethered.push_back(
        {static_cast<int>(s_.model.tethers.size()), body_, nearest_frame(s_.bodies[at(body_)], X), std::move(axes), a});
    s_.model.tethers.push_back({0, 0, X, motion_, arm});
    pending_.push_back(std::move(a));
    shapes_.push_back(shape * stiffness_);
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
  int body_, motion_;
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
void add_rotation_tethers(TetherBuilder& builder, const Constraint& c, const Vec3d& X, const Attachment& field,
                          double length) {
  const bool turns = c.motion && c.motion->angle != 0, all = c.fixed[3] && c.fixed[4] && c.fixed[5];
  for (int k = 0; k < 3; ++k) {
    if (!c.fixed[at(3 + k)]) continue;
    if (all) {
      const Vec3d arm = c.axes.row(k) * length;
      builder.add(X, arm, director(field, arm), Mat3d::identity(), {c.axes.row(k)});
      continue;
    }
    const Vec3d axis = c.axes.row(k);
    for (const int other : {(k + 1) % 3, (k + 2) % 3}) {
      const Vec3d arm = c.axes.row(other) * length, across = normalized(cross(axis, arm));
      const Mat3d shape = turns ? Mat3d::identity() - outer(axis, axis) : outer(across, across);
      builder.add(X, arm, director(field, arm), shape, {axis});
    }
  }
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
  TetherBuilder builder(s, points, body, motion);
  const double arm = arm_length(s.scene.bodies[at(body)]);
  const std::vector<Vec3d> places = places_in(b, c.where, builder.spacing());
  for (const Vec3d& X : places) {
    HeldDirections& known = tied[{body, {X[0], X[1], X[2]}}];
    for (const Vec3d& axis : axes) add_direction(s, known.translation, axis, motion, false, X, c);
    for (int k = 0; k < 3 && arm > 0; ++k)
      if (c.fixed[at(3 + k)]) add_direction(s, known.rotation, c.axes.row(k), motion, true, X, c);
    const Attachment field = b.body->attach(X);
    if (field.nodes.empty())
      throw SceneError(
          {{c.place, fmt::format("holds material at ({:.4g}, {:.4g}, {:.4g}) that no frame of body \"{}\" moves, "
                                 "since no integration point lies there; give the body more points or frames",
                                 X[0], X[1], X[2], s.scene.bodies[at(body)].name)}});
    if (!axes.empty()) builder.add(X, {}, field, shape, axes);
    if (arm > 0) add_rotation_tethers(builder, c, X, field, arm);
  }
  builder.flush();
  return static_cast<int>(places.size());
}

}  // namespace fascia
