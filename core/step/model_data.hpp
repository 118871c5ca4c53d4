#pragma once

#include "core/node/dof_filter.hpp"
#include "core/space/array.hpp"
#include "core/step/model_view.hpp"

#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

namespace fascia {

/// The nodes of a model in a space. A space that sees the host's memory looks at the model itself, which stays in its
/// place.
template <class Space>
class ModelData {
 public:
  ModelData(const Model& model, const DofFilter& filter, std::size_t schedules);
  ModelData(const ModelData&) = delete;
  ModelData& operator=(const ModelData&) = delete;

  const ModelView& view() const { return view_; }
  /// Reads motions again, as many as there were.
  void show_motions(const std::vector<PrescribedMotion>& motions) { view_.motions = motions_.show(motions); }
  void set_factors(std::span<const double> factors) {
    factors_.upload(factors);
    view_.factors = factors_.data();
  }

 private:
  Shown<Space, FrameKind> kind_;
  Shown<Space, int> dof_, part_;
  Shown<Space, std::size_t> block_;
  Shown<Space, double> part_length_;
  Shown<Space, FrameInertia> inertia_, damping_;
  Shown<Space, FrameConstraint> constraints_;
  Shown<Space, PrescribedMotion> motions_;
  Shown<Space, Vec3d> rest_position_;
  Array<Space, int> turn_, constraint_, load_begin_;
  Array<Space, unsigned> fixed_, carried_;
  Array<Space, DofTurn> turns_;
  Array<Space, ScheduledLoad> loads_;
  Array<Space, double> factors_;
  ModelView view_;
};

template <class Space>
ModelData<Space>::ModelData(const Model& model, const DofFilter& filter, std::size_t schedules) {
  const int n = model.node_count();
  std::vector<int> turn, constraint(at(n), -1), load_begin(at(n + 1), 0);
  std::vector<unsigned> fixed, carried;
  std::vector<DofTurn> turns;
  for (int i = 0; i < n; ++i) {
    fixed.push_back(filter.fixed_of(i));
    carried.push_back(filter.carried_of(i));
    const DofTurn* axes = filter.turn_of(i);
    turn.push_back(axes == nullptr ? -1 : static_cast<int>(turns.size()));
    if (axes != nullptr) turns.push_back(*axes);
  }
  for (std::size_t k = 0; k < model.constraints.size(); ++k)
    constraint[at(model.constraints[k].node)] = static_cast<int>(k);
  std::vector<ScheduledLoad> loads;
  for (const DeadLoad& load : model.loads)
    for (const NodeLoad& l : load.nodes) loads.push_back({load.schedule, l});
  std::stable_sort(loads.begin(), loads.end(),
                   [](const ScheduledLoad& a, const ScheduledLoad& b) { return a.load.node < b.load.node; });
  for (const ScheduledLoad& l : loads) ++load_begin[at(l.load.node + 1)];
  std::partial_sum(load_begin.begin(), load_begin.end(), load_begin.begin());
  fixed_.upload(fixed);
  carried_.upload(carried);
  turn_.upload(turn);
  constraint_.upload(constraint);
  turns_.upload(turns);
  load_begin_.upload(load_begin);
  loads_.upload(loads);
  factors_.resize(schedules);
  const DofLayout& dofs = model.points.dofs;
  view_ = {.nodes = {n, kind_.show(model.frame_kind), dof_.show(dofs.begins()), block_.show(dofs.block_begins()),
                     part_.show(model.points.node_part), part_length_.show(model.points.part_length)},
           .inertia = inertia_.show(model.inertia),
           .damping = damping_.show(model.mass_damping),
           .fixed = fixed_.data(),
           .carried = carried_.data(),
           .turn = turn_.data(),
           .constraint = constraint_.data(),
           .turns = turns_.data(),
           .constraints = constraints_.show(model.constraints),
           .motions = motions_.show(model.motions),
           .rest_position = rest_position_.show(model.rest_position),
           .load_begin = load_begin_.data(),
           .loads = loads_.data(),
           .factors = factors_.data()};
}

}  // namespace fascia
