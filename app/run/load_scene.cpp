#include "app/run/load_scene.hpp"

#include "app/plausible/plausible.hpp"
#include "app/reader/parse.hpp"
#include "app/results/tell_warnings.hpp"
#include "app/run/memory.hpp"
#include "app/run/sample_cache.hpp"
#include "assembly/build/build_simulation.hpp"
#include "fascia/choose_backend.hpp"
#include "fascia/run/run_simulation.hpp"

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

Simulation build_within_memory(Scene scene) {
  check_memory(scene);
  const SampleCache cache(scene.output);
  const bool kept = scene.output.keeps_samples;
  return build_simulation(std::move(scene), kept ? &cache : nullptr);
}

Simulation load_scene(Scene scene) {
  Simulation s = build_within_memory(std::move(scene));
  make_ready(s);
  warn_of_the_implausible(s);
  tell(s.warnings, s.scene.path);
  return s;
}

void warn_of_backend(Simulation& s, Backend backend) {
  const std::string lost = not_as_asked(s, backend);
  if (lost.empty()) return;
  s.warnings.add("backend", lost);
  tell(s.warnings, s.scene.path);
}

}  // namespace fascia::app
