#include "meshless/body.hpp"

#include "core/model/errors.hpp"
#include "meshless/gauss.hpp"
#include "meshless/weights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace fascia {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// A cell with a smaller part of its points than this lends them to a neighbour: its outer frames would hang on too few.
constexpr double kSmallCell = 0.2;
/// Above this Poisson ratio full integration locks (docs/manual.md, "Nearly incompressible tissue").
constexpr double kSelectivePoisson = 0.45;

}  // namespace

MeshlessBody::MeshlessBody(const MeshlessSpec& spec, Model& model, PointSetBuilder& points)
    : grid_(spec.grid),
      min_(spec.domain.min),
      rotation_(spec.rotation),
      translation_(spec.translation),
      weights_(spec.weights),
      blend_factor_(spec.half_blend ? 0.5 : 1.0),
      volume_(spec.domain.volume),
      mass_(spec.density * spec.domain.volume),
      size_(norm(spec.domain.max - spec.domain.min)),
      surface_(spec.domain.surface),
      distance_(spec.domain.distance) {
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
  find_owners(samples, full_count);
  number_frames(samples, model);
  add_points(spec, samples, points);
  add_inertia(spec, samples, model);
}

std::vector<MeshlessBody::Sample> MeshlessBody::sample(const MeshlessSpec& spec) const {
  const double cell_volume = spacing_[0] * spacing_[1] * spacing_[2];
  // Candidates of the unit cell.
  std::vector<Sample> unit;
  if (weights_ == GridWeightKind::linear) {
    std::array<int, 3> order{0, 1, 2};
    do {
      for (const auto& bary : kTetrahedronPoints) {
        Sample s;
        s.tetrahedron = order;
        s.volume = 1.0 / 24;
        double coordinate = 0;
        for (int a = 2; a >= 0; --a) s.x[order[at(a)]] = coordinate += bary[at(a + 1)];
        unit.push_back(s);
      }
    } while (std::next_permutation(order.begin(), order.end()));
  } else {
    std::array<std::vector<GaussPoint>, 3> rule;
    for (std::size_t a = 0; a < 3; ++a)
      rule[a] = gauss_legendre(spec.per_cell ? (*spec.per_cell)[a] : (grid_[a] == 2 ? 3 : 2));
    for (const GaussPoint& z : rule[2])
      for (const GaussPoint& y : rule[1])
        for (const GaussPoint& x : rule[0]) unit.push_back({{{x.x, y.x, z.x}}, x.weight * y.weight * z.weight, 0, {}});
  }
  std::vector<Sample> samples;
  for (int c = 0; c < static_cast<int>(cells_.size()); ++c) {
    for (const Sample& u : unit) {
      Sample s = u;
      s.cell = c;
      s.volume *= cell_volume;
      for (int a = 0; a < 3; ++a) s.x[a] = min_[a] + (cells_[at(c)].index[at(a)] + u.x[a]) * spacing_[a];
      if (!spec.domain.contains || spec.domain.contains(s.x)) samples.push_back(s);
    }
  }
  return samples;
}

void MeshlessBody::find_owners(const std::vector<Sample>& samples, int full_count) {
  const int least = std::max(1, static_cast<int>(std::ceil(kSmallCell * full_count)));
  const bool any = std::any_of(cells_.begin(), cells_.end(), [&](const Cell& c) { return c.point_count >= least; });
  std::vector<int> active;
  for (int c = 0; c < static_cast<int>(cells_.size()); ++c)
    if (cells_[at(c)].point_count >= (any ? least : 1)) active.push_back(c);
  int lent = 0;
  for (int c = 0; c < static_cast<int>(cells_.size()); ++c) {
    Cell& cell = cells_[at(c)];
    // The nearest active cell; of equals the one with most points, then the lowest.
    int best_distance = std::numeric_limits<int>::max(), best_count = 0;
    if (cell.point_count >= (any ? least : 1)) {
      cell.owner = c;
      continue;
    }
    for (const int candidate : active) {
      const Cell& other = cells_[at(candidate)];
      int distance = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        const int d = cell.index[a] - other.index[a];
        distance += d * d;
      }
      if (distance < best_distance || (distance == best_distance && other.point_count > best_count)) {
        best_distance = distance;
        best_count = other.point_count;
        cell.owner = candidate;
      }
    }
    lent += cell.point_count;
  }
  if (lent > 0)
    messages_.push_back(std::to_string(lent) + " points in cells that the domain hardly fills were given to neighbouring cells");
  std::vector<double> volume(cells_.size());
  for (const Sample& s : samples) {
    const int owner = cells_[at(s.cell)].owner;
    cells_[at(owner)].center += s.x * s.volume;
    volume[at(owner)] += s.volume;
  }
  for (std::size_t c = 0; c < cells_.size(); ++c)
    if (volume[c] > 0) cells_[c].center *= 1 / volume[c];
}

int MeshlessBody::grid_node(const std::array<int, 3>& cell, int corner) const {
  return cell[0] + (corner & 1) + grid_[0] * (cell[1] + (corner >> 1 & 1) + grid_[1] * (cell[2] + (corner >> 2)));
}

Vec3d MeshlessBody::grid_position(int node) const {
  const std::array<int, 3> i{node % grid_[0], node / grid_[0] % grid_[1], node / (grid_[0] * grid_[1])};
  Vec3d x;
  for (int a = 0; a < 3; ++a) x[a] = min_[a] + i[at(a)] * spacing_[a];
  return x;
}

void MeshlessBody::number_frames(const std::vector<Sample>& samples, Model& model) {
  frame_of_grid_node_.assign(at(grid_[0] * grid_[1] * grid_[2]), -1);
  for (const Sample& s : samples)
    for (int corner = 0; corner < 8; ++corner)
      frame_of_grid_node_[at(grid_node(cells_[at(cells_[at(s.cell)].owner)].index, corner))] = 0;
  first_frame_ = model.node_count();
  int dropped = 0;
  for (int node = 0; node < static_cast<int>(frame_of_grid_node_.size()); ++node) {
    if (frame_of_grid_node_[at(node)] < 0) {
      ++dropped;
      continue;
    }
    frame_of_grid_node_[at(node)] = model.node_count();
    model.rest_position.push_back(to_world(grid_position(node)));
    model.rest_orientation.push_back(rotation_);
  }
  frame_count_ = model.node_count() - first_frame_;
  if (dropped > 0) messages_.push_back(std::to_string(dropped) + " frames without points were dropped");
}

int MeshlessBody::cell_at(const Vec3d& x) const {
  std::array<int, 3> index;
  for (int a = 0; a < 3; ++a)
    index[at(a)] = std::clamp(static_cast<int>(std::floor((x[a] - min_[a]) / spacing_[a])), 0, grid_[at(a)] - 2);
  return index[0] + (grid_[0] - 1) * (index[1] + (grid_[1] - 1) * index[2]);
}

Vec3d MeshlessBody::cell_coordinates(const Vec3d& x, const Cell& cell) const {
  Vec3d xi;
  for (int a = 0; a < 3; ++a) xi[a] = (x[a] - min_[a]) / spacing_[a] - cell.index[at(a)];
  return xi;
}

std::vector<char> MeshlessBody::frames_on_boundary() const {
  std::vector<int> active_cells(frame_of_grid_node_.size(), 0);
  for (std::size_t c = 0; c < cells_.size(); ++c)
    for (int corner = 0; corner < 8 && cells_[c].owner == static_cast<int>(c); ++corner)
      ++active_cells[at(grid_node(cells_[c].index, corner))];
  std::vector<char> boundary;
  for (std::size_t node = 0; node < active_cells.size(); ++node)
    if (frame_of_grid_node_[node] >= 0) boundary.push_back(active_cells[node] < 8 ? 1 : 0);
  return boundary;
}

double MeshlessBody::distance(const Vec3d& X) const {
  const Vec3d x = to_local(X);
  if (distance_) return distance_(x);
  Vec3d outside;
  for (int a = 0; a < 3; ++a)
    outside[a] = std::max({min_[a] - x[a], x[a] - min_[a] - spacing_[a] * (grid_[at(a)] - 1), 0.0});
  return norm(outside);
}

Attachment MeshlessBody::attach_local(const Vec3d& x, int cell, const std::array<int, 3>* tetrahedron) const {
  Attachment r;
  r.cell = cells_[at(cell)].owner;
  const Cell& owner = cells_[at(r.cell)];
  const Vec3d xi = cell_coordinates(x, owner);
  const auto fill = [&](const auto& weights) {
    for (std::size_t k = 0; k < weights.w.size(); ++k) {
      const int node = grid_node(owner.index, weights.corner[k]);
      const Vec3d d = rotation_ * (x - grid_position(node));
      Vec3d gradient = weights.gradient[k];
      for (int a = 0; a < 3; ++a) gradient[a] /= spacing_[a];
      Influence i;
      i.w = weights.w[k];
      i.g = rotation_ * gradient;
      i.b = d * (blend_factor_ * i.w);
      i.B = (outer(d, i.g) + Mat3d::diagonal(i.w)) * blend_factor_;
      r.nodes.push_back(frame_of_grid_node_[at(node)]);
      r.influences.push_back(i);
    }
  };
  if (weights_ == GridWeightKind::trilinear) fill(TrilinearWeights::at(xi));
  else fill(tetrahedron != nullptr ? LinearWeights::in_tetrahedron(*tetrahedron, xi) : LinearWeights::at(xi));
  return r;
}

Attachment MeshlessBody::attach(const Vec3d& X) const {
  const Vec3d x = to_local(X);
  return attach_local(x, cell_at(x), nullptr);
}

Attachment MeshlessBody::attach(const BodyPoint& p) const {
  return attach_local(to_local(p.X), p.cell, weights_ == GridWeightKind::linear ? &p.tetrahedron : nullptr);
}

Attachment MeshlessBody::attach_volumetric(const Attachment& a) const {
  return selective_ ? attach_local(cells_[at(a.cell)].center, a.cell, nullptr) : a;
}

void MeshlessBody::add_points(const MeshlessSpec& spec, const std::vector<Sample>& samples,
                              PointSetBuilder& builder) {
  const double length = std::cbrt(spacing_[0] * spacing_[1] * spacing_[2]);
  std::vector<PointMaterialSpec> materials;
  bool nearly_incompressible = false;
  for (const Sample& s : samples) {
    materials.push_back(spec.material(to_world(s.x)));
    const double poisson = materials.back().lambda / (2 * (materials.back().lambda + materials.back().mu));
    nearly_incompressible = nearly_incompressible || poisson > kSelectivePoisson;
  }
  const bool thick = *std::min_element(grid_.begin(), grid_.end()) >= 3;
  selective_ = weights_ == GridWeightKind::trilinear &&
               (spec.integration == IntegrationKind::selective ||
                (spec.integration == IntegrationKind::automatic && nearly_incompressible && thick));
  if (selective_ && spec.integration == IntegrationKind::automatic)
    messages_.push_back("Poisson ratio above 0.45: lambda is integrated at one point a cell (selective integration)");

  // Points that share their frames, in the order of the cells (and tetrahedra).
  std::map<std::pair<int, std::array<int, 3>>, std::vector<std::size_t>> groups;
  for (std::size_t q = 0; q < samples.size(); ++q)
    groups[{cells_[at(samples[q].cell)].owner, samples[q].tetrahedron}].push_back(q);
  for (const auto& [key, members] : groups) {
    std::vector<PointSample> points;
    std::vector<int> nodes;
    PointSample volumetric;
    for (const std::size_t q : members) {
      const Sample& s = samples[q];
      Attachment a = attach_local(s.x, s.cell, weights_ == GridWeightKind::linear ? &s.tetrahedron : nullptr);
      const PointMaterialSpec& m = materials[q];
      const Vec3d X = to_world(s.x);
      points_.push_back({X, s.volume, m.lambda, m.mu, a.cell, s.tetrahedron});
      points.push_back({X, s.volume, selective_ ? 0.0 : m.lambda, m.mu, spec.drilling * m.mu, m.stiffness_damping,
                        std::move(a.influences)});
      nodes = a.nodes;
      volumetric.volume += s.volume;
      volumetric.lambda += s.volume * m.lambda;
      volumetric.stiffness_damping += s.volume * m.stiffness_damping;
    }
    if (selective_) {
      volumetric.lambda /= volumetric.volume;
      volumetric.stiffness_damping /= volumetric.volume;
      const Attachment a = attach_local(cells_[at(key.first)].center, key.first, nullptr);
      volumetric.influences = a.influences;
      points.push_back(volumetric);
    }
    builder.add_points(nodes, points, length);
  }
}

/// Any partition of unity gives a rigid motion its exact kinetic energy, since each frame takes the full lever. Points
/// lent to a cell count at their nearest place in it, so that no frame's mass turns negative.
void MeshlessBody::add_inertia(const MeshlessSpec& spec, const std::vector<Sample>& samples, Model& model) {
  model.inertia.resize(model.rest_position.size());
  for (const Sample& s : samples) {
    const Cell& owner = cells_[at(cells_[at(s.cell)].owner)];
    Vec3d xi = cell_coordinates(s.x, owner);
    for (int a = 0; a < 3; ++a) xi[a] = std::clamp(xi[a], 0.0, 1.0);
    const Vec3d X = to_world(s.x);
    const double mass_damping = spec.material(X).mass_damping;
    if (mass_damping > 0) model.mass_damping.resize(model.rest_position.size());
    const auto add = [&](const auto& weights) {
      for (std::size_t k = 0; k < weights.w.size(); ++k) {
        const int frame = frame_of_grid_node_[at(grid_node(owner.index, weights.corner[k]))];
        const double m = spec.density * s.volume * weights.w[k];
        const Vec3d d = X - model.rest_position[at(frame)];
        const FrameInertia share{m, d * m, outer(d, d) * m};
        model.inertia[at(frame)] += share;
        if (mass_damping > 0)
          model.mass_damping[at(frame)] += {m * mass_damping, share.first * mass_damping, share.second * mass_damping};
      }
    };
    if (weights_ == GridWeightKind::trilinear) add(TrilinearWeights::at(xi));
    else add(LinearWeights::at(xi));
  }
  if (!model.mass_damping.empty()) model.mass_damping.resize(model.rest_position.size());
}

}  // namespace fascia
