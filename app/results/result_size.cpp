#include "app/results/result_size.hpp"

#include "app/results/probes.hpp"
#include "app/results/provenance.hpp"
#include "app/results/results.hpp"
#include "app/results/run_text.hpp"
#include "app/results/tell_warnings.hpp"
#include "app/run/messages.hpp"
#include "core/base/index.hpp"
#include "core/math/rotation.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

constexpr double kLarge = 1e9;       // [bytes]
constexpr double kNumberInCsv = 19;  // bytes of a number with 17 digits

struct Counts {
  double states = 1, rows = 1;
  bool at_most = false;
};

/// Counts as many states as SaveRule of fascia/run saves.
Counts counts_of(const Scene& scene) {
  const Solver& solver = scene.solver;
  if (solver.kind == SolverKind::modes) return {1.0 * solver.modes, 1.0 * solver.modes};
  const auto by_steps = [&](double steps) {
    return scene.output.every_steps > 0 ? std::ceil(steps / scene.output.every_steps) : 1.0;
  };
  if (solver.kind == SolverKind::statics) {
    const bool path = solver.control != StaticControl::load;
    const double steps = path ? solver.max_steps : std::max(1, solver.load_steps);
    return {by_steps(steps), steps, path && scene.output.every_steps > 0};
  }
  const double every = saving_time(scene.output), steps = solver.steps;
  const double duration = solver.duration.value_or(steps * solver.time_step);
  const double saved = every > 0 ? std::min(steps, std::ceil(duration / every * (1 - 1e-9))) : by_steps(steps);
  return {1 + saved, 1 + saved};
}

/// A state with numbers in all digits, as those of a run have: every node is displaced and turned a little, smoothly.
State bent_state(const Simulation& s) {
  constexpr double kSmall = 1e-3;  // of a body's size, and of a turn
  State state = s.initial;
  for (const SimulatedBody& b : s.bodies) {
    const double size = std::max(b.body->size(), 1e-300);
    for (std::size_t i = 0; i < b.nodes.size(); ++i) {
      const std::size_t node = at(b.node_ids[i]);
      const Vec3d X = b.nodes[i] * (1 / size);
      const Vec3d wave{{std::sin(1 + 1.7 * X[0] + 2.3 * X[1] + 1.3 * X[2]),
                        std::sin(2 + 2.1 * X[0] + 1.1 * X[1] + 1.9 * X[2]),
                        std::sin(3 + 1.3 * X[0] + 1.9 * X[1] + 2.9 * X[2])}};
      state.u[node] = wave * (kSmall * size);
      if (s.model.kind(b.node_ids[i]) != FrameKind::vertex) state.D[node] = rotation_increment(wave * kSmall);
    }
  }
  return state;
}

std::string bytes_text(double bytes) {
  const char* units[] = {"bytes", "kB", "MB", "GB", "TB"};
  int unit = 0;
  for (; unit < 4 && bytes >= 999.5; ++unit) bytes /= 1000;
  return fmt::format("{:.3g} {}", bytes, units[unit]);
}

}  // namespace

std::string ResultSize::text() const {
  return fmt::format("{} {}: {:.0f} state{} of {}{}", at_most ? "at most" : "about", bytes_text(bytes()), states,
                     states == 1 ? "" : "s", bytes_text(state_bytes),
                     probes_bytes > 0.1 * bytes() ? ", and probes.csv" : "");
}

ResultSize forecast_result(const Simulation& s) {
  const Counts counts = counts_of(s.scene);
  double columns = 1;
  for (const ResolvedProbe& p : s.probes) columns += static_cast<double>(probe_columns(p).size());
  ResultFiles files(s, {}, "", json_text(provenance_of(s)));
  return {counts.states, counts.at_most, files.estimated_size(bent_state(s)), counts.rows * columns * kNumberInCsv};
}

bool may_be_large(const Simulation& s) {
  constexpr double kMostOfPlace = 8 * 90;  // bytes of all fields of a node, point or cell, and of its numbers
  double places = 0, columns = 1;
  for (const SimulatedBody& b : s.bodies)
    places += static_cast<double>(b.nodes.size() + b.body->surface().points.size() + b.body->points().size() +
                                  b.body->surface().triangles.size() + b.body->cells().nodes.size());
  for (const ResolvedProbe& p : s.probes) columns += 9 * std::max<double>(1, static_cast<double>(p.points.size()));
  const Counts counts = counts_of(s.scene);
  return counts.states * places * kMostOfPlace + counts.rows * columns * kNumberInCsv > kLarge;
}

void warn_of_size(Simulation& s, const ResultSize& size) {
  if (size.bytes() < kLarge) return;
  const bool modes = s.scene.solver.kind == SolverKind::modes;
  const bool by_time = is_dynamic(s.scene.solver.kind) && s.scene.output.every_steps == 0;
  const std::string fewer =
      size.states <= 1 ? ""
      : modes          ? "solver.modes asks for fewer of them, "
                       : fmt::format("a larger output.{} saves fewer states, ", by_time ? "every" : "every_steps");
  const std::string text = fmt::format("the results take {}; {}output.fields leaves fields out", size.text(), fewer);
  s.warnings.add("output", s.scene.place_of("output"), text);
  tell(s.warnings, s.scene.path);
}

}  // namespace fascia::app
