#pragma once

#include "core/solver/mechanical_system.hpp"

namespace fascia::gpu {

/// A system of the host beside one of a space, with threads of its own.
struct HostSystem {
  ThreadPool pool{0};
  MechanicalSystem system;
  HostSystem(const Model& model, const SolverSettings& settings) : system(model, pool, settings) {}
};

}  // namespace fascia::gpu
