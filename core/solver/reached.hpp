#pragma once

#include "core/executor/block_executor.hpp"
#include "core/structure/model.hpp"

#include <span>
#include <vector>

namespace fascia {

/// Which parts of ReachedForces are asked for.
struct ReachedParts {
  bool forces = false, energies = false, slots = false;
  bool any() const { return forces || energies || slots; }
};

/// A record of what acts in a model at a state that a run reached: all that probes and reports read of it.
struct ReachedForces {
  /// By degrees of freedom, and of dependent nodes: see MechanicalSystem::gradient(), dependent_forces().
  std::vector<double> gradient, dependent_forces;
  std::vector<Vec3d> tether_forces;  ///< of each tether, on what it holds [N]
  BlockEnergies energies;
  std::vector<double> slot_sums;  ///< see sum_of_groups()
};

/// A step that a run has reached, wherever it was taken. What is asked for is fetched from there.
class ReachedStep {
 public:
  virtual ~ReachedStep() = default;
  virtual InternalEnergy energy() const = 0;
  virtual const State& state() = 0;
  /// Leaves what is not among the parts.
  virtual void read(const ReachedParts& parts, ReachedForces& out) = 0;
};

/// Reads the forces of tethers at a state. @param targets  as CpuExecutor::targets()
void read_tethers(const Model& model, std::span<const double> targets, const State& state, ReachedForces& out);

}  // namespace fascia
