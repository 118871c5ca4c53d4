#pragma once

#include "core/model/model.hpp"
#include "gpu/space.hpp"
#include "gpu/views.hpp"

#include <vector>

/// What loops see of a model, in the memory of the host.
namespace fascia::gpu::test {

class HostNodes {
 public:
  explicit HostNodes(const Model& model) : kind_(model.frame_kind), part_(model.points.node_part) {
    for (int i = 0; i < model.node_count(); ++i) {
      dof_.push_back(model.points.dofs.begin(i));
      block_.push_back(model.points.dofs.block_begin(i));
    }
    dof_.push_back(model.dof_count());
    length_ = model.points.part_length;
  }
  NodesView view() const {
    return {static_cast<int>(kind_.size()), kind_.data(), dof_.data(), block_.data(), part_.data(), length_.data()};
  }

 private:
  std::vector<FrameKind> kind_;
  std::vector<int> dof_, part_;
  std::vector<std::size_t> block_;
  std::vector<double> length_;
};

/// Null where no node turns.
inline Mat3d* matrices(FrameMatrices& m) { return m.values().empty() ? nullptr : &m[0]; }
inline const Mat3d* matrices(const FrameMatrices& m) { return m.values().empty() ? nullptr : m.values().data(); }
inline PoseView pose_of(const State& state) { return {state.u.data(), matrices(state.D)}; }

/// I + D of each node.
inline std::vector<Mat3d> rotations_of(const State& state) {
  std::vector<Mat3d> Q;
  for (std::size_t i = 0; i < state.u.size(); ++i) Q.push_back(Mat3d::identity() + state.D[i]);
  return Q;
}

/// |a − b| / |b| of whole vectors.
inline double relative(const std::vector<double>& a, const std::vector<double>& b) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    difference += (a[i] - b[i]) * (a[i] - b[i]);
    size += b[i] * b[i];
  }
  return a.size() == b.size() && difference == 0 ? 0.0 : std::sqrt(difference / size);
}

}  // namespace fascia::gpu::test
