#pragma once

#include "core/node/node_drift.hpp"

#include <array>
#include <vector>

namespace fascia {

/// Constants of a model's nodes that steps of central differences need, found once.
struct ExplicitNodes {
  std::vector<SpinInertia> turning;  ///< of free rigid frames
  std::vector<Vec3d> center;         ///< c / m of free rigid frames [m]
  std::vector<double> damping;       ///< α [1/s]
  /// Mass damping of hosts beyond α times their inertia: what they carry may be damped otherwise. Empty: none.
  std::vector<FrameInertia> uneven_damping;
  std::vector<std::array<double, 16>> inverse_mass;  ///< of free affine frames: (origin, axes)²
  std::vector<int> affine;                           ///< index into it
  std::vector<char> follows;                         ///< nodes all of which depends on others; empty: none
  double rounding_energy = 0;                        ///< that rounding of displacements may show [J]

  /// @param dt  about which steps are long [s]
  ExplicitNodes(const Model& model, double dt);
  bool skips(int node) const { return !follows.empty() && follows[at(node)] != 0; }

 private:
  void find_uneven_damping(const Model& model);
};

}  // namespace fascia
