#pragma once

#include "assembly/simulation/simulation.hpp"

/// Looks for what a user of a scene cannot have meant, and warns with line and remedy. The limits are wide: they are
/// crossed by a unit that is missing or wrong, a mesh in millimetres, a key at the wrong place.
namespace fascia::app {

/// All of the following.
void warn_of_the_implausible(Simulation& simulation);

/// Stiffness, density, size and weight of bodies, gravity's sag.
void warn_of_bodies(Simulation& simulation);
/// Loads and motions against the stiffness of what they act on, gravity against the earth's;
/// app/plausible/plausible_actions.cpp.
void warn_of_loads(Simulation& simulation);
/// Springs against what they hold, gaps in other couplings; app/plausible/plausible_couplings.cpp.
void warn_of_couplings(Simulation& simulation);
/// Time steps, durations and damping against loads and vibrations; app/plausible/plausible_times.cpp.
void warn_of_times(Simulation& simulation);
/// Keys that do nothing; app/plausible/plausible_idle.cpp.
void warn_of_no_effect(Simulation& simulation);
/// Bodies that intersect at rest and that nothing couples; app/plausible/overlaps.cpp.
void warn_of_overlaps(Simulation& simulation);

/// What the checks need of a body made of an elastic material.
struct BodyScale {
  Vec3d extent{};                    ///< of its surface at rest, ascending [m]
  double length = 0;                 ///< the longest [m]
  double thickness = 0;              ///< of a shell, sheet or line its own, of a solid its shortest extent [m]
  double area = 0;                   ///< mean section across the length [m²]
  double density = 0;                ///< [kg/m³]
  double softest = 0, stiffest = 0;  ///< Young's moduli [Pa]; 0 where no material is its own
  bool long_term = false;            ///< they are what is left of some in static solves, after stresses have faded
  double wave_speed() const;         ///< of the stiffest material [m/s]; 0 without mass
  double slowest_period() const;     ///< of bending as a cantilever, or along the length [s]
};
BodyScale scale_of(const Simulation& simulation, std::size_t body);

/// A schedule of a scene with the table that it stands in, as "loads[0]".
struct NamedSchedule {
  std::string table;
  const Schedule* schedule;
};
std::vector<NamedSchedule> schedules_of(const Scene& scene);
/// It grows from 0 to 1 within Schedule::over; other profiles have times of their own.
bool grows_over(const Schedule& schedule);
/// The largest absolute value that it takes.
double largest_factor(const Schedule& schedule);

/// Where a body's material has a key: in its own table or the named one. @param use  index of its materials
Place place_of_material(const Scene& scene, const Material& material, const char* key);

}  // namespace fascia::app
