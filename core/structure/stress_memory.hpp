#pragma once

#include "core/base/portability.hpp"
#include "core/physics/viscosity.hpp"

#include <cstddef>
#include <memory>
#include <vector>

namespace fascia {

/// Where the points of a set that remember stresses have them. A point is a lane; those of one block after the other,
/// in the order of CpuExecutor, blocks without such points have none. Symmetric matrices of lanes lie as strains do:
/// eight lanes each, by rows 11 22 33 23 13 12.
struct MemoryLayout {
  static constexpr int kLanes = 8;
  std::vector<std::size_t> begin{0};  ///< (blocks + 1): first lane of each block
  std::vector<int> viscosity;         ///< (lanes): index into `kinds`, −1: the lane remembers nothing
  std::vector<std::shared_ptr<const Viscosity>> kinds;
  int branches = 0;  ///< the most that one of them has

  bool empty() const { return viscosity.empty(); }
  std::size_t lanes() const { return viscosity.size(); }
  /// Numbers that a state keeps: of each lane the stress that fades, S_e, at the end of the last step, then what is
  /// left of it in each branch.
  std::size_t size() const { return lanes() * 6 * static_cast<std::size_t>(1 + branches); }

  /// Place of an entry of a lane among `rows` a lane.
  FASCIA_HD static constexpr std::size_t place(std::size_t lane, int rows, int row) {
    return (lane / kLanes * static_cast<std::size_t>(rows) + static_cast<std::size_t>(row)) * kLanes + lane % kLanes;
  }

  /// Appends a block. @param of_lane  the viscosity of each of its lanes, or null; empty: it remembers nothing
  void add_block(const std::vector<std::shared_ptr<const Viscosity>>& of_lane);
};

/// Rows of what a step adds to the law of a lane: S₀, the factors that act in it, and those of what never fades, by
/// which energies are told apart.
enum GivenRow { kGivenStress = 0, kGivenFactors = 6, kLastingFactors = 8, kGivenRows = 10 };

}  // namespace fascia
