#include "core/solver/dof_filter.hpp"

#include "core/math/index.hpp"

#include <algorithm>

namespace fascia {

namespace {

void apply(const Mat3d& A, double* v) {
  const Vec3d r = A * Vec3d{{v[0], v[1], v[2]}};
  std::copy(r.v, r.v + 3, v);
}

}  // namespace

DofFilter::DofFilter(const Model& model)
    : turn_of_node_(at(model.node_count()), -1), fixed_(at(model.dof_count()), false) {
  for (const FrameConstraint& c : model.constraints) {
    const bool identity = c.translation_axes == Mat3d::identity() && c.rotation_axes == Mat3d::identity();
    if (!identity) {
      turn_of_node_[at(c.node)] = static_cast<int>(turns_.size());
      turns_.push_back({c.node, c.translation_axes, c.rotation_axes});
    }
    for (int k = 0; k < c.translations; ++k) fixed_[at(6 * c.node + k)] = true;
    for (int k = 0; k < c.rotations; ++k) fixed_[at(6 * c.node + 3 + k)] = true;
  }
  free_count_ = static_cast<int>(std::count(fixed_.begin(), fixed_.end(), false));
}

void DofFilter::to_local(std::span<double> v) const {
  for (const Turn& t : turns_) {
    apply(t.translation, v.data() + 6 * t.node);
    apply(t.rotation, v.data() + 6 * t.node + 3);
  }
}

void DofFilter::to_global(std::span<double> v) const {
  for (const Turn& t : turns_) {
    apply(transpose(t.translation), v.data() + 6 * t.node);
    apply(transpose(t.rotation), v.data() + 6 * t.node + 3);
  }
}

void DofFilter::clear_fixed(std::span<double> local) const {
  for (std::size_t i = 0; i < fixed_.size(); ++i)
    if (fixed_[i]) local[i] = 0;
}

void DofFilter::rotate_block(int row, int column, const double* in, double* out) const {
  const int tr = turn_of_node_[at(row)], tc = turn_of_node_[at(column)];
  if (tr < 0 && tc < 0) {
    std::copy(in, in + 36, out);
    return;
  }
  for (int I = 0; I < 2; ++I) {
    for (int J = 0; J < 2; ++J) {
      Mat3d m;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m(i, j) = in[6 * (3 * I + i) + 3 * J + j];
      if (tr >= 0) m = (I == 0 ? turns_[at(tr)].translation : turns_[at(tr)].rotation) * m;
      if (tc >= 0) m = times_transpose(m, J == 0 ? turns_[at(tc)].translation : turns_[at(tc)].rotation);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) out[6 * (3 * I + i) + 3 * J + j] = m(i, j);
    }
  }
}

}  // namespace fascia
