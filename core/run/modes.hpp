#pragma once

#include "core/base/thread_pool.hpp"
#include "core/structure/model.hpp"

#include <string>
#include <vector>

namespace fascia {

/// Natural frequencies and shapes about the rest state, without loads.
struct Modes {
  std::vector<double> frequency;           ///< ascending [Hz]; a free motion has 0
  std::vector<std::vector<double>> shape;  ///< by degrees of freedom, mass-normalised, largest translation positive
  /// Part of the elastic energy that stabilisation holds; a large one is a motion of frames that matter hardly feels.
  std::vector<double> stabilization;
  int iterations = 0;
  bool converged = true;
  /// Largest part of a frequency that rounding leaves open: more than a little where soft parts move beside stiff ones.
  double uncertainty = 0;
  double least = 0;  ///< what is below cannot be told from a free motion, for rounding [Hz]
};

/// Lowest modes of K x = ω² M x by subspace iteration with a factorised K + s M (s only for free bodies).
///
/// @param count  number of modes, at most the number of free degrees of freedom
Modes natural_modes(const Model& model, ThreadPool& pool, int count);

}  // namespace fascia
