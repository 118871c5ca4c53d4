#include "meshless/grid_body.hpp"

#include "core/base/errors.hpp"

#include "core/base/index.hpp"
#include "meshless/gauss.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace fascia {

namespace {

/// A cell with a smaller part of its points than this lends them to a neighbour: its outer frames would hang on so few
/// that they could turn almost freely (docs/decisions/cut_cells.md).
constexpr double kSmallCell = 0.3;

/// Where the grid has a single cell, two points see too little of its bending; affine frames then need three in every
/// direction.
int points_of_cell(const GridSpec& spec, int axis) {
  const bool thin = std::find(spec.grid.begin(), spec.grid.end(), 2) != spec.grid.end();
  return spec.grid[at(axis)] == 2 || (spec.affine && thin) ? 3 : 2;
}

}  // namespace

std::vector<GridBody::Sample> GridBody::sample(const GridSpec& spec) const {
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
      rule[a] = gauss_legendre(spec.per_cell ? (*spec.per_cell)[a] : points_of_cell(spec, static_cast<int>(a)));
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

/// Cells with enough points own themselves; from these, layer by layer, each other cell takes the owner among its
/// neighbours' that is nearest, of equals the one with most points.
void GridBody::find_owners(const GridSpec& spec, const std::vector<Sample>& samples, int full_count) {
  int least = std::max(1, static_cast<int>(std::ceil(kSmallCell * full_count)));
  if (std::none_of(cells_.begin(), cells_.end(), [&](const Cell& c) { return c.point_count >= least; })) least = 1;
  if (weights_ == GridWeightKind::linear) {
    // Frames of a tetrahedron without points would be free: such a cell lends its points too.
    std::vector<std::set<std::array<int, 3>>> filled(cells_.size());
    for (const Sample& s : samples) filled[at(s.cell)].insert(s.tetrahedron);
    for (std::size_t c = 0; c < cells_.size(); ++c)
      if (filled[c].size() < 6) cells_[c].whole = false;
    if (std::none_of(cells_.begin(), cells_.end(), [&](const Cell& c) { return c.whole && c.point_count >= least; }))
      throw InputError(
          "no cell of the grid lies deep enough inside the domain for linear weights; use more frames or trilinear "
          "weights");
  }
  int lent = 0;
  std::vector<int> open;
  for (int c = 0; c < static_cast<int>(cells_.size()); ++c) {
    if (cells_[at(c)].whole && cells_[at(c)].point_count >= least) {
      cells_[at(c)].owner = c;
    } else {
      open.push_back(c);
      lent += cells_[at(c)].point_count;
    }
  }
  while (!open.empty()) {
    std::vector<std::pair<int, int>> found;
    std::vector<int> left;
    for (const int c : open) {
      const int owner = nearest_owner(c);
      if (owner >= 0)
        found.emplace_back(c, owner);
      else
        left.push_back(c);
    }
    if (found.empty()) throw InputError("no cell of the grid holds enough of the domain; use more frames");
    for (const auto& [c, owner] : found) cells_[at(c)].owner = owner;
    open = std::move(left);
  }
  if (lent > 0) advise(spec, full_count);
  if (lent > 0)
    choices_.push_back(std::to_string(lent) +
                       " points in cells that the domain hardly fills were given to neighbouring cells");
  std::vector<double> volume(cells_.size());
  for (const Sample& s : samples) {
    const int owner = cells_[at(s.cell)].owner;
    cells_[at(owner)].center += s.x * s.volume;
    volume[at(owner)] += s.volume;
  }
  for (std::size_t c = 0; c < cells_.size(); ++c)
    if (volume[c] > 0) cells_[c].center *= 1 / volume[c];
}

/// What helps where the boundary cuts cells that have few points.
void GridBody::advise(const GridSpec& spec, int full_count) {
  std::array<int, 3> count{};
  for (int a = 0; a < 3; ++a) count[at(a)] = spec.per_cell ? (*spec.per_cell)[at(a)] : points_of_cell(spec, a);
  constexpr int enough = 3;
  const bool few = std::any_of(count.begin(), count.end(), [](int n) { return n < enough; });
  if (weights_ == GridWeightKind::trilinear && few)
    messages_.push_back("the boundary cuts cells that have few points; use 3 in each direction (per_cell = [3, 3, 3])");
  else if (full_count < (weights_ == GridWeightKind::linear ? 24 : count[0] * count[1] * count[2]))
    messages_.push_back("the boundary cuts every cell of the grid; use more frames");
}

/// Best owner among those of the 26 neighbours; −1 where none has one yet.
int GridBody::nearest_owner(int c) const {
  const Cell& cell = cells_[at(c)];
  int best = -1, best_distance = 0;
  for (int n = 0; n < 27; ++n) {
    const std::array<int, 3> i{cell.index[0] + n % 3 - 1, cell.index[1] + n / 3 % 3 - 1, cell.index[2] + n / 9 - 1};
    bool inside = true;
    for (std::size_t a = 0; a < 3; ++a) inside = inside && i[a] >= 0 && i[a] < grid_[a] - 1;
    if (!inside) continue;
    const int owner = cells_[at(i[0] + (grid_[0] - 1) * (i[1] + (grid_[1] - 1) * i[2]))].owner;
    if (owner < 0) continue;
    int distance = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const int d = cell.index[a] - cells_[at(owner)].index[a];
      distance += d * d;
    }
    const bool better = best < 0 || distance < best_distance ||
                        (distance == best_distance && cells_[at(owner)].point_count > cells_[at(best)].point_count);
    if (better) {
      best = owner;
      best_distance = distance;
    }
  }
  return best;
}

void GridBody::number_frames(const GridSpec& spec, const std::vector<Sample>& samples, Model& model) {
  frame_of_grid_node_.assign(at(grid_[0] * grid_[1] * grid_[2]), -1);
  for (const Sample& s : samples)
    for (int corner = 0; corner < 8; ++corner)
      frame_of_grid_node_[at(grid_node(cells_[at(cells_[at(s.cell)].owner)].index, corner))] = 0;
  first_node_ = model.node_count();
  if (!spec.shared.empty()) place_shared(spec);
  int dropped = 0;
  for (int node = 0; node < static_cast<int>(frame_of_grid_node_.size()); ++node) {
    if (frame_of_grid_node_[at(node)] < 0) {
      ++dropped;
      continue;
    }
    if (const SharedFrame* share = share_at(node)) {
      frame_of_grid_node_[at(node)] = share->node;
      continue;
    }
    frame_of_grid_node_[at(node)] = model.node_count();
    model.rest_position.push_back(to_world(grid_position(node)));
    model.rest_orientation.push_back(rotation_);
    model.frame_kind.push_back(spec.affine ? FrameKind::affine : FrameKind::rigid);
  }
  node_count_ = model.node_count() - first_node_;
  if (dropped > 0) choices_.push_back(std::to_string(dropped) + " frames without points were dropped");
}

/// Which frames of the grid others stand for. Those at a frame without points move nothing.
void GridBody::place_shared(const GridSpec& spec) {
  share_of_grid_node_.assign(frame_of_grid_node_.size(), -1);
  std::size_t left_out = 0;
  for (const SharedFrame& s : spec.shared) {
    const Vec3d x = to_local(s.x);
    std::array<int, 3> index;
    for (int a = 0; a < 3; ++a)
      index[at(a)] = static_cast<int>(std::clamp(std::round((x[a] - min_[a]) / spacing_[a]), 0.0, grid_[at(a)] - 1.0));
    const int node = index[0] + grid_[0] * (index[1] + grid_[1] * index[2]);
    const double distance = norm(grid_position(node) - x);
    if (distance > kCoincident * size_) refuse_off_grid(s.x, distance);
    if (frame_of_grid_node_[at(node)] < 0) {
      ++left_out;
      continue;
    }
    refuse_second_share(share_at(node), s);
    if (share_at(node) != nullptr) continue;
    share_of_grid_node_[at(node)] = static_cast<int>(share_.size());
    share_.push_back(s);
  }
  shared_ = distinct_nodes(share_);
  still_ = still_nodes(share_);
  if (!share_.empty()) choices_.push_back(replaced_by_shares(share_.size()));
  if (left_out > 0) messages_.push_back(unreached_shares(left_out));
}

}  // namespace fascia
