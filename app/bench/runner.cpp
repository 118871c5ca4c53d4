#include "app/bench/benchmark.hpp"
#include "app/reader/parse.hpp"
#include "app/run/load_scene.hpp"
#include "app/run/memory.hpp"
#include "app/run/process_memory.hpp"
#include "assembly/specification/errors.hpp"
#include "core/base/errors.hpp"
#include "gpu/space/device.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>

namespace fascia::app {
namespace {

/// Part of the free memory that a case may take.
constexpr double kMemoryShare = 0.8;

double percentile(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(std::ceil(part * static_cast<double>(values.size() - 1)))];
}

/// Its integration points are none of elements or triangles.
bool has_points_alone(const SimulatedBody& b) { return b.body->blocks.groups.count > 0; }

/// What a measurement says of the model. Points are those of meshless bodies, or of elements where there are none;
/// neighbours are those of a few hundred points of each body.
Measurement describe(const BenchmarkCase& c, const Simulation& s) {
  Measurement m;
  m.name = c.name;
  m.body = c.body;
  m.setting = c.setting;
  m.published_cpu = c.published_cpu;
  m.published_gpu = c.published_gpu;
  m.frames = s.model.node_count();
  m.dofs = s.model.free_dof_count();
  double moved = 0, looked_at = 0;
  const bool meshless = std::any_of(s.bodies.begin(), s.bodies.end(), has_points_alone);
  for (const SimulatedBody& b : s.bodies) {
    if (meshless && !has_points_alone(b)) continue;
    const std::size_t count = b.body->points().size(), stride = 1 + count / 500;
    m.points += static_cast<int>(count);
    for (std::size_t q = 0; q < count; q += stride, ++looked_at) {
      const std::vector<Influence> influences = b.body->attach_point(q).influences;
      moved += static_cast<double>(std::count_if(influences.begin(), influences.end(),
                                                 [](const Influence& i) { return i.w != 0 || squared_norm(i.g) > 0; }));
    }
  }
  if (looked_at > 0) m.neighbours = moved / looked_at;
  return m;
}

Measurement measured(Measurement m, const BenchBackend& backend, const StepTimes& t) {
  m.backend = backend.name;
  m.threads = backend.threads;
  m.gpus = backend.gpus;
  m.steps = static_cast<int>(t.step_ms.size());
  m.step_ms = percentile(t.step_ms, 0.5);
  m.step_p99_ms = percentile(t.step_ms, 0.99);
  m.step_max_ms = percentile(t.step_ms, 1);
  m.cg_ms = percentile(t.cg_ms, 0.5);
  m.cg_iterations = t.cg_iterations;
  m.residual = t.residual;
  m.trouble = t.trouble;
  return m;
}

}  // namespace

std::optional<Simulation> built(const BenchmarkCase& c, std::string& reason) {
  Scene scene = parse_scene_text(c.scene, c.name + ".toml", {});
  const double need = estimated_memory(scene), have = free_memory().bytes;
  if (need > kMemoryShare * have) {
    reason = fmt::format("it needs about {:.3g} GB of memory and {:.3g} GB are free", need / 1e9, have / 1e9);
    return std::nullopt;
  }
  try {
    return build_within_memory(std::move(scene));
  } catch (const SceneError& e) {
    reason = e.diagnostics().front().message;
  } catch (const std::bad_alloc&) {
    reason = "it does not fit into memory";
  }
  return std::nullopt;
}

std::vector<BenchmarkCase> chosen_cases(const Benchmark& benchmark, const BenchOptions& options,
                                        std::vector<SkippedCase>& skipped) {
  const auto asked_for = [&](const BenchmarkCase& c) {
    return std::find(options.sizes.begin(), options.sizes.end(), c.size) != options.sizes.end();
  };
  for (const double size : options.sizes) {
    std::string known;
    for (const BenchmarkCase& c : benchmark.cases) {
      if (size == c.size) known = "";
      if (size == c.size) break;
      const std::string text = fmt::format("{}", c.size);
      if (fmt::format(", {},", known).find(fmt::format(", {},", text)) == std::string::npos)
        known += (known.empty() ? "" : ", ") + text;
    }
    if (!known.empty())
      throw InputError(fmt::format("--sizes: {} is no size of {}; must be of {}", size, benchmark.name, known));
  }
  std::vector<BenchmarkCase> chosen;
  const double limit = options.max_points.value_or(options.sizes.empty() ? benchmark.default_size : HUGE_VAL);
  for (const BenchmarkCase& c : benchmark.cases) {
    if (options.settings != "both" && options.settings != c.setting) continue;
    if (!options.sizes.empty() && !asked_for(c)) continue;
    if (options.sizes.empty() && !options.max_points && c.size < benchmark.smallest_default) continue;
    if (c.size > limit)
      skipped.push_back({c.name, fmt::format("larger than {:.6g} (--max-points)", limit)});
    else
      chosen.push_back(c);
  }
  return chosen;
}

BenchmarkResult time_benchmark(const Benchmark& benchmark, const BenchOptions& options,
                               const std::vector<BenchBackend>& backends, const Teller& say) {
  BenchmarkResult result{benchmark.name, benchmark.title, benchmark.notes, {}, {}};
  StepPlan plan;
  if (options.repeat > 0) plan.fewest = plan.most = options.repeat;
  for (const BenchmarkCase& c : chosen_cases(benchmark, options, result.skipped)) {
    say(fmt::format("{}: building", c.name));
    std::string reason;
    const std::optional<Simulation> simulation = built(c, reason);
    if (!simulation) {
      result.skipped.push_back({c.name, reason});
      continue;
    }
    const Measurement description = describe(c, *simulation);
    for (const BenchBackend& backend : backends) {
      say(fmt::format("{}: {}", c.name, backend.label()));
      try {
        result.rows.push_back(measured(description, backend, backend.run(*simulation, plan)));
      } catch (const gpu::NotShared& e) {
        result.skipped.push_back({fmt::format("{} ({})", c.name, backend.label()), e.what()});
      } catch (const gpu::DeviceMemoryError& e) {
        result.skipped.push_back({fmt::format("{} ({})", c.name, backend.label()), e.what()});
      }
    }
  }
  return result;
}

}  // namespace fascia::app
