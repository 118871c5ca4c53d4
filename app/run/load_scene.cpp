#include "app/run/load_scene.hpp"

#include "app/plausible/plausible.hpp"
#include "app/reader/parse.hpp"
#include "app/run/backend.hpp"
#include "app/run/solver_settings.hpp"
#include "core/solver/mechanical_system.hpp"

#include <fmt/format.h>

namespace fascia::app {

Scene read_scene(const RunOptions& options) {
  std::vector<std::string> overrides = options.overrides;
  if (options.backend) overrides.push_back("solver.backend=" + *options.backend);
  if (options.threads) overrides.push_back(fmt::format("solver.threads={}", *options.threads));
  if (options.gpus) overrides.push_back(fmt::format("solver.gpus={}", *options.gpus));
  Scene scene = options.text ? parse_scene_text(*options.text, options.scene, overrides)
                             : parse_scene_file(options.scene, overrides);
  if (options.estimate && !scene.output.estimate) scene.output.estimate = EstimateBy::automatic;
  if (options.no_estimate) scene.output.estimate.reset();
  if (options.output) scene.output.directory = *options.output;
  return scene;
}

Simulation load_scene(const RunOptions& options) { return load_scene(read_scene(options)); }

Simulation load_scene(Scene scene) {
  Simulation s = build_simulation(std::move(scene));
  add_imperfection(s);
  if (s.scene.solver.kind == SolverKind::central_differences) {
    ThreadPool pool(s.scene.solver.threads);
    MechanicalSystem system(s.model, pool, settings_of(s.scene.solver));
    settle_time_step(s, system);
  }
  warn_of_the_implausible(s);
  s.warnings.tell(s.scene.path);
  return s;
}

void warn_of_backend(Simulation& s, Backend backend) {
  const std::string lost = not_as_asked(s, backend);
  if (lost.empty()) return;
  s.warnings.add("backend", lost);
  s.warnings.tell(s.scene.path);
}

}  // namespace fascia::app
