#pragma once

#include "core/executor/block_executor.hpp"

#include <span>
#include <vector>

namespace fascia {

/// Springs of a set: what acts on one node alone, few beside points and elements, one after the other.
class SpringExecutor {
 public:
  explicit SpringExecutor(const PointSet& set) : set_(set), energy_(set.springs.size()) {}

  /// Adds the gradient of their energy, by degrees of freedom.
  void add_forces(const State& state, std::span<double> gradient) const;
  /// Elastic energy of all; adds squares of their rounding by part [N²].
  double note(const State& state, std::span<const double> part_motion, std::span<double> squares_of_parts);
  /// Adds their second derivative to the nodes' own blocks.
  void add_blocks(const State& state, Tangent tangent, std::span<double> node_blocks) const;
  /// Energy of each at the last note() [J].
  std::span<const double> energies() const { return energy_; }
  /// On its node [N].
  static Vec3d force(const Spring& spring, const State& state);

 private:
  const PointSet& set_;
  std::vector<double> energy_;
};

}  // namespace fascia
