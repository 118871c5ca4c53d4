#pragma once

#include "assembly/simulation/simulation.hpp"

namespace fascia {

/// Displacements of matter: of its integration points, and of the nodes of its mesh or, of a meshless or rigid body, of
/// the points of its surface. Frames of a grid that lie outside are none.
class MatterDisplacement {
 public:
  /// Of one place. @param volume  of an integration point [m³]; 0 elsewhere
  void add(const Vec3d& u, double volume);
  void add(const SimulatedBody& body, const State& state);
  /// Adds the points of a body's surface that a region holds.
  void add_surface(const SimulatedBody& body, const Region& region, const State& state);

  bool empty() const { return places_ == 0; }
  double largest() const { return largest_; }  ///< [m]
  Vec3d mean() const;  ///< weighted with volume at rest; of what has none that of its places [m]

 private:
  Vec3d weighted_{}, sum_{};
  double largest_ = 0, volume_ = 0;
  std::size_t places_ = 0;
};

/// The least determinant of a blended rotation that frames resolve.
inline constexpr double kResolved = 0.5;

/// Matter that is pressed to less of its volume is flat: what is left of it is rounding's and the tolerance's.
inline constexpr double kFlat = 1e-6;

/// Integration points of a body where its field has left what it can say.
struct FoldedPoints {
  int inverted = 0;    ///< turned inside out: det F ≤ 0
  int flat = 0;        ///< pressed flat, or nearly: 0 < det F < kFlat
  int unresolved = 0;  ///< neighbouring frames are turned against each other by more than a right angle or so
};
FoldedPoints folded_points(const SimulatedBody& body, const State& state);

/// A sentence that says at how many points of a body St Venant-Kirchhoff's law gives way (is_strongly_elliptic());
/// empty where it does at none, or where what a point has by itself is not all: with averaged or selective volumetric
/// strain, nearly incompressible matter (ν above 0.4), and stresses that fade or act.
std::string yielding_sentence(const Simulation& simulation, std::size_t body, const State& state);

/// Averages over what a probe measures: the nodes of its region (of a rigid body the points of its surface there), or
/// the matter of its body or of all bodies.
MatterDisplacement displacement_of_matter(const Simulation& simulation, const ResolvedProbe& probe, const State& state);

}  // namespace fascia
