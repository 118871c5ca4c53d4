#include "core/executor/user_executor.hpp"

#include "core/linear/block_matrix.hpp"

#include <algorithm>
#include <numeric>

namespace fascia {

namespace {

constexpr int kGrain = 16;

}  // namespace

UserExecutor::UserExecutor(const UserBlock& block, const PointSet& set, ThreadPool& pool)
    : block_(block),
      set_(set),
      pool_(pool),
      slot_sums_(at(block.count) * at(block.nodes)),
      poses_(slot_sums_.size()),
      motions_(slot_sums_.size()),
      node_slot_begin_(at(set.node_count()) + 1),
      cell_energy_(at(block.count)),
      cell_rounding_(at(block.count)) {
  const auto for_each_slot = [&](const auto& act) {
    for (int c = 0; c < block_.count; ++c)
      for (int a = 0; a < block_.nodes; ++a) act(block_.cell(c)[at(a)], block_.nodes * c + a);
  };
  for_each_slot([&](int node, int) { ++node_slot_begin_[at(node) + 1]; });
  std::partial_sum(node_slot_begin_.begin(), node_slot_begin_.end(), node_slot_begin_.begin());
  node_slot_.resize(slot_sums_.size());
  std::vector<int> next(node_slot_begin_.begin(), node_slot_begin_.end() - 1);
  for_each_slot([&](int node, int slot) { node_slot_[at(next[at(node)]++)] = slot; });
}

template <class Act>
void UserExecutor::for_each_cell(const Act& act) {
  pool_.for_ranges(block_.count, kGrain, [&](int begin, int end) {
    for (int cell = begin; cell < end; ++cell) act(cell);
  });
}

std::span<const CellPose> UserExecutor::take_poses(const BlockState& state, int cell) {
  const std::span<CellPose> poses = of_cell(poses_, cell);
  const std::span<const int> nodes = block_.cell(cell);
  for (std::size_t a = 0; a < nodes.size(); ++a)
    poses[a] = {state.u[at(nodes[a])], state.D.empty() ? Mat3d{} : state.D[at(nodes[a])]};
  return poses;
}

void UserExecutor::compute_forces(const BlockState& state, bool energies, std::span<const double> part_motion) {
  for_each_cell([&](int cell) {
    const std::span<CellForce> out = of_cell(slot_sums_, cell);
    std::fill(out.begin(), out.end(), CellForce{});
    const double energy = block_.forces(cell, take_poses(state, cell), out);
    if (!energies) return;
    cell_energy_[at(cell)] = energy;
    const double motion = part_motion[at(set_.node_part[at(block_.cell(cell)[0])])];
    const double force = block_.stiffness(cell) * block_.length * motion;
    cell_rounding_[at(cell)] = force * force;
  });
  if (energies) energy_ = std::accumulate(cell_energy_.begin(), cell_energy_.end(), 0.0);
}

void UserExecutor::compute_product(const BlockState& state, const BlockDirection& direction) {
  for_each_cell([&](int cell) {
    const std::span<CellForce> out = of_cell(slot_sums_, cell);
    std::fill(out.begin(), out.end(), CellForce{});
    const std::span<CellMotion> motions = of_cell(motions_, cell);
    for (std::size_t a = 0; a < motions.size(); ++a) {
      const double* m = direction.motions.data() + at(block_.cell(cell)[a]) * 12;
      for (int i = 0; i < 3; ++i) {
        motions[a].dx[i] = m[i];
        for (int j = 0; j < 3; ++j) motions[a].dA(i, j) = m[3 + 3 * i + j];
      }
    }
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

void UserExecutor::add_rounding(std::span<double> squares_of_parts) const {
  for (int cell = 0; cell < block_.count; ++cell)
    squares_of_parts[at(set_.node_part[at(block_.cell(cell)[0])])] += cell_rounding_[at(cell)];
}

/// By rows, over the degrees of freedom of the cell's nodes.
std::vector<double> UserExecutor::matrix_of_cell(const BlockState& state, int cell) {
  const std::span<const int> nodes = block_.cell(cell);
  const std::span<const CellPose> poses = take_poses(state, cell);
  std::vector<int> begin{0};
  for (const int node : nodes) begin.push_back(begin.back() + set_.dofs.size(node));
  const int n = begin.back();
  std::vector<double> K(at(n) * at(n));
  std::vector<CellMotion> motions(nodes.size());
  std::vector<CellForce> out(nodes.size());
  for (std::size_t b = 0; b < nodes.size(); ++b) {
    for (int k = 0; k < set_.dofs.size(nodes[b]); ++k) {
      double unit[kMostDofs] = {};
      unit[k] = 1;
      motions[b] = {Vec3d{{unit[0], unit[1], unit[2]}},
                    frame_variation(set_.dofs.kind(nodes[b]), unit + 3, Mat3d::identity() + poses[b].D)};
      std::fill(out.begin(), out.end(), CellForce{});
      block_.product(cell, poses, state.tangent, motions, out);
      for (std::size_t a = 0; a < nodes.size(); ++a) {
        double column[kMostDofs] = {out[a].force[0], out[a].force[1], out[a].force[2]};
        add_moment(set_.dofs.kind(nodes[a]), out[a].N, Mat3d::identity() + poses[a].D, column + 3);
        for (int i = 0; i < set_.dofs.size(nodes[a]); ++i) K[at(n * (begin[a] + i) + begin[b] + k)] = column[i];
      }
    }
    motions[b] = {};
  }
  return K;
}

void UserExecutor::assemble(const BlockState& state, BlockMatrix& matrix, Entries /*entries*/) {
  std::vector<std::vector<double>> K(at(block_.count));
  for_each_cell([&](int cell) { K[at(cell)] = matrix_of_cell(state, cell); });
  for (int cell = 0; cell < block_.count; ++cell) {
    const std::span<const int> nodes = block_.cell(cell);
    std::vector<int> begin{0};
    for (const int node : nodes) begin.push_back(begin.back() + set_.dofs.size(node));
    for (std::size_t a = 0; a < nodes.size(); ++a)
      for (std::size_t b = 0; b < nodes.size(); ++b) {
        const bool filled = matrix.fills_upper() ? nodes[a] <= nodes[b] : nodes[a] >= nodes[b];
        if (!filled) continue;
        double* block = matrix.block(matrix.find(nodes[a], nodes[b]));
        const int rows = begin[a + 1] - begin[a], columns = begin[b + 1] - begin[b];
        for (int i = 0; i < rows; ++i)
          for (int j = 0; j < columns; ++j)
            block[columns * i + j] += K[at(cell)][at(begin.back() * (begin[a] + i) + begin[b] + j)];
      }
  }
}

}  // namespace fascia
