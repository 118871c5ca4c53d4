#pragma once

#include "core/structure/stress_memory.hpp"

/// Loops over the points that remember stresses: what they add to a step, and what they keep of it
/// (core/physics/viscosity.hpp).
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

/// Writes S₀ and the factors of a step.
struct GiveStress {
  MemoryView m;
  double* given;  ///< (lanes × kGivenRows)

  FASCIA_HD void operator()(int i) const {
    const auto lane = static_cast<std::size_t>(i);
    if (m.viscosity[i] < 0) return;
    const double* step = m.step_of(i);
    for (int row = 0; row < 4; ++row) given[MemoryLayout::place(lane, kGivenRows, kGivenFactors + row)] = step[row];
    for (int entry = 0; entry < 6; ++entry) {
      const std::size_t place = MemoryLayout::place(lane, 6, entry);
      double S = 0;
      for (int k = 0; k < m.branches; ++k)
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
