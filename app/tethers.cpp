#include "app/regions.hpp"
#include "app/simulation.hpp"
#include "core/math/index.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace fascia::app {

namespace {

/// Stiffness of a tether over that of the matter of one frame: what is held gives way by about a ten-thousandth of the
/// deformation around it, and the linear system stays well conditioned.
constexpr double kPenalty = 1e4;
/// Places nearer than this to another one add nothing [spacings].
constexpr double kApart = 0.3;

double mean_spacing(const SimulatedBody& b) {
  double sum = 0;
  for (const Vec3d& x : b.frames) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec3d& y : b.frames)
      if (const double d = norm(x - y); d > 0) nearest = std::min(nearest, d);
    sum += nearest;
  }
  return b.frames.size() > 1 ? sum / static_cast<double>(b.frames.size()) : b.meshless->size();
}

/// Frames, vertices of the surface and integration points in the region, thinned out.
std::vector<Vec3d> places_in(const SimulatedBody& b, const Region& region, double spacing) {
  std::vector<Vec3d> candidates;
  const auto add = [&](const std::vector<Vec3d>& positions, const std::vector<char>& boundary) {
    if (positions.empty()) return;
    const std::vector<bool> chosen = select(region, positions, boundary);
    for (std::size_t i = 0; i < positions.size(); ++i)
      if (chosen[i]) candidates.push_back(positions[i]);
  };
  add(b.frames, b.frame_on_boundary);
  if (!names_frames(region)) {
    const std::vector<Vec3d>& surface = b.meshless->surface().points;
    add(surface, std::vector<char>(surface.size(), 1));
    std::vector<Vec3d> middles;
    for (const BodyPoint& p : b.meshless->points()) middles.push_back(p.middle);
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
  const auto nearer = [&](const Vec3d& p, const Vec3d& q) { return squared_norm(p - x) < squared_norm(q - x); };
  const auto found = std::min_element(b.frames.begin(), b.frames.end(), nearer);
  return b.meshless->first_frame() + static_cast<int>(found - b.frames.begin());
}

/// A tether as a point: the first column of its H is the displacement of the material (core/physics/point_physics.hpp).
PointSample tether_sample(const Attachment& a, const std::vector<int>& nodes, const Mat3d& stiffness, double scale) {
  PointSample sample;
  sample.volume = 1;
  sample.lambda = scale;  // for the rounding estimate
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

}  // namespace

int add_tethers(Simulation& s, PointSetBuilder& points, int body, const Constraint& c, int motion) {
  const SimulatedBody& b = s.bodies[at(body)];
  std::vector<Vec3d> axes;
  for (int k = 0; k < 3; ++k)
    if (c.fixed[at(k)]) axes.push_back(c.axes.row(k));
  if (axes.empty()) return 0;
  const double spacing = mean_spacing(b);
  const std::vector<Vec3d> places = places_in(b, c.where, spacing);
  double young = 0;
  for (const MaterialUse& use : s.scene.bodies[at(body)].materials) young = std::max(young, use.material.young());
  const double scale =
      kPenalty * young * b.meshless->volume() / (static_cast<double>(b.frames.size()) * spacing * spacing);
  Mat3d stiffness;
  for (const Vec3d& a : axes) stiffness += outer(a, a) * scale;

  std::vector<Attachment> pending;
  std::set<int> nodes;
  const auto flush = [&] {
    const std::vector<int> list(nodes.begin(), nodes.end());
    std::vector<PointSample> samples;
    const std::size_t first = s.model.tethers.size() - pending.size();
    for (std::size_t k = 0; k < pending.size(); ++k) {
      samples.push_back(tether_sample(pending[k], list, stiffness, scale));
      s.model.tethers[first + k].group = points.group_count();
      s.model.tethers[first + k].lane = static_cast<int>(k);
    }
    points.add_points(list, samples, spacing, {Law::tether, Stabilization::none, false});
    pending.clear();
    nodes.clear();
  };
  for (const Vec3d& X : places) {
    Attachment a = b.meshless->attach(X);
    std::set<int> joined = nodes;
    joined.insert(a.nodes.begin(), a.nodes.end());
    if (!pending.empty() && (pending.size() == kGroupSize || joined.size() > kMaxSlots)) flush();
    nodes.insert(a.nodes.begin(), a.nodes.end());
    s.tethered.push_back({static_cast<int>(s.model.tethers.size()), body, nearest_frame(b, X), axes, a});
    s.model.tethers.push_back({0, 0, X, motion});
    pending.push_back(std::move(a));
  }
  if (!pending.empty()) flush();
  return static_cast<int>(places.size());
}

}  // namespace fascia::app
