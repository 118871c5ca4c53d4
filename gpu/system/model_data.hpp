#pragma once

#include "core/node/dof_filter.hpp"
#include "core/node/node_step.hpp"
#include "core/structure/model.hpp"
#include "gpu/space/array.hpp"
#include "gpu/space/views.hpp"

#include <vector>

namespace fascia::gpu {

/// A dead load on a node, with the number of its schedule.
struct ScheduledLoad {
  int schedule = 0;
  NodeLoad load;
};

/// What a model says of its nodes.
struct ModelView {
  NodesView nodes;
  const FrameInertia *inertia = nullptr, *damping = nullptr;  ///< damping: none where nothing is damped
  const unsigned* fixed = nullptr;                            ///< bit k: the degree of freedom k of the node is fixed
  const unsigned* carried = nullptr;                          ///< and a constraint holds it
  const int *turn = nullptr, *constraint = nullptr;           ///< of each node, −1: none
  const DofTurn* turns = nullptr;
  const FrameConstraint* constraints = nullptr;
  const PrescribedMotion* motions = nullptr;
  const Vec3d* rest_position = nullptr;
  const int* load_begin = nullptr;  ///< (nodes + 1)
  const ScheduledLoad* loads = nullptr;
  const double* factors = nullptr;  ///< of schedules
  int constraint_count = 0;

  FASCIA_HD void to_local(int node, double* v) const {
    if (turn[node] >= 0)
      turn_dofs(nodes.kind[node], turns[turn[node]].translation, turns[turn[node]].rotation, false, v);
  }
  FASCIA_HD void to_global(int node, double* v) const {
    if (turn[node] >= 0)
      turn_dofs(nodes.kind[node], turns[turn[node]].translation, turns[turn[node]].rotation, true, v);
  }
  FASCIA_HD bool is_fixed(int node, int k) const { return (fixed[node] >> k & 1U) != 0; }
  FASCIA_HD const FrameConstraint* held(int node) const {
    return constraint[node] < 0 ? nullptr : constraints + constraint[node];
  }
  FASCIA_HD const FrameInertia* damping_of(int node) const { return damping == nullptr ? nullptr : damping + node; }
};

/// The nodes of a model in a space.
template <class Space>
class ModelData {
 public:
  ModelData(const Model& model, const DofFilter& filter, std::size_t schedules);
  const ModelView& view() const { return view_; }
  void set_factors(std::span<const double> factors) { factors_.upload(factors); }

 private:
  Array<Space, FrameKind> kind_;
  Array<Space, int> dof_, part_, turn_, constraint_, load_begin_;
  Array<Space, std::size_t> block_;
  Array<Space, double> part_length_, factors_;
  Array<Space, FrameInertia> inertia_, damping_;
  Array<Space, unsigned> fixed_, carried_;
  Array<Space, DofTurn> turns_;
  Array<Space, FrameConstraint> constraints_;
  Array<Space, PrescribedMotion> motions_;
  Array<Space, Vec3d> rest_position_;
  Array<Space, ScheduledLoad> loads_;
  ModelView view_;
};

template <class Space>
ModelData<Space>::ModelData(const Model& model, const DofFilter& filter, std::size_t schedules) {
  const DofLayout& dofs = model.points.dofs;
  const int n = model.node_count();
  std::vector<int> dof{0}, turn, constraint(at(n), -1), load_begin(at(n + 1), 0);
  std::vector<std::size_t> block;
  std::vector<unsigned> fixed, carried;
  std::vector<DofTurn> turns;
  for (int i = 0; i < n; ++i) {
    dof.push_back(dofs.begin(i) + dofs.size(i));
    block.push_back(dofs.block_begin(i));
    fixed.push_back(filter.fixed_of(i));
    carried.push_back(filter.carried_of(i));
    const DofTurn* axes = filter.turn_of(i);
    turn.push_back(axes == nullptr ? -1 : static_cast<int>(turns.size()));
    if (axes != nullptr) turns.push_back(*axes);
  }
  for (std::size_t k = 0; k < model.constraints.size(); ++k)
    constraint[at(model.constraints[k].node)] = static_cast<int>(k);
  std::vector<std::vector<ScheduledLoad>> by_node(at(n));
  for (const DeadLoad& load : model.loads)
    for (const NodeLoad& l : load.nodes) by_node[at(l.node)].push_back({load.schedule, l});
  std::vector<ScheduledLoad> loads;
  for (int i = 0; i < n; ++i) {
    loads.insert(loads.end(), by_node[at(i)].begin(), by_node[at(i)].end());
    load_begin[at(i + 1)] = static_cast<int>(loads.size());
  }
  kind_.upload(model.frame_kind);
  dof_.upload(dof);
  block_.upload(block);
  part_.upload(model.points.node_part);
  part_length_.upload(model.points.part_length);
  inertia_.upload(model.inertia);
  damping_.upload(model.mass_damping);
  fixed_.upload(fixed);
  carried_.upload(carried);
  turn_.upload(turn);
  constraint_.upload(constraint);
  turns_.upload(turns);
  constraints_.upload(model.constraints);
  motions_.upload(model.motions);
  rest_position_.upload(model.rest_position);
  load_begin_.upload(load_begin);
  loads_.upload(loads);
  factors_.resize(schedules);
  view_.nodes = {n, kind_.data(), dof_.data(), block_.data(), part_.data(), part_length_.data()};
  view_.inertia = inertia_.data();
  view_.damping = damping_.data();
  view_.fixed = fixed_.data();
  view_.carried = carried_.data();
  view_.turn = turn_.data();
  view_.constraint = constraint_.data();
  view_.turns = turns_.data();
  view_.constraints = constraints_.data();
  view_.motions = motions_.data();
  view_.rest_position = rest_position_.data();
  view_.load_begin = load_begin_.data();
  view_.loads = loads_.data();
  view_.factors = factors_.data();
  view_.constraint_count = static_cast<int>(model.constraints.size());
}

}  // namespace fascia::gpu
