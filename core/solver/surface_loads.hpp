#pragma once

#include "core/executor/executor.hpp"
#include "core/structure/model.hpp"

#include <span>
#include <vector>

namespace fascia {

/// The surface loads of a model at a state.
///
/// Within Newton's method the geometric stiffness of an enclosed volume takes, in the place of p(V), the pressure that
/// the last linearised step led to: that of Newton's method for displacements and pressures together. A step leaves the
/// volume wrong to second order, and a large bulk modulus makes of that a pressure without meaning.
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

  /// Rounding error of the forces on a connected part at the last call of add_forces() [N].
  double rounding(int part) const;

  // Newton's pressures: from the last step's end on, towards what a direction leads to, back to those saved.
  void begin_step();
  void aim(const Linearization& lin, std::span<const double> direction);
  void approach(double step);
  void follow(const std::vector<double>& pressures) { newton_ = pressures; }
  void save() { saved_ = newton_; }
  void restore() { newton_ = saved_; }
  void finish_step() { reached_ = newton_; }
  /// Newton's pressures at the end of the last step [Pa].
  const std::vector<double>& reached() const { return reached_; }
  void begin_afresh(const std::vector<double>& reached) { reached_ = reached; }

  const SurfaceForces& forces(std::size_t surface) const { return forces_[surface]; }

 private:
  const Model& model_;
  std::vector<SurfaceForces> forces_;
  /// At the datum of each surface [Pa]; those without a bulk modulus do not use them. Empty outside of steps.
  std::vector<double> newton_, aimed_, saved_, reached_;
};

}  // namespace fascia
