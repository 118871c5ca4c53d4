#include "core/base/index.hpp"
#include "core/solver/mechanical_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

/// The part of MechanicalSystem that sums up by connected parts what the verdict on a state is made from.
namespace fascia {

namespace {

/// In constraint axes: itself where those are the world's, else what was turned in `room`.
std::span<const double> local_of(const DofFilter& filter, std::span<const double> global, std::vector<double>& room) {
  if (!filter.turns()) return global;
  room.assign(global.begin(), global.end());
  filter.to_local(room);
  return room;
}

}  // namespace

/// Squares by connected part, torques divided by the part's length. A load on what a constraint holds goes into the
/// support: however large, it says nothing of what the free nodes have to balance. Dependent nodes, which are held too,
/// hand theirs on to their hosts.
void MechanicalSystem::sum_squares() {
  const std::span<const double> load = local_of(filter_, load_, local_[0]);
  const std::span<const double> inertia = local_of(filter_, inertia_, local_[1]);
  const std::span<const double> gradient = local_of(filter_, gradient_, local_[2]);
  PartSquares& s = part_squares_;
  for (auto* sums : {&s.load, &s.inertia, &s.residual, &s.reaction, &s.turned})
    sums->assign(at(model_.points.part_count()), 0.0);
  const DofLayout& dofs = model_.points.dofs;
  for (int node = 0; node < model_.node_count(); ++node) {
    const auto part = at(model_.points.node_part[at(node)]);
    const double length = model_.points.part_length[part], of_torques = 1 / (length * length);
    const unsigned fixed = filter_.holds(node) ? filter_.fixed_of(node) : 0, carried = filter_.carried_of(node);
    const bool turned = carried != 0 && filter_.turn_of(node) != nullptr;
    for (int k = 0; k < dofs.size(node); ++k) {
      const std::size_t i = at(dofs.begin(node) + k);
      const double scale = k < 3 ? 1 : of_torques;
      const double own_load = load[i] * load[i] * scale;
      if (((carried >> k) & 1U) != 0) {
        const double reaction = gradient[i] + load[i];
        s.reaction[part] += reaction * reaction * scale;
        if (turned) s.turned[part] += own_load;
        continue;
      }
      const bool held = ((fixed >> k) & 1U) != 0;
      s.load[part] += own_load;
      if (!held) s.inertia[part] += inertia[i] * inertia[i] * scale;
      (held ? s.reaction : s.residual)[part] += gradient[i] * gradient[i] * scale;
    }
  }
}

std::vector<PartForces> MechanicalSystem::part_forces() const {
  std::vector<PartForces> parts(part_squares_.residual.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const int part = static_cast<int>(p);
    // 4: sums of a few terms of the estimated size in each entry.
    const double leverage = dependents_.empty() ? 1.0 : dependents_.leverage()[p];
    const double cancelled =
        std::numeric_limits<double>::epsilon() * std::sqrt(inertia_cancelled_[p] + part_squares_.turned[p]);
    parts[p] = {.residual = part_squares_.residual[p],
                .load = squared_load(part_squares_.load[p], part_squares_.turned[p]),
                .inertia = part_squares_.inertia[p],
                .reaction = part_squares_.reaction[p],
                .tether = executor_.points().squared_tether_force(part),
                .momentum = inertia_cancelled_[p],
                .rounding = 4 * leverage * std::hypot(executor_.rounding(part), cancelled, surfaces_.rounding(part))};
    PartForces& f = parts[p];
    if (!kept_loads_.empty()) f.load = std::max(f.load, kept_loads_[p]);
    const double still = kAtRest * masses_[p] * executor_.motion(part) / (form_.h * form_.h);
    f.driven = driven_[p] != 0;
    f.adrift = form_.h > 0 && f.load == 0 && f.reaction == 0 && f.tether == 0 && f.momentum > still * still;
  }
  return parts;
}

}  // namespace fascia
