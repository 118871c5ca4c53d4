#include "meshless/frame_field.hpp"

#include "core/base/index.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fascia {

namespace {

/// Frames whose normals turn away further than this from the place's belong to an opposite wall.
constexpr double kOppositeWall = -0.2;

class NearFrames {
 public:
  NearFrames(std::vector<CloudFrame> frames, Reach reach)
      : frames_(std::move(frames)), reach_(std::move(reach)), search_(positions(frames_)) {
    for (const double s : reach_.support) largest_ = std::max(largest_, s);
  }

  std::vector<NearFrame> at_place(const ScatteredPlace& place) const {
    if (reach_.neighbours > 0) return nearest(place);
    std::vector<NearFrame> near;
    for (const int i : search_.within(place.X, largest_)) {
      const CloudFrame& f = frames_[at(i)];
      const double support = reach_.support[at(i)];
      if (norm(f.x - place.X) < support && same_wall(f, place)) near.push_back({i, f.x, support});
    }
    if (reach_.most > 0 && near.size() > at(reach_.most)) keep_deepest(place, near);
    return near;
  }

 private:
  void keep_deepest(const ScatteredPlace& place, std::vector<NearFrame>& near) const {
    const auto depth = [&](const NearFrame& f) { return std::pair(norm(f.x - place.X) / f.support, f.frame); };
    std::nth_element(near.begin(), near.begin() + reach_.most, near.end(),
                     [&](const NearFrame& a, const NearFrame& b) { return depth(a) < depth(b); });
    near.resize(at(reach_.most));
  }

  static std::vector<Vec3d> positions(const std::vector<CloudFrame>& frames) {
    std::vector<Vec3d> x(frames.size());
    std::transform(frames.begin(), frames.end(), x.begin(), [](const CloudFrame& f) { return f.x; });
    return x;
  }

  static bool same_wall(const CloudFrame& f, const ScatteredPlace& place) {
    return f.dimension != 2 || place.dimension != 2 || dot(f.normal, place.axes.column(2)) > kOppositeWall;
  }

  /// The kernel of the nearest k ends where the next frame stands, so that weights are continuous.
  std::vector<NearFrame> nearest(const ScatteredPlace& place) const {
    std::vector<NearFrame> near;
    for (const int i : search_.nearest(place.X, 2 * reach_.neighbours + 1)) {
      const CloudFrame& f = frames_[at(i)];
      if (same_wall(f, place)) near.push_back({i, f.x, 0});
    }
    const auto k = at(reach_.neighbours);
    const bool more = near.size() > k;
    const double support = near.empty() ? 0 : norm(near[std::min(k, near.size() - 1)].x - place.X) * (more ? 1 : 1.1);
    near.resize(std::min(k, near.size()));
    for (NearFrame& f : near) f.support = support;
    return near;
  }

  std::vector<CloudFrame> frames_;
  Reach reach_;
  FrameSearch search_;
  double largest_ = 0;
};

template <ScatteredWeightFunction W>
FrameField field_of(std::vector<CloudFrame> frames, Reach reach) {
  const auto near = std::make_shared<const NearFrames>(std::move(frames), std::move(reach));
  return [near](const ScatteredPlace& place) { return W::at(place, near->at_place(place)); };
}

}  // namespace

FrameField scattered_field(ScatteredKind kind, std::vector<CloudFrame> frames, Reach reach) {
  switch (kind) {
    case ScatteredKind::shepard:
      return field_of<ShepardWeights>(std::move(frames), std::move(reach));
    case ScatteredKind::wendland:
      return field_of<WendlandWeights>(std::move(frames), std::move(reach));
    case ScatteredKind::cubic_spline:
      return field_of<CubicSplineWeights>(std::move(frames), std::move(reach));
    default:
      return field_of<MlsWeights>(std::move(frames), std::move(reach));
  }
}

int ThinGrid::node_count() const {
  int n = 1;
  for (const int c : count) n *= c;
  return n;
}

Vec3d ThinGrid::position(int node) const {
  Vec3d x = origin;
  for (std::size_t a = 0; a < edge.size(); ++a) {
    x += edge[a] * (static_cast<double>(node % count[a]) / (count[a] - 1));
    node /= count[a];
  }
  return x;
}

FrameField thin_grid_field(const ThinGrid& grid) {
  // Dual edges: coordinates along the edges are dot(X − origin, dual), from 0 to 1.
  std::vector<Vec3d> dual;
  Mat3d tangents;
  if (grid.edge.size() == 1) {
    dual = {grid.edge[0] * (1 / squared_norm(grid.edge[0]))};
    const Vec3d t = normalized(grid.edge[0]);
    tangents = outer(t, t);
  } else {
    const Vec3d n = cross(grid.edge[0], grid.edge[1]);
    dual = {cross(grid.edge[1], n) * (1 / squared_norm(n)), cross(n, grid.edge[0]) * (1 / squared_norm(n))};
    tangents = Mat3d::identity() - outer(n, n) * (1 / squared_norm(n));
  }
  return [grid, dual, tangents](const ScatteredPlace& place) {
    std::array<int, 2> cell{};
    std::array<double, 2> xi{};
    const std::size_t directions = grid.edge.size();
    for (std::size_t a = 0; a < directions; ++a) {
      const double s = dot(place.X - grid.origin, dual[a]) * (grid.count[a] - 1);
      cell[a] = std::clamp(static_cast<int>(std::floor(s)), 0, grid.count[a] - 2);
      xi[a] = s - cell[a];
    }
    ScatteredWeights r;
    r.consistent = tangents;
    for (int k = 0; k < (directions == 2 ? 4 : 2); ++k) {
      int node = 0, stride = 1;
      double w = 1;
      std::array<double, 2> f{1, 1}, slope{};
      for (std::size_t a = 0; a < directions; ++a) {
        const bool upper = (k >> a & 1) != 0;
        f[a] = upper ? xi[a] : 1 - xi[a];
        slope[a] = (upper ? 1 : -1) * (grid.count[a] - 1);
        node += stride * (cell[a] + (upper ? 1 : 0));
        stride *= grid.count[a];
        w *= f[a];
      }
      Vec3d gradient = dual[0] * (slope[0] * f[1]);
      if (directions == 2) gradient += dual[1] * (slope[1] * f[0]);
      r.frame.push_back(node);
      r.w.push_back(w);
      r.gradient.push_back(gradient);
    }
    return r;
  };
}

std::shared_ptr<const KeptWeights> weights_of(const FrameField& field, std::span<const CloudPoint> points,
                                              ThreadPool& pool) {
  return std::make_shared<const KeptWeights>(
      points.size(), [&](std::size_t p) { return field(points[p].place); }, pool);
}

FrameField renumbered_field(FrameField field, std::vector<int> number) {
  return [field = std::move(field), number = std::move(number)](const ScatteredPlace& place) {
    ScatteredWeights r = field(place);
    std::vector<std::size_t> order(r.frame.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t i, std::size_t j) { return number[at(r.frame[i])] < number[at(r.frame[j])]; });
    ScatteredWeights sorted{{}, {}, {}, r.consistent, r.lowered};
    for (const std::size_t k : order) {
      sorted.frame.push_back(number[at(r.frame[k])]);
      sorted.w.push_back(r.w[k]);
      sorted.gradient.push_back(r.gradient[k]);
    }
    return sorted;
  };
}

}  // namespace fascia
