#pragma once

#include "core/math/mat3.hpp"

#include <span>
#include <vector>

namespace fascia {

/// A matrix for each node of a model. Where no node turns (vertices only) none is stored: each reads as zero, and what
/// is written is lost.
class FrameMatrices {
 public:
  FrameMatrices() = default;
  /// Zeros. @param turning  any node is a frame
  FrameMatrices(std::size_t nodes, bool turning) : values_(turning ? nodes : 0), nodes_(nodes) {}

  std::size_t size() const { return nodes_; }
  const Mat3d& operator[](std::size_t node) const { return values_.empty() ? kZero : values_[node]; }
  Mat3d& operator[](std::size_t node) {
    if (!values_.empty()) return values_[node];
    lost_ = {};
    return lost_;
  }
  /// By node; empty where no node turns.
  std::span<const Mat3d> values() const { return values_; }
  /// Null where no node turns.
  Mat3d* data() { return values_.empty() ? nullptr : values_.data(); }
  const Mat3d* data() const { return values_.empty() ? nullptr : values_.data(); }
  void set_zero() { values_.assign(values_.size(), Mat3d{}); }
  std::vector<Mat3d>::iterator begin() { return values_.begin(); }
  std::vector<Mat3d>::iterator end() { return values_.end(); }

 private:
  static constexpr Mat3d kZero{};
  std::vector<Mat3d> values_;
  std::size_t nodes_ = 0;
  Mat3d lost_;
};

}  // namespace fascia
