#pragma once

#include "core/cpu/executor.hpp"
#include "core/model/model.hpp"

#include <span>
#include <vector>

namespace fascia {

/// The surface loads of a model at a state.
class SurfaceLoads {
 public:
  explicit SurfaceLoads(const Model& model) : model_(model), forces_(model.surfaces.size()) {}

  bool empty() const { return forces_.empty(); }

  /// Adds forces to the degrees of freedom. @return the potential of the closed surfaces [J]
  double add_forces(const State& state, std::span<const double> factors, std::span<double> out);

  /// Adds what the loads are in a tangent at the state of the last call of add_forces(), which must have been `state`:
  /// nothing but the stiffness of enclosed volumes where the tangent leaves out the geometric stiffness.
  void linearize(const State& state, std::span<const double> factors, Linearization& lin) const;

  /// dV of a closed surface by degrees of freedom, at the state of the last call of add_forces().
  std::vector<double> volume_gradient(std::size_t surface, const State& state) const;

  /// What rounding leaves in the forces on a connected part at the last call of add_forces() [N].
  double rounding(int part) const;

  const SurfaceForces& forces(std::size_t surface) const { return forces_[surface]; }

 private:
  const Model& model_;
  std::vector<SurfaceForces> forces_;
};

}  // namespace fascia
