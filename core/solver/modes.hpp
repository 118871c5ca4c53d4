#pragma once

#include "core/cpu/thread_pool.hpp"
#include "core/model/model.hpp"

#include <string>
#include <vector>

namespace fascia {

/// Natural frequencies and shapes about the rest state, without loads.
struct Modes {
  std::vector<double> frequency;           ///< ascending [Hz]; a free motion has 0
  std::vector<std::vector<double>> shape;  ///< 6 a frame, mass-normalised, largest translation positive
  int iterations = 0;
  bool converged = true;
};

/// Lowest modes of K x = ω² M x by subspace iteration with a factorised K + s M (s only for free bodies).
///
/// @param count  number of modes, at most the number of free degrees of freedom
Modes natural_modes(const Model& model, ThreadPool& pool, int count);

}  // namespace fascia
