#include "core/math/index.hpp"
#include "core/solver/mechanical_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

/// The part of MechanicalSystem that sums up by connected parts what the verdict on a state is made from.
namespace fascia {

/// Squares of |v| by connected part, torques divided by the part's length, over the free or the prescribed degrees.
void MechanicalSystem::add_squares(std::span<const double> global, std::vector<double>& free,
                                   std::vector<double>& fixed) {
  std::span<const double> local = global;
  if (filter_.turns()) {
    std::copy(global.begin(), global.end(), work_.begin());
    filter_.to_local(work_);
    local = work_;
  }
  free.assign(at(model_.points.part_count()), 0.0);
  fixed.assign(free.size(), 0.0);
  const DofLayout& dofs = model_.points.dofs;
  for (int node = 0; node < model_.node_count(); ++node) {
    const auto part = at(model_.points.node_part[at(node)]);
    if (!filter_.holds(node) && dofs.kind(node) == FrameKind::vertex) {
      const double* v = local.data() + dofs.begin(node);
      free[part] += v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
      continue;
    }
    for (int k = 0; k < dofs.size(node); ++k) {
      const std::size_t i = at(dofs.begin(node) + k);
      const double value = k < 3 ? local[i] : local[i] / model_.points.part_length[part];
      (filter_.is_fixed(i) ? fixed : free)[part] += value * value;
    }
  }
}

/// A load on what a constraint holds goes into the support: however large, it says nothing of what the free nodes have
/// to balance. Dependent nodes, which are held too, hand theirs on to their hosts.
void MechanicalSystem::leave_out_carried_loads() {
  const std::vector<double>& held = part_squares_.held_load;
  if (model_.constraints.empty() || std::all_of(held.begin(), held.end(), [](double square) { return square == 0; }))
    return;
  carried_.assign(load_.size(), 0.0);
  std::copy(load_.begin(), load_.end(), work_.begin());
  filter_.to_local(work_);
  const DofLayout& dofs = model_.points.dofs;
  for (const FrameConstraint& c : model_.constraints)
    for (int i = dofs.begin(c.node); i < dofs.begin(c.node) + dofs.size(c.node); ++i)
      if (filter_.is_fixed(at(i))) carried_[at(i)] = work_[at(i)];
  filter_.to_global(carried_);
  std::vector<double>& sum = uncarried_;
  sum = gradient_;
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += carried_[i];
  add_squares(sum, part_squares_.unused, part_squares_.reaction);
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = load_[i] - carried_[i];
  add_squares(sum, part_squares_.load, part_squares_.held_load);
}

std::vector<PartForces> MechanicalSystem::part_forces() const {
  std::vector<PartForces> parts(part_squares_.residual.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const int part = static_cast<int>(p);
    // 4: sums of a few terms of the estimated size in each entry.
    const double leverage = dependents_.empty() ? 1.0 : dependents_.leverage()[p];
    const double inertia_rounding = std::numeric_limits<double>::epsilon() * std::sqrt(inertia_cancelled_[p]);
    parts[p] = {
        .residual = part_squares_.residual[p],
        .load = part_squares_.load[p] + part_squares_.held_load[p],
        .inertia = part_squares_.inertia[p],
        .reaction = part_squares_.reaction[p],
        .tether = executor_.squared_tether_force(part),
        .momentum = inertia_cancelled_[p],
        .rounding = 4 * leverage * std::hypot(executor_.rounding(part), inertia_rounding, surfaces_.rounding(part))};
    PartForces& f = parts[p];
    if (!kept_loads_.empty()) f.load = std::max(f.load, kept_loads_[p]);
    const double still = kAtRest * masses_[p] * executor_.motion(part) / (form_.h * form_.h);
    f.driven = driven_[p] != 0;
    f.adrift = form_.h > 0 && f.load == 0 && f.reaction == 0 && f.tether == 0 && f.momentum > still * still;
  }
  return parts;
}

}  // namespace fascia
