#pragma once

#include "core/base/portability.hpp"
#include "core/physics/active_stress.hpp"
#include "core/physics/viscosity.hpp"

#include <cstddef>
#include <memory>
#include <vector>

namespace fascia {

/// A point's stress has these parts beside that of its law, or neither.
struct StressBeside {
  std::shared_ptr<const Viscosity> viscosity{};
  std::shared_ptr<const ActiveStress> active{};

  explicit operator bool() const { return viscosity || active; }
};

/// Where the points of a set whose stress a step adds to have what is added, and what they remember. A point is a lane;
/// those of one block after the other, in the order of CpuExecutor, blocks without such points have none. Symmetric
/// matrices of lanes lie as strains do: eight lanes each, by rows 11 22 33 23 13 12.
struct MemoryLayout {
  static constexpr int kLanes = 8;
  std::vector<std::size_t> begin{0};  ///< (blocks + 1): first lane of each block
  std::vector<int> viscosity;         ///< (lanes): index into `kinds`, −1: the lane remembers nothing
  std::vector<std::shared_ptr<const Viscosity>> kinds;
  int branches = 0;           ///< the most that one of them has
  std::vector<int> schedule;  ///< (lanes) of the stress that a lane makes by itself, −1: none; empty where no lane does
  std::vector<double> active;  ///< (lanes × 6) this stress at a factor of 1 [Pa]; likewise

  bool empty() const { return viscosity.empty(); }
  bool remembers() const { return !kinds.empty(); }
  bool acts() const { return !schedule.empty(); }
  std::size_t lanes() const { return viscosity.size(); }
  /// Numbers that a state keeps: of each lane the stress that fades, S_e, at the end of the last step, then what is
  /// left of it in each branch.
  std::size_t size() const { return remembers() ? lanes() * 6 * static_cast<std::size_t>(1 + branches) : 0; }

  /// Place of an entry of a lane among `rows` a lane.
  FASCIA_HD static constexpr std::size_t place(std::size_t lane, int rows, int row) {
    return (lane / kLanes * static_cast<std::size_t>(rows) + static_cast<std::size_t>(row)) * kLanes + lane % kLanes;
  }

  /// Appends a block. @param of_lane  what each of its lanes has; empty: nothing
  void add_block(const std::vector<StressBeside>& of_lane);

 private:
  int kind_of(const std::shared_ptr<const Viscosity>& viscosity);
  void act_in_last(const ActiveStress& active);
};

/// Rows of what a step adds to the law of a lane: S₀, the factors that act in it, and those of what never fades, by
/// which energies are told apart.
enum GivenRow { kGivenStress = 0, kGivenFactors = 6, kLastingFactors = 8, kGivenRows = 10 };

}  // namespace fascia
