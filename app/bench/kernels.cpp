#include "app/bench/kernel_report.hpp"
#include "app/bench/kernel_runs.hpp"
#include "app/bench/scenes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace fascia::app {
namespace {

int whole(double number) { return std::max(1, static_cast<int>(std::lround(number))); }

/// Cells of a long block: `along` × across × across, with so many points in each.
/// @param slenderness  along by across
std::array<int, 3> cells_of(int points, int in_cell, double slenderness) {
  const double cells = static_cast<double>(points) / in_cell;
  const int across = whole(std::cbrt(cells / slenderness));
  return {whole(cells / across / across), across, across};
}

/// A scattered beam: the spacing of frames goes with the cube root of the number that a known one gives.
std::string scattered(int points, int neighbours) {
  constexpr double kFrames = 6922, kSpacing = 8.5834;  // [mm]
  const double frames = points / 5.0;
  return scattered_beam(fmt::format("{} points, {} neighbours", points, neighbours),
                        fmt::format("poisson_disk = \"{:.6g} mm\"", kSpacing * std::cbrt(kFrames / frames)),
                        fmt::format("count = {}", points), neighbours, "paper");
}

BenchReport run_kernels(const Benchmark& benchmark, const BenchOptions& options, const Teller& say) {
  refuse_options_of_steps(benchmark, options);
  KernelResult result{benchmark.name, benchmark.title, benchmark.notes, {}, {}, load_of_machine()};
  std::vector<int> threads{1};
  if (const int all = ThreadPool(options.threads).size(); all > 1) threads.push_back(all);
  result.notes = shared_processors(threads.back()) + result.notes;
  const std::vector<BenchmarkCase> cases = chosen_cases(benchmark, options, result.skipped);
  const Teams teams = make_teams(threads, options.repeat, say);
  for (const BenchmarkCase& c : cases) {
    say(fmt::format("{}: building", c.name));
    std::string reason;
    if (const std::optional<Simulation> simulation = built(c, reason))
      std::ranges::move(time_kernels(c, *simulation, teams, options.repeat, say), std::back_inserter(result.rows));
    else
      result.skipped.push_back({c.name, reason});
  }
  return report_of_kernels(result, teams, cases);
}

}  // namespace

BenchmarkCase body_case(const std::string& prefix, KernelBody body, int points) {
  const auto named = [&](const char* name, const char* text, const char* setting, std::string scene) {
    return BenchmarkCase{
        fmt::format("{}_{}_{}", prefix, name, points), text, setting, points, std::move(scene), {}, {}};
  };
  switch (body) {
    case KernelBody::grid:
      return named("grid", "grid of frames", "paper", grid_beam(cells_of(points, 24, 4), "paper"));
    case KernelBody::scattered4:
      return named("scattered4", "scattered 4", "paper", scattered(points, 4));
    case KernelBody::scattered8:
      return named("scattered8", "scattered 8", "paper", scattered(points, 8));
    case KernelBody::tetrahedra: {
      const auto [z, y, x] = cells_of(points, 5, 2);
      return named("tetrahedra", "tetrahedra", "default", tetrahedra_scene(x, y, z));
    }
    case KernelBody::hexahedra: {
      const auto [z, y, x] = cells_of(points, 8, 2);
      return named("hexahedra", "hexahedra", "default", hexahedra_scene(x, y, z));
    }
    case KernelBody::shells:
      break;
  }
  const int across = whole(std::sqrt(points / 3.2));
  return named("shells", "shells", "default", shell_scene(across, whole(points / 2.0 / across)));
}

Benchmark kernels() {
  Benchmark b{"kernels",
              "Kernels of the processor: times, rates, and how near they come to the machine's limits",
              "Times are medians; low..high: where four of five calls lie. GB/s: what must be read and written once. "
              "Limit: the larger of the times that this takes at the rates below, in the cache that holds it, "
              "and that the operations take, where they are counted. Error: from another way to the same numbers. "
              "Sizes count integration points, triangles of shells.",
              100000,
              {},
              100000,
              run_kernels};
  for (const KernelBody body : {KernelBody::grid, KernelBody::scattered4, KernelBody::scattered8,
                                KernelBody::tetrahedra, KernelBody::hexahedra, KernelBody::shells})
    for (const int points : {1000, 10000, 100000, 1000000, 10000000}) {
      const bool sampled = body == KernelBody::scattered4 || body == KernelBody::scattered8;
      if (sampled && points > 1000000) continue;  // sampling would take long
      b.cases.push_back(body_case("kernels", body, points));
    }
  return b;
}

}  // namespace fascia::app
