#pragma once

#include "app/compare/rest_field.hpp"

#include <string>

namespace fascia::app {

/// A place that two results of a body have in common.
struct SharedPlace {
  Vec3d X{};          ///< at rest
  double weight = 0;  ///< see Sample
  Stencil a, b;
};

/// The places at which two results of a body are compared, and what became of those that only one has.
struct BodyPair {
  bool same_mesh = false;  ///< the same points, cells and rest positions
  int sampled = 0;         ///< whose quadrature points: 0 of the first, 1 of the second
  int dimension = 0;       ///< of what is sampled: 3 volume, 2 surface, 1 lines, 0 points
  double measure = 0;      ///< its volume, area or length, of what was left out too [m³, m², m]
  double size = 0;         ///< diagonal of the larger bounding box [m]
  double beside = 0;       ///< part of the measure that lies beside the other, which is taken at its nearest place
  double farthest = 0;     ///< distance of those places from the other [m]
  double left_out = 0;     ///< part of the measure that lies farther than kReach from the other, and is not compared
  std::vector<SharedPlace> places;
  std::vector<Stencil> checks_a, checks_b;  ///< see RestField::checks()
};

/// Places beside the other body up to this part of its size are compared with its nearest place: meshes of a curved
/// body are chords of it.
inline constexpr double kReach = 0.02;

/// Samples what has the lower dimension, then what has cells, then what has more points. In the same mesh nothing is
/// interpolated: both have the stencils of the first.
/// @param volume_a, volume_b  see rest_field()
BodyPair pair_bodies(const io::VisualMesh& a, double volume_a, const io::VisualMesh& b, double volume_b);

}  // namespace fascia::app
