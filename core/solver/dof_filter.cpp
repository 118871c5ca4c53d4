#include "core/solver/dof_filter.hpp"

#include "core/math/index.hpp"

#include <algorithm>
#include <cassert>

namespace fascia {

namespace {

void multiply(const Mat3d& A, double* v) {
  const Vec3d r = A * Vec3d{{v[0], v[1], v[2]}};
  std::copy(r.v, r.v + 3, v);
}

}  // namespace

DofFilter::DofFilter(const Model& model)
    : dofs_(model.points.dofs), turn_of_node_(at(model.node_count()), -1), fixed_(at(model.dof_count()), false) {
  held_.assign(turn_of_node_.size(), 0);
  for (const FrameConstraint& c : model.constraints) {
    held_[at(c.node)] = 1;
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
  for (const DependentNode& d : model.points.dependents) {
    assert(!fixed_[at(dofs_.begin(d.node))]);  // a rotation that stays its own may be held
    held_[at(d.node)] = 1;
    for (int k = 0; k < dependent_dofs(d, dofs_); ++k) fixed_[at(dofs_.begin(d.node) + k)] = true;
  }
  for (std::size_t i = 0; i < fixed_.size(); ++i)
    if (fixed_[i]) fixed_list_.push_back(i);
  free_count_ = static_cast<int>(std::count(fixed_.begin(), fixed_.end(), false));
}

void DofFilter::apply(const Turn& turn, bool back, double* v) const {
  const Mat3d T = back ? transpose(turn.translation) : turn.translation;
  const Mat3d R = back ? transpose(turn.rotation) : turn.rotation;
  multiply(T, v);
  if (dofs_.kind(turn.node) == FrameKind::vertex) return;
  if (dofs_.kind(turn.node) == FrameKind::rigid) return multiply(R, v + 3);
  Mat3d A;
  for (int q = 0; q < 3; ++q)
    for (int i = 0; i < 3; ++i) A(i, q) = v[3 + 3 * q + i];
  A = times_transpose(R * A, R);
  for (int q = 0; q < 3; ++q)
    for (int i = 0; i < 3; ++i) v[3 + 3 * q + i] = A(i, q);
}

void DofFilter::to_local(std::span<double> v) const {
  for (const Turn& t : turns_) apply(t, false, v.data() + dofs_.begin(t.node));
}

void DofFilter::to_global(std::span<double> v) const {
  for (const Turn& t : turns_) apply(t, true, v.data() + dofs_.begin(t.node));
}

void DofFilter::clear_fixed(std::span<double> local) const {
  for (const std::size_t i : fixed_list_) local[i] = 0;
}

void DofFilter::keep_fixed(std::span<double> local) const {
  for (std::size_t i = 0; i < fixed_.size(); ++i)
    if (!fixed_[i]) local[i] = 0;
}

void DofFilter::rotate_block(int row, int column, const double* in, double* out) const {
  const int tr = turn_of_node_[at(row)], tc = turn_of_node_[at(column)];
  const int n = dofs_.size(row), m = dofs_.size(column);
  std::copy(in, in + n * m, out);
  if (tc >= 0)
    for (int i = 0; i < n; ++i) apply(turns_[at(tc)], false, out + m * i);
  if (tr < 0) return;
  double v[kMostDofs];
  for (int j = 0; j < m; ++j) {
    for (int i = 0; i < n; ++i) v[i] = out[m * i + j];
    apply(turns_[at(tr)], false, v);
    for (int i = 0; i < n; ++i) out[m * i + j] = v[i];
  }
}

}  // namespace fascia
