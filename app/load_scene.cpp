#include "app/load_scene.hpp"

#include "app/backend.hpp"
#include "app/messages.hpp"
#include "app/scene/parse.hpp"
#include "app/solver_settings.hpp"
#include "core/solver/mechanical_system.hpp"

namespace fascia::app {

Simulation load_scene(const RunOptions& options) {
  std::vector<std::string> overrides = options.overrides;
  if (options.backend) overrides.push_back("solver.backend=" + *options.backend);
  if (options.threads) overrides.push_back(fmt::format("solver.threads={}", *options.threads));
  if (options.gpus) overrides.push_back(fmt::format("solver.gpus={}", *options.gpus));
  Scene scene = parse_scene_file(options.scene, overrides);
  if (options.output) scene.output.directory = *options.output;
  Simulation s = build_simulation(std::move(scene));
  add_imperfection(s);
  if (s.scene.solver.kind == SolverKind::central_differences) {
    ThreadPool pool(s.scene.solver.threads);
    MechanicalSystem system(s.model, pool, settings_of(s.scene.solver));
    settle_time_step(s, system);
  }
  for (const std::string& w : s.warnings) say("{}: warning: {}\n", options.scene.string(), w);
  return s;
}

void warn_of_backend(Simulation& s, Backend backend) {
  const std::string lost = not_as_asked(s, backend);
  if (lost.empty()) return;
  say("{}: warning: {}\n", s.scene.path.string(), lost);
  s.warnings.push_back(lost);
}

}  // namespace fascia::app
