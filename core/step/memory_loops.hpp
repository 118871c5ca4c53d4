#pragma once

#include "core/structure/stress_memory.hpp"

/// Loops over the points that remember stresses, or make them by themselves: what they add to a step, and what they
/// keep of it (core/physics/viscosity.hpp, core/physics/active_stress.hpp).
namespace fascia::loops {

/// Memories of all lanes, and the numbers of a step for each kind of viscosity.
struct MemoryView {
  const int* viscosity;  ///< of each lane; −1: none
  const double* step;    ///< (kinds × row_size()): factors, those of what lasts, then decay and gain of each branch
  int branches;
  std::size_t stride;  ///< 6 × lanes
  double* memory;      ///< MemoryLayout::size()

  FASCIA_HD static constexpr int row_size(int branches) { return 4 + 2 * branches; }
  FASCIA_HD const double* step_of(int lane) const { return step + viscosity[lane] * row_size(branches); }
};

/// Stresses that lanes make by themselves, and the factors of their schedules.
struct ActiveView {
  const int* schedule;    ///< of each lane, −1: none; null where no lane acts
  const double* S;        ///< (lanes × 6) at a factor of 1 [Pa]
  const double* factors;  ///< of all schedules

  FASCIA_HD double stress(int lane, std::size_t place) const {
    return schedule == nullptr || schedule[lane] < 0 ? 0 : factors[schedule[lane]] * S[place];
  }
};

/// Writes S₀ and the factors of a step.
struct GiveStress {
  MemoryView m;
  ActiveView active;
  double* given;  ///< (lanes × kGivenRows)

  FASCIA_HD void operator()(int i) const {
    const auto lane = static_cast<std::size_t>(i);
    const double* step = m.viscosity[i] < 0 ? nullptr : m.step_of(i);
    for (int row = 0; row < 4 && step != nullptr; ++row)
      given[MemoryLayout::place(lane, kGivenRows, kGivenFactors + row)] = step[row];
    for (int entry = 0; entry < 6; ++entry) {
      const std::size_t place = MemoryLayout::place(lane, 6, entry);
      double S = active.stress(i, place);
      for (int k = 0; k < m.branches && step != nullptr; ++k)
        S += step[4 + 2 * k] * m.memory[static_cast<std::size_t>(1 + k) * m.stride + place] -
             step[5 + 2 * k] * m.memory[place];
      given[MemoryLayout::place(lane, kGivenRows, kGivenStress + entry)] = S;
    }
  }
};

/// Keeps what is left in each branch at the end of a step, and S_e there.
struct KeepStress {
  MemoryView m;
  const double* S;  ///< S_e at the end, as strains lie

  FASCIA_HD void operator()(int i) const {
    const auto lane = static_cast<std::size_t>(i);
    if (m.viscosity[i] < 0) return;
    const double* step = m.step_of(i);
    for (int entry = 0; entry < 6; ++entry) {
      const std::size_t place = MemoryLayout::place(lane, 6, entry);
      for (int k = 0; k < m.branches; ++k) {
        double& Q = m.memory[static_cast<std::size_t>(1 + k) * m.stride + place];
        Q = step[4 + 2 * k] * Q + step[5 + 2 * k] * (S[place] - m.memory[place]);
      }
      m.memory[place] = S[place];
    }
  }
};

}  // namespace fascia::loops
