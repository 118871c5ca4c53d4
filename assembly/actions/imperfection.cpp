#include "assembly/actions/actions.hpp"
#include "assembly/simulation/simulation.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "assembly/specification/errors.hpp"
#include "core/base/index.hpp"
#include "core/run/modes.hpp"
#include "core/solver/mechanical_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia {

namespace {

/// Forces that displace the model at rest by a motion, on what is free.
std::vector<double> forces_of(const Simulation& s, ThreadPool& pool, const std::vector<double>& motion) {
  MechanicalSystem system(s.model, pool, settings_of(s.scene.solver));
  system.begin_step(State::at_rest(s.model), 0);
  system.evaluate();
  std::vector<double> force = system.product(motion);
  system.filter().to_local(force);
  system.filter().clear_fixed(force);
  system.filter().to_global(force);
  return force;
}

}  // namespace

void add_imperfection(Simulation& s) {
  const Solver& solver = s.scene.solver;
  if (solver.imperfection == 0) return;
  const Place place = solver.imperfection_place;
  if (s.model.free_dof_count() == 0)
    throw SceneError({{place, "no body can buckle: nothing in the scene is free to move; leave it out"}});
  ThreadPool pool(solver.threads);
  const Modes modes = natural_modes(s.model, pool, 1);
  if (!modes.converged || modes.frequency.empty() || !(modes.frequency[0] > 0))
    throw SceneError({{place,
                       "the lowest mode at rest is a free motion or was not found: nothing bends that way; hold "
                       "the body, or leave it out"}});
  std::vector<double> motion = modes.shape[0];
  double size = 0, largest = 0;
  for (const SimulatedBody& b : s.bodies) size = std::max(size, b.body->size());
  const DofLayout& dofs = s.model.points.dofs;
  for (int node = 0; node < s.model.node_count(); ++node) {
    const double* d = motion.data() + dofs.begin(node);
    largest = std::max(largest, std::hypot(d[0], d[1], d[2]));
  }
  for (double& d : motion) d *= solver.imperfection * size / std::max(largest, 1e-300);
  const std::vector<double> force = forces_of(s, pool, motion);
  DeadLoad load;
  load.schedule = new_schedule(s, {}, place);
  for (int node = 0; node < s.model.node_count(); ++node) {
    const double* f = force.data() + dofs.begin(node);
    load.nodes.push_back({node, {{f[0], f[1], f[2]}}, {}, {}});
  }
  s.model.loads.push_back(std::move(load));
}

}  // namespace fascia
