#include "core/node/dof_filter.hpp"

#include "core/base/index.hpp"

#include <algorithm>
#include <cassert>

namespace fascia {

DofFilter::DofFilter(const Model& model)
    : dofs_(model.points.dofs), turn_of_node_(at(model.node_count()), -1), fixed_(at(model.dof_count()), false) {
  for (const FrameConstraint& c : model.constraints) {
    const bool identity = c.translation_axes == Mat3d::identity() && c.rotation_axes == Mat3d::identity();
    if (!identity) {
      turn_of_node_[at(c.node)] = static_cast<int>(turns_.size());
      turns_.push_back({c.node, c.translation_axes, c.rotation_axes});
    }
    const int first = dofs_.begin(c.node);
    for (int k = 0; k < c.translations; ++k) fixed_[at(first + k)] = true;
    if (dofs_.kind(c.node) == FrameKind::vertex) continue;
    if (dofs_.kind(c.node) == FrameKind::rigid) {
      for (int k = 0; k < c.rotations; ++k) fixed_[at(first + 3 + k)] = true;
      continue;
    }
    for (int q = 0; q < 3; ++q)
      for (int i = 0; i < 3; ++i)
        if (c.whole || (i != q && 3 - i - q < c.rotations)) fixed_[at(first + 3 + 3 * q + i)] = true;
  }
  if (!model.constraints.empty()) carried_.assign(at(model.node_count()), 0U);
  for (const FrameConstraint& c : model.constraints) carried_[at(c.node)] = fixed_of(c.node);
  for (const DependentNode& d : model.points.dependents) {
    assert(!fixed_[at(dofs_.begin(d.node))]);  // a rotation that stays its own may be held
    for (int k = 0; k < dependent_dofs(d, dofs_); ++k) fixed_[at(dofs_.begin(d.node) + k)] = true;
  }
  for (std::size_t i = 0; i < fixed_.size(); ++i)
    if (fixed_[i]) fixed_list_.push_back(i);
  free_count_ = static_cast<int>(std::count(fixed_.begin(), fixed_.end(), false));
}

void DofFilter::apply(const DofTurn& turn, bool back, double* v) const {
  turn_dofs(dofs_.kind(turn.node), turn.translation, turn.rotation, back, v);
}

unsigned DofFilter::fixed_of(int node) const {
  unsigned fixed = 0;
  for (int k = 0; k < dofs_.size(node); ++k)
    if (fixed_[at(dofs_.begin(node) + k)]) fixed |= 1U << k;
  return fixed;
}

void DofFilter::to_local(std::span<double> v) const {
  for (const DofTurn& t : turns_) apply(t, false, v.data() + dofs_.begin(t.node));
}

void DofFilter::to_global(std::span<double> v) const {
  for (const DofTurn& t : turns_) apply(t, true, v.data() + dofs_.begin(t.node));
}

void DofFilter::clear_fixed(std::span<double> local) const {
  for (const std::size_t i : fixed_list_) local[i] = 0;
}

void DofFilter::keep_fixed(std::span<double> local) const {
  for (std::size_t i = 0; i < fixed_.size(); ++i)
    if (!fixed_[i]) local[i] = 0;
}

void DofFilter::rotate_block(int row, int column, const double* in, double* out) const {
  turn_block(dofs_.kind(row), turn_of(row), dofs_.kind(column), turn_of(column), in, out);
}

}  // namespace fascia
