#include "meshless/grid_body.hpp"

#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "meshless/weights.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {

GridBody::GridBody(const GridSpec& spec, Model& model, PointSetBuilder& points)
    : grid_(spec.grid),
      min_(spec.domain.min),
      rotation_(spec.rotation),
      translation_(spec.translation),
      weights_(spec.weights),
      halved_(Mat3d::diagonal(spec.half_blend ? 1.0 : 0.0)),
      distance_(spec.domain.distance) {
  volume_ = spec.domain.volume;
  mass_ = spec.density * spec.domain.volume;
  size_ = norm(spec.domain.max - spec.domain.min);
  surface_ = spec.domain.surface;
  for (int a = 0; a < 3; ++a) spacing_[a] = (spec.domain.max[a] - spec.domain.min[a]) / (grid_[at(a)] - 1);
  for (Vec3d& p : surface_.points) p = to_world(p);
  for (int k = 0; k < grid_[2] - 1; ++k)
    for (int j = 0; j < grid_[1] - 1; ++j)
      for (int i = 0; i < grid_[0] - 1; ++i) cells_.push_back({{i, j, k}, -1, 0, {}});

  std::vector<Sample> samples = sample(spec);
  if (samples.empty())
    throw InputError("no integration point falls inside the domain; use more frames or more points per cell");
  double nominal = 0;
  for (const Sample& s : samples) nominal += s.volume;
  for (Sample& s : samples) s.volume *= volume_ / nominal;

  int full_count = 0;
  for (const Sample& s : samples) full_count = std::max(full_count, ++cells_[at(s.cell)].point_count);
  find_owners(spec, samples, full_count);
  number_frames(spec, samples, model);
  add_points(spec, samples, model, points);
  add_inertia(spec, samples, model);
}

int GridBody::grid_node(const std::array<int, 3>& cell, int corner) const {
  return cell[0] + (corner & 1) + grid_[0] * (cell[1] + (corner >> 1 & 1) + grid_[1] * (cell[2] + (corner >> 2)));
}

Vec3d GridBody::grid_position(int node) const {
  const std::array<int, 3> i{node % grid_[0], node / grid_[0] % grid_[1], node / (grid_[0] * grid_[1])};
  Vec3d x;
  for (int a = 0; a < 3; ++a) x[a] = min_[a] + i[at(a)] * spacing_[a];
  return x;
}

int GridBody::cell_at(const Vec3d& x) const {
  std::array<int, 3> index;
  for (int a = 0; a < 3; ++a)
    index[at(a)] = std::clamp(static_cast<int>(std::floor((x[a] - min_[a]) / spacing_[a])), 0, grid_[at(a)] - 2);
  return index[0] + (grid_[0] - 1) * (index[1] + (grid_[1] - 1) * index[2]);
}

Vec3d GridBody::cell_coordinates(const Vec3d& x, const Cell& cell) const {
  Vec3d xi;
  for (int a = 0; a < 3; ++a) xi[a] = (x[a] - min_[a]) / spacing_[a] - cell.index[at(a)];
  return xi;
}

std::vector<char> GridBody::nodes_on_boundary() const {
  std::vector<int> active_cells(frame_of_grid_node_.size(), 0);
  for (std::size_t c = 0; c < cells_.size(); ++c)
    for (int corner = 0; corner < 8 && cells_[c].owner == static_cast<int>(c); ++corner)
      ++active_cells[at(grid_node(cells_[c].index, corner))];
  std::vector<char> boundary;
  for (std::size_t node = 0; node < active_cells.size(); ++node)
    if (frame_of_grid_node_[node] >= first_node_) boundary.push_back(active_cells[node] < 8 ? 1 : 0);
  boundary.insert(boundary.end(), shared_.size(), 1);
  return boundary;
}

double GridBody::distance(const Vec3d& X) const {
  const Vec3d x = to_local(X);
  if (distance_) return distance_(x);
  Vec3d outside;
  for (int a = 0; a < 3; ++a)
    outside[a] = std::max({min_[a] - x[a], x[a] - min_[a] - spacing_[a] * (grid_[at(a)] - 1), 0.0});
  return norm(outside);
}

Attachment GridBody::attach_local(const Vec3d& x, int cell, const std::array<int, 3>* tetrahedron) const {
  Attachment r;
  r.cell = cells_[at(cell)].owner;
  const Cell& owner = cells_[at(r.cell)];
  const Vec3d xi = cell_coordinates(x, owner);
  const auto fill = [&](const auto& weights) {
    const bool still = !still_.empty() && std::any_of(weights.corner.begin(), weights.corner.end(), [&](int corner) {
      const SharedFrame* share = share_at(grid_node(owner.index, corner));
      return share != nullptr && !share->turns;
    });
    for (std::size_t k = 0; k < weights.w.size(); ++k) {
      const int node = grid_node(owner.index, weights.corner[k]);
      const Vec3d d = rotation_ * (x - grid_position(node));
      Vec3d gradient = weights.gradient[k];
      for (int a = 0; a < 3; ++a) gradient[a] /= spacing_[a];
      const Vec3d g = rotation_ * gradient;
      const Influence own = still ? Influence{weights.w[k], g, {}, {}} : blended(weights.w[k], g, halved_, d);
      const SharedFrame* share = share_at(node);
      r.nodes.push_back(frame_of_grid_node_[at(node)]);
      r.influences.push_back(share == nullptr ? own : on_node(own, share->arm));
    }
  };
  if (weights_ == GridWeightKind::trilinear)
    fill(TrilinearWeights::at(xi));
  else
    fill(tetrahedron != nullptr ? LinearWeights::in_tetrahedron(*tetrahedron, xi) : LinearWeights::at(xi));
  if (!share_.empty()) merge_nodes(r);
  return r;
}

Attachment GridBody::attach(const Vec3d& X) const {
  const Vec3d x = to_local(X);
  return attach_local(x, cell_at(x), nullptr);
}

Attachment GridBody::attach_point(std::size_t point) const {
  const PointCell& p = point_cells_[point];
  return attach_local(to_local(points_[point].X), p.cell,
                      weights_ == GridWeightKind::linear ? &p.tetrahedron : nullptr);
}

Attachment GridBody::attach_volumetric(const Attachment& a) const {
  return selective_ ? attach_local(cells_[at(a.cell)].center, a.cell, nullptr) : a;
}

}  // namespace fascia
