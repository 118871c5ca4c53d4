#include "core/executor/user_executor.hpp"

#include "core/base/errors.hpp"
#include "core/base/incidence.hpp"
#include "core/linear/block_matrix.hpp"

#include <algorithm>
#include <numeric>
#include <string>

namespace fascia {

namespace {

constexpr int kGrain = 16;
constexpr int kAssembledAtOnce = 256;  ///< cells whose matrices wait to be added

}  // namespace

UserExecutor::UserExecutor(const UserBlock& block, const PointSet& set, ThreadPool& pool)
    : block_(block), revision_(block.revision()), set_(set), pool_(pool) {
  list_slots();
}

void UserExecutor::list_slots() {
  for (int c = 0; c < block_.count(); ++c)
    for (const int node : block_.cell(c))
      if (node >= set_.node_count())
        throw InputError("cell " + std::to_string(c) + " of a user block names node " + std::to_string(node) +
                         "; the model has " + std::to_string(set_.node_count()));
  slot_sums_.assign(at(block_.count()) * at(block_.nodes), {});
  poses_.resize(slot_sums_.size());
  motions_.resize(slot_sums_.size());
  dx_.resize(slot_sums_.size());
  cell_energy_.assign(at(block_.count()), 0.0);
  cell_rounding_.assign(at(block_.count()), 0.0);
  const auto for_each_slot = [&](const auto& act) {
    for (int c = 0; c < block_.count(); ++c)
      for (int a = 0; a < block_.nodes; ++a) act(block_.cell(c)[at(a)], block_.nodes * c + a);
  };
  list_by_node(set_.node_count(), for_each_slot, node_slot_begin_, node_slot_);
}

bool UserExecutor::follow() {
  if (revision_ == block_.revision()) return false;
  list_slots();
  revision_ = block_.revision();
  return true;
}

template <class Act>
void UserExecutor::for_cells(int begin, int end, const Act& act) {
  pool_.for_ranges(end - begin, kGrain, [&](int first, int last) {
    for (int cell = begin + first; cell < begin + last; ++cell) act(cell);
  });
}

std::span<const CellPose> UserExecutor::take_poses(const BlockState& state, int cell) {
  const std::span<CellPose> poses = of_cell(poses_, cell);
  const std::span<const int> nodes = block_.cell(cell);
  for (std::size_t a = 0; a < nodes.size(); ++a)
    poses[a] = {state.u[at(nodes[a])], state.D.empty() ? Mat3d{} : state.D[at(nodes[a])]};
  return poses;
}

std::span<const CellMotion> UserExecutor::take_motions(const BlockDirection& direction, int cell) {
  const std::span<CellMotion> motions = of_cell(motions_, cell);
  for (std::size_t a = 0; a < motions.size(); ++a) {
    const double* m = direction.motions.data() + at(block_.cell(cell)[a]) * 12;
    for (int i = 0; i < 3; ++i) {
      motions[a].dx[i] = m[i];
      for (int j = 0; j < 3; ++j) motions[a].dA(i, j) = m[3 + 3 * i + j];
    }
  }
  return motions;
}

/// Rounding is that of the forces, and of the nodes' motion, of whichever part moves most.
void UserExecutor::compute_forces(const BlockState& state, bool energies, std::span<const double> part_motion) {
  for_cells(0, block_.count(), [&](int cell) {
    const std::span<CellForce> out = of_cell(slot_sums_, cell);
    std::fill(out.begin(), out.end(), CellForce{});
    const double energy = block_.forces(cell, take_poses(state, cell), out);
    if (!energies) return;
    cell_energy_[at(cell)] = energy;
    double motion = 0, squares = 0;
    for (const int node : block_.cell(cell)) motion = std::max(motion, part_motion[at(set_.node_part[at(node)])]);
    for (const CellForce& f : out) squares += squared_norm(f.force);
    const double force = block_.stiffness(cell) * block_.length * motion;
    cell_rounding_[at(cell)] = squares + force * force;
  });
  if (energies) energy_ = std::accumulate(cell_energy_.begin(), cell_energy_.end(), 0.0);
}

void UserExecutor::compute_product(const BlockState& state, const BlockDirection& direction) {
  for_cells(0, block_.count(), [&](int cell) {
    const std::span<CellForce> out = of_cell(slot_sums_, cell);
    std::fill(out.begin(), out.end(), CellForce{});
    const std::span<const CellMotion> motions = take_motions(direction, cell);
    block_.product(cell, take_poses(state, cell), state.tangent, motions, out);
  });
}

void UserExecutor::add_sums(int node, NodeSum& sum) const {
  for (int k = node_slot_begin_[at(node)]; k < node_slot_begin_[at(node) + 1]; ++k) {
    const CellForce& f = slot_sums_[at(node_slot_[at(k)])];
    sum.force += f.force;
    sum.N += f.N;
  }
}

/// A cell may tie parts of different stiffness together: each of them has its rounding.
void UserExecutor::add_rounding(std::span<double> squares_of_parts) const {
  for (int cell = 0; cell < block_.count(); ++cell) {
    const std::span<const int> nodes = block_.cell(cell);
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      const int part = set_.node_part[at(nodes[a])];
      const auto same = [&](int node) { return set_.node_part[at(node)] == part; };
      if (std::find_if(nodes.begin(), nodes.end(), same) == nodes.begin() + static_cast<std::ptrdiff_t>(a))
        squares_of_parts[at(part)] += cell_rounding_[at(cell)];
    }
  }
}

double UserExecutor::largest_spin(const BlockDirection& direction) {
  double largest = 0;
  for (int cell = 0; cell < block_.count(); ++cell) {
    const std::span<Vec3d> dx = of_cell(dx_, cell);
    for (std::size_t a = 0; a < dx.size(); ++a) dx[a] = direction.dx[at(block_.cell(cell)[a])];
    largest = std::max(largest, block_.spin(cell, dx));
  }
  return largest;
}

double UserExecutor::largest_step(const BlockState& state, const BlockDirection& direction) {
  double longest = 1;
  for (int cell = 0; cell < block_.count(); ++cell)
    longest = std::min(longest, block_.largest_step(cell, take_poses(state, cell), take_motions(direction, cell)));
  return longest;
}

int UserExecutor::dofs_of_cell(int cell) const {
  int sum = 0;
  for (const int node : block_.cell(cell)) sum += set_.dofs.size(node);
  return sum;
}

void UserExecutor::fill_matrix(const BlockState& state, int cell, std::span<double> K) {
  const std::span<const int> nodes = block_.cell(cell);
  const std::span<const CellPose> poses = take_poses(state, cell);
  const std::span<CellMotion> motions = of_cell(motions_, cell);
  const std::span<CellForce> out = of_cell(slot_sums_, cell);
  const int n = dofs_of_cell(cell);
  std::fill(motions.begin(), motions.end(), CellMotion{});
  int column = 0;
  for (std::size_t b = 0; b < nodes.size(); ++b) {
    for (int k = 0; k < set_.dofs.size(nodes[b]); ++k, ++column) {
      double unit[kMostDofs] = {};
      unit[k] = 1;
      motions[b] = {Vec3d{{unit[0], unit[1], unit[2]}},
                    frame_variation(set_.dofs.kind(nodes[b]), unit + 3, Mat3d::identity() + poses[b].D)};
      std::fill(out.begin(), out.end(), CellForce{});
      block_.product(cell, poses, state.tangent, motions, out);
      int row = 0;
      for (std::size_t a = 0; a < nodes.size(); ++a) {
        double entries[kMostDofs] = {out[a].force[0], out[a].force[1], out[a].force[2]};
        add_moment(set_.dofs.kind(nodes[a]), out[a].N, Mat3d::identity() + poses[a].D, entries + 3);
        for (int i = 0; i < set_.dofs.size(nodes[a]); ++i, ++row) K[at(n * row + column)] = entries[i];
      }
    }
    motions[b] = {};
  }
}

void UserExecutor::add_matrix(int cell, std::span<const double> K, Entries entries, BlockMatrix& matrix) const {
  const std::span<const int> nodes = block_.cell(cell);
  const int n = dofs_of_cell(cell);
  int row = 0;
  for (const int a : nodes) {
    int column = 0;
    for (const int b : nodes) {
      const bool asked = entries == Entries::all || a == b;
      if (asked && (matrix.fills_upper() ? a <= b : a >= b)) {
        double* block = matrix.block(matrix.find(a, b));
        for (int i = 0; i < set_.dofs.size(a); ++i)
          for (int j = 0; j < set_.dofs.size(b); ++j)
            block[set_.dofs.size(b) * i + j] += K[at(n * (row + i) + column + j)];
      }
      column += set_.dofs.size(b);
    }
    row += set_.dofs.size(a);
  }
}

/// Overwrites the sums of the last forces or product.
void UserExecutor::assemble(const BlockState& state, BlockMatrix& matrix, Entries entries) {
  int most = 0;
  for (int cell = 0; cell < block_.count(); ++cell) most = std::max(most, dofs_of_cell(cell));
  const std::size_t size = at(most) * at(most);
  std::vector<double> K(size * at(std::min(block_.count(), kAssembledAtOnce)));
  const auto of = [&](int cell, int begin) { return std::span(K).subspan(at(cell - begin) * size, size); };
  for (int begin = 0; begin < block_.count(); begin += kAssembledAtOnce) {
    const int end = std::min(block_.count(), begin + kAssembledAtOnce);
    for_cells(begin, end, [&](int cell) { fill_matrix(state, cell, of(cell, begin)); });
    for (int cell = begin; cell < end; ++cell) add_matrix(cell, of(cell, begin), entries, matrix);
  }
}

}  // namespace fascia
