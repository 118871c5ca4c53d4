#include "app/run/recovery.hpp"

#include "core/base/index.hpp"
#include "core/math/principal_axes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace fascia::app {
namespace {

/// The largest of (distance to the points' centre / their spread)² along an axis that a slope is trusted over: 3 at
/// the face of a hexahedron of 2 × 2 × 2 points, up to 7 at that of tetrahedra of one.
constexpr double kFarthest = 9;

/// Points lie in a plane or on a line where their spread along an axis is this part of the largest; rounding leaves
/// 1e-16.
constexpr double kFlat = 1e-10;

bool of_one_material(const BodyPoint& a, const BodyPoint& b) {
  const LawConstants& constants = a;
  return b == constants && b.law == a.law;
}

/// Stresses jump where materials or thicknesses meet: no slope goes across. @return  what is left of the patch
std::span<NodalRecovery::Share> of_nearest_material(const ModelBody& body, const Vec3d& X,
                                                    std::span<NodalRecovery::Share> patch) {
  const auto point = [&](const NodalRecovery::Share& s) -> const BodyPoint& { return body.points()[at(s.point)]; };
  const auto nearest = std::min_element(patch.begin(), patch.end(), [&](const auto& a, const auto& b) {
    return squared_norm(point(a).X - X) < squared_norm(point(b).X - X);
  });
  if (nearest == patch.end()) return patch;
  const BodyPoint own = point(*nearest);
  const auto end =
      std::remove_if(patch.begin(), patch.end(), [&](const auto& s) { return !of_one_material(own, point(s)); });
  return patch.first(at(static_cast<int>(end - patch.begin())));
}

}  // namespace

/// Points that each node moves, weighted with w v: shares of node i are those from begin_[i] on.
void NodalRecovery::find_patches(const SimulatedBody& b) {
  struct Found {
    int node, point;
    double weight;
  };
  const ModelBody& body = *b.body;
  std::vector<Found> found;
  if (!body.points().empty()) found.reserve(body.points().size() * body.attach_point(0).nodes.size());
  for (std::size_t q = 0; q < body.points().size(); ++q) {
    const Attachment a = body.attach_point(q);
    for (std::size_t k = 0; k < a.nodes.size(); ++k)
      found.push_back({static_cast<int>(b.index_of(a.nodes[k])), static_cast<int>(q),
                       body.points()[q].volume * std::max(a.influences[k].w, 1e-3)});
  }
  for (const Found& f : found) ++begin_[at(f.node) + 1];
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  shares_.resize(found.size());
  for (const Found& f : found) shares_[next[at(f.node)]++] = {f.point, f.weight};
}

NodalRecovery::NodalRecovery(const SimulatedBody& b) : begin_(b.nodes.size() + 1) {
  find_patches(b);
  const ModelBody& body = *b.body;
  const bool uniform = std::all_of(body.points().begin(), body.points().end(),
                                   [&](const BodyPoint& p) { return of_one_material(body.points()[0], p); });
  std::vector<Vec3d> X;  // read often, and points hold much more
  X.reserve(body.points().size());
  for (const BodyPoint& p : body.points()) X.push_back(p.X);
  const auto place = [&](const Share& s) -> const Vec3d& { return X[at(s.point)]; };
  std::size_t kept = 0;  // shares of the nodes before
  for (std::size_t i = 0; i < b.nodes.size(); ++i) {
    std::span<Share> patch = std::span(shares_).subspan(begin_[i], begin_[i + 1] - begin_[i]);
    begin_[i] = kept;
    if (!uniform) patch = of_nearest_material(body, b.nodes[i], patch);
    double sum = 0;
    for (const Share& s : patch) sum += s.weight;
    Vec3d centre;
    for (Share& s : patch) {
      s.weight /= sum;
      centre += place(s) * s.weight;
    }
    Mat3d spread;
    for (const Share& s : patch) spread += outer(place(s) - centre, place(s) - centre) * s.weight;
    const PrincipalAxes principal = principal_axes(spread);
    const Vec3d offset = b.nodes[i] - centre;
    Vec3d slope;
    for (int k = 0; k < 3; ++k) {
      const Vec3d axis = principal.axes[k];
      const double o = dot(axis, offset), o2 = o * o;
      const double reach = std::max({principal.values[k], o2 / kFarthest, kFlat * principal.values[2]});
      if (o2 > 0) slope += axis * (o / reach);
    }
    for (const Share& s : patch) shares_[kept++] = {s.point, s.weight * (1 + dot(slope, place(s) - centre))};
  }
  begin_.back() = kept;
  shares_.resize(kept);
}

std::vector<PointTensors> NodalRecovery::at_nodes(const std::vector<PointTensors>& points, ThreadPool& pool) const {
  constexpr int kGrain = 64;
  std::vector<PointTensors> nodes(begin_.size() - 1);
  pool.for_ranges(static_cast<int>(nodes.size()), kGrain, [&](int begin, int end) {
    for (std::size_t i = at(begin); i < at(end); ++i) {
      for (std::size_t s = begin_[i]; s < begin_[i + 1]; ++s)
        add_share(nodes[i], points[at(shares_[s].point)], shares_[s].weight);
      nodes[i].energy_density = std::max(0.0, nodes[i].energy_density);  // no slope makes it negative
    }
  });
  return nodes;
}

}  // namespace fascia::app
