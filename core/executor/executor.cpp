#include "core/executor/executor.hpp"

#include "core/base/index.hpp"
#include "core/step/step_loops.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace fascia {

static_assert(IsBlockExecutor<PointExecutor> && IsBlockExecutor<ElementExecutor> && IsBlockExecutor<ShellExecutor> &&
              IsBlockExecutor<UserExecutor>);

namespace {

constexpr int kNodeGrain = 256;

}  // namespace

CpuExecutor::CpuExecutor(const PointSet& set, ThreadPool& pool)
    : set_(set),
      pool_(pool),
      space_(pool),
      node_parts_(set.node_part, set.part_count(), space_),
      springs_(set),
      part_motion_(at(set.part_count())),
      start_motion_(at(set.part_count())),
      part_rounding_(at(set.part_count())),
      node_L_(at(set.node_count())) {
  std::get<Several<PointExecutor>>(blocks_).emplace_back(set, pool);
  for (const ElementBlock& block : set.blocks)
    std::get<Several<ElementExecutor>>(blocks_).emplace_back(block, set, pool);
  for (const ShellBlock& shell : set.shells) std::get<Several<ShellExecutor>>(blocks_).emplace_back(shell, set, pool);
  for (const auto& block : set.user_blocks) std::get<Several<UserExecutor>>(blocks_).emplace_back(*block, set, pool);
  strain_begin_.push_back(0);
  for_each_block([&]<class Kind>(Kind& block, std::size_t) {
    strain_begin_.push_back(strain_begin_.back() + block.strain_size());
    if (block.empty()) return;
    see_motions_ = see_motions_ || Kind::kSeesMotions;
    see_translations_ = see_translations_ || Kind::kSeesTranslations;
    see_state_again_ = see_state_again_ || Kind::kSeesStateAgain;
  });
  if (points().has_tethers()) tether_L_.resize(at(set.node_count()));
}

namespace {

/// A block's part of an array over all; empty where there is no such array.
std::span<const double> part_of(std::span<const double> all, const std::vector<std::size_t>& begin, std::size_t block,
                                std::size_t size = 1) {
  if (all.empty()) return {};
  return all.subspan(begin[block] * size, (begin[block + 1] - begin[block]) * size);
}

}  // namespace

BlockState CpuExecutor::state_of(const State& state, const StrainHistory& history, std::size_t block) const {
  return {.u = state.u,
          .D = state.D.values(),
          .E = part_of(history.E, strain_begin_, block),
          .inverse_step = history.inverse_step,
          .given = part_of(history.given, set_.memory.begin, block, kGivenRows)};
}

BlockState CpuExecutor::state_of(const Linearization& lin, std::size_t block) const {
  return {lin.u,
          lin.D,
          part_of(lin.E, strain_begin_, block),
          lin.inverse_step,
          lin.tangent,
          part_of(lin.kept, lin.kept_begin, block),
          part_of(lin.given, set_.memory.begin, block, kGivenRows)};
}

/// The largest displacement or rotation (taken at the part's length) of each part.
void CpuExecutor::note_motion(const State& state, std::span<double> motion) {
  node_parts_.sum<0, 1>(loops::NodeMotion{nodes_of(set_), {state.u.data(), state.D.data()}}, motion.data());
}

void CpuExecutor::start_from(const State& state) { note_motion(state, start_motion_); }

NodeSum CpuExecutor::sum_at(int node) {
  NodeSum sum;
  for_each_block([&](const auto& block, std::size_t) { block.add_sums(node, sum); });
  return sum;
}

/// Force of each node, with what linearize() needs of it.
void CpuExecutor::sum_forces(const State& state, bool keep_moments, std::span<double> gradient) {
  pool_.for_ranges(set_.node_count(), kNodeGrain, [&](int begin, int end) {
    for (int node = begin; node < end; ++node) {
      double* g = gradient.data() + set_.dofs.begin(node);
      const NodeSum sum = sum_at(node);
      for (int k = 0; k < 3; ++k) g[k] = sum.force[k];
      std::fill(g + 3, g + set_.dofs.size(node), 0.0);
      const FrameKind kind = set_.dofs.kind(node);
      if (kind == FrameKind::vertex) continue;
      if (keep_moments) node_L_[at(node)] = sum.N + times_transpose(sum.N, state.D[at(node)]);  // N Qᵀ
      if (keep_moments && !tether_L_.empty()) {
        const Mat3d N = points().tether_sum(node).N;
        tether_L_[at(node)] = N + times_transpose(N, state.D[at(node)]);
      }
      add_moment(kind, sum.N, Mat3d::identity() + state.D[at(node)], g + 3);
      if (kind == FrameKind::rigid)
        for (int k = 0; k < 3; ++k) g[3 + k] += sum.torque[k];
    }
  });
}

namespace {

std::atomic<long> evaluations_so_far{0};

}  // namespace

long CpuExecutor::evaluations() { return evaluations_so_far; }

void CpuExecutor::sum_terms(const State& state, const StrainHistory& history, bool all, std::span<double> gradient) {
  ++evaluations_so_far;
  for (UserExecutor& block : std::get<Several<UserExecutor>>(blocks_))
    if (block.follow()) ++pattern_;
  for_each_block(
      [&](auto& block, std::size_t b) { block.compute_forces(state_of(state, history, b), all, part_motion_); });
  sum_forces(state, all, gradient);
  springs_.add_forces(state, gradient);
}

void CpuExecutor::forces(const State& state, const StrainHistory& history, std::span<double> gradient) {
  sum_terms(state, history, false, gradient);
}

void CpuExecutor::store_slot_sums(const State& state, const StrainHistory& history, std::vector<double>& out) {
  ++evaluations_so_far;
  std::get<Several<PointExecutor>>(blocks_).front().store_slot_sums(state_of(state, history, 0), out);
}

InternalEnergy CpuExecutor::gradient(const State& state, const StrainHistory& history, std::span<double> gradient) {
  note_motion(state, part_motion_);
  space_.for_each(set_.part_count(), loops::AtLeast{start_motion_.data(), part_motion_.data()});
  sum_terms(state, history, true, gradient);
  InternalEnergy energy;
  std::fill(part_rounding_.begin(), part_rounding_.end(), 0.0);
  for_each_block([&](const auto& block, std::size_t) {
    energy += block.energy();
    block.add_rounding(part_rounding_);
  });
  energy.elastic += springs_.note(state, part_motion_, part_rounding_);
  for (double& r : part_rounding_) r = std::numeric_limits<double>::epsilon() * std::sqrt(r);
  return energy;
}

void CpuExecutor::store_strain(const State& state, AlignedVector<double>& E) {
  E.resize(strain_begin_.back());
  for_each_block([&](auto& block, std::size_t b) {
    block.store_strain(state_of(state, {}, b),
                       std::span(E).subspan(strain_begin_[b], strain_begin_[b + 1] - strain_begin_[b]));
  });
}

void CpuExecutor::store_stress(const State& state, std::span<const double> given, std::span<double> out) {
  StrainHistory history;
  history.given = given;
  const std::vector<std::size_t>& begin = set_.memory.begin;
  for_each_block([&](auto& block, std::size_t b) {
    if (begin[b + 1] == begin[b]) return;
    block.store_stress(state_of(state, history, b), out.subspan(begin[b] * 6, (begin[b + 1] - begin[b]) * 6));
  });
}

BlockEnergies CpuExecutor::energies() const {
  BlockEnergies out;
  out.groups.assign(points().group_elastic().begin(), points().group_elastic().end());
  out.stabilization.assign(points().group_stabilization().begin(), points().group_stabilization().end());
  for (const ElementExecutor& block : of_kind<ElementExecutor>()) out.blocks.push_back(block.energy().elastic);
  for (const ShellExecutor& shell : of_kind<ShellExecutor>()) out.shells.push_back(shell.energy().elastic);
  for (const UserExecutor& block : of_kind<UserExecutor>()) out.user_blocks.push_back(block.energy().elastic);
  out.springs.assign(springs_.energies().begin(), springs_.energies().end());
  return out;
}

}  // namespace fascia
