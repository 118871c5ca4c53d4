#pragma once

#include "assembly/simulation/simulation.hpp"
#include "core/solver/mechanical_system.hpp"

#include <string>

namespace fascia {

/// The cell or integration point that limits the time step of central differences at the start: the one with most of
/// the energy of the fastest motion.
struct StepLimit {
  int body = -1;          ///< −1: nothing is stiff
  std::size_t point = 0;  ///< integration point of the body
  double share = 0;       ///< its part of that energy; 0: none of it strains points (springs, a fluid, stabilisation)
  double length = 0;      ///< over which its weights fall [m]
  double speed = 0;       ///< of pressure waves, √((λ + 2μ)/ρ) [m/s]
  std::string text;       ///< all of this in words, with what differs from the rest of the model
};

/// @throws InputError  where a node has no inertia
StepLimit step_limit(const Simulation& simulation, MechanicalSystem& system);

}  // namespace fascia
