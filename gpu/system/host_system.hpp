#pragma once

#include "core/solver/mechanical_system.hpp"

namespace fascia::gpu {

/// A system of the host beside one of a space, with threads of its own.
struct HostSystem {
  ThreadPool pool;
  MechanicalSystem system;
  HostSystem(const Model& model, const SolverSettings& settings)
      : pool(settings.threads), system(model, pool, settings) {}
};

}  // namespace fascia::gpu
