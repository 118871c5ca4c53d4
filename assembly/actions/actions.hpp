#pragma once

#include "assembly/simulation/simulation.hpp"

/// Constraints, drivers, loads, couplings and probes of a simulation: parts of build_simulation().
namespace fascia {

class MechanicalSystem;

void add_constraints(Simulation& simulation, PointSetBuilder& points);  ///< constraints.cpp
void add_loads(Simulation& simulation);                                 ///< loads.cpp
/// Welds, embeddings and springs; couplings.cpp.
/// @throws SceneError  a node that depends on two others, is held, or closes a circle; a point outside its host
void add_couplings(Simulation& simulation, PointSetBuilder& points);
/// Pressure on faces, dead or following; surface_loads.cpp.
/// @throws SceneError  no face selected
void add_pressure(Simulation& simulation, int body, const Load& load, int schedule);
void add_fluids(Simulation& simulation);  ///< surface_loads.cpp
/// Checks that every body of a static solve is held, by supports or through couplings; support.cpp.
/// @throws SceneError  what is free, with the motion
void check_support(const Simulation& simulation);
void resolve_probes(Simulation& simulation);      ///< probe_setup.cpp
void resolve_controlled(Simulation& simulation);  ///< probe_setup.cpp
/// Adds the loads of solver.imperfection: those that displace the model at rest by its lowest natural mode, whose
/// largest displacement is that part of the largest body. They grow with the load factor, as what an imperfect shape
/// does under the other loads; torques on frames are left out, so that all stays conservative.
/// @throws SceneError  nothing can buckle
void add_imperfection(Simulation& simulation);

/// Puts the largest time step of central differences that is stable at the start [s] into Simulation::stable_step. An
/// automatic step begins with it, and the steps are then those that the duration would take if it stayed.
/// @throws SceneError  where time_step is larger
void settle_time_step(Simulation& simulation, MechanicalSystem& system);

}  // namespace fascia
