#pragma once

#include "core/run/explicit_steps_body.hpp"
#include "core/solver/boundary_motion.hpp"
#include "gpu/explicit/explicit.hpp"

#include <utility>
#include <vector>

/// The bodies of ExplicitSystem, for the files that instantiate it.
namespace fascia::gpu {

template <class Space>
ExplicitSystem<Space>::ExplicitSystem(const Model& model, const State& state, const ExplicitPlan& plan,
                                      FactorFunction factors)
    : Base(model, state, plan, std::move(factors)), blocks_(model.points) {
  tethers_.upload(model.tethers);
  still_.resize(at(model.points.part_count()));
  still_.set_zero();
  energies_.resize(blocks_.report_size());
  this->begin();
}

template <class Space>
void ExplicitSystem<Space>::place_tethers(std::span<const double> factors) {
  if (model_.tethers.empty()) return;
  std::vector<double> targets(blocks_.points().targets().size());
  fascia::place_tethers(model_, factors, targets);
  blocks_.points().targets().upload(targets);
}

/// Moves what tethers pull to, and adds the work that this takes.
template <class Space>
void ExplicitSystem<Space>::move_tethers(const Array<Space, double>& factors) {
  Points<Space>& points = blocks_.points();
  Space::template sum<1>(static_cast<int>(tethers_.size()),
                         kernels::MoveTethers{tethers_.data(),
                                              data_.view().motions,
                                              factors.data(),
                                              points.view(),
                                              {pose_.u.data(), pose_.D.data()},
                                              points.targets().data()},
                         kernels::EndTethers{progress_.data()});
}

/// @param faded  of what never fades, where points remember stresses; else as if nothing had faded
template <class Space>
InternalEnergy ExplicitSystem<Space>::energy(bool faded) {
  memory_.prepare({});
  const HistoryView history{.given = faded ? this->given(pose_.memory.data()).data() : nullptr};
  blocks_.forces(data_.view().nodes, {pose_.u.data(), pose_.D.data()}, history, still_.data());
  blocks_.sum_quantities(energies_.data());
  const std::vector<double> q = energies_.downloaded();
  InternalEnergy sum;
  for (std::size_t i = 0; i < q.size(); i += kQuantities) {
    sum.elastic += q[i + kElastic];
    sum.stabilization += q[i + kStabilizing];
  }
  return sum;
}

}  // namespace fascia::gpu
