#pragma once

#include "tests/random/draws.hpp"

#include <optional>
#include <string>
#include <vector>

namespace fascia::random_scenes {

/// Other units of mass, length and time, and another frame of axes.
struct Frame {
  double mass = 1, length = 1, time = 1;  ///< numbers of the new units that one of the old is
  bool turned = false;                    ///< x to y to z to x
  std::optional<int> mirrored{};          ///< the axis that changes its sign

  /// Factor of numbers with a unit such as "kg m2/s".
  double factor(const std::string& unit) const;
  /// Values of a quantity in this frame, which are scalars, vectors or matrices by rows.
  std::vector<double> values(const std::vector<double>& old, const std::string& quantity,
                             const std::string& unit) const;
};

/// The scene with every number by its dimension and every direction in another frame.
/// @param scene  without texts as quantities
Json in_frame(const Json& scene, const Frame& frame);

/// Why a scene has no exact twin in the frame; empty where it has one.
std::string no_twin(const Json& scene, const Frame& frame);

/// The scene with numbers as texts in units that are not of the SI: "12 mm".
Json with_texts(const Json& scene);

/// The scene with the other linear solver; null where it solves no linear systems.
Json with_other_solver(const Json& scene);

/// The scene in the GPU's steps, by conjugate gradients; null where these do not compute it.
Json with_other_backend(const Json& scene);

}  // namespace fascia::random_scenes
