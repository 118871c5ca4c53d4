#include "app/bench/benchmark.hpp"
#include "app/bench/scenes.hpp"

#include <fmt/format.h>

#include <array>

namespace fascia::app {
namespace {

constexpr std::array kSettings{"paper", "default"};

/// How many frames a spacing gives in the beam.
struct Samples {
  int count;
  double spacing;  ///< [mm]
  int seed;
};

constexpr std::array kFrames{Samples{72, 55.234, 1},   Samples{144, 41.443, 1},  Samples{160, 39.519, 1},
                             Samples{288, 30.252, 1},  Samples{500, 24.143, 4},  Samples{520, 23.541, 1},
                             Samples{792, 20.054, 3},  Samples{1214, 16.971, 1}, Samples{2540, 12.722, 1},
                             Samples{3242, 11.573, 1}, Samples{3998, 10.682, 2}, Samples{5350, 9.5303, 3},
                             Samples{6922, 8.5834, 1}};

/// The sampling of so many frames, as TOML.
std::string frames_like(int count) {
  for (const Samples& s : kFrames)
    if (s.count == count) return fmt::format("poisson_disk = \"{} mm\", seed = {}", s.spacing, s.seed);
  return fmt::format("count = {}", count);
}

/// Frames and points scattered as the publication samples its tissues.
BenchmarkCase scattered(const std::string& name, int points, int frames, int neighbours, const std::string& setting) {
  return {fmt::format("{}_{}", name, setting),
          "beam",
          setting,
          points,
          scattered_beam(fmt::format("{} points, {} frames, {} neighbours", points, frames, neighbours),
                         frames_like(frames), fmt::format("count = {}", points), neighbours, setting),
          {},
          {}};
}

/// Grids, at sizes that sampling would take long for.
BenchmarkCase gridded(const std::string& name, const std::array<int, 3>& cells, const std::string& setting) {
  const int points = 24 * cells[0] * cells[1] * cells[2];
  return {fmt::format("{}_{}", name, setting), "grid beam", setting, points, grid_beam(cells, setting), {}, {}};
}

}  // namespace

Benchmark table2() {
  struct Line {
    int frames, points, neighbours;
    std::optional<double> ms;
  };
  const std::array<Line, 12> lines{{{72, 400, 4, 32.65},
                                    {72, 400, 6, 45.42},
                                    {72, 400, 8, 55.15},
                                    {72, 400, 10, 69.56},
                                    {144, 500, 4, 39.18},
                                    {144, 750, 4, {}},
                                    {144, 864, 4, 43.42},
                                    {144, 1470, 4, 114.3},
                                    {144, 2340, 4, 160.53},
                                    {288, 750, 4, 54.49},
                                    {500, 750, 4, 56.64},
                                    {792, 750, 4, 58.5}}};
  Benchmark b{
      "table2",
      "Bosman, Duriez and Cotin 2014, table 2: time steps by frames, points and neighbours",
      "Paper: one thread of a 2.67 GHz processor of 2009; the line of 750 points and 144 frames is printed there "
      "without a time of its own. Coupling: two walls of shells and tissue, 53.22 and 69.12 ms there.",
      10000,
      {}};
  for (const char* setting : kSettings) {
    for (const Line& l : lines) {
      b.cases.push_back(scattered(fmt::format("table2_{}_{}_{}", l.frames, l.points, l.neighbours), l.points, l.frames,
                                  l.neighbours, setting));
      b.cases.back().published_cpu = l.ms;
    }
  }
  b.cases.push_back({"table2_coupling", "coupling", "default", 400, coupled_scene(7, 32, 400), 53.22, {}});
  return b;
}

Benchmark table3() {
  struct Line {
    int points;
    double cpu, gpu;  ///< [ms]
  };
  const std::array<Line, 9> lines{{{360, 34.84, 14.85},
                                   {800, 78.42, 15.25},
                                   {2600, 251.77, 17.11},
                                   {6070, 595.77, 23.39},
                                   {12700, 1228.8, 32.29},
                                   {16210, 1561.8, 39.29},
                                   {19990, 1990.06, 43.12},
                                   {26750, 2675.47, 53.09},
                                   {34610, 3468.54, 66.1}}};
  constexpr int kPointsPerFrame = 5;  // of table 2's beams; table 3 does not say
  Benchmark b{"table3",
              "Bosman, Duriez and Cotin 2014, table 3: time steps by points, 4 neighbours, 60 CG iterations",
              "Paper: one thread of a 2.67 GHz processor of 2009, and a GTX 570. It does not say how many frames: here "
              "one for five points. From 100,000 points on: grid frames, with 24 points a cell.",
              20000,
              {}};
  for (const char* setting : kSettings) {
    for (const Line& l : lines) {
      b.cases.push_back(
          scattered(fmt::format("table3_{}", l.points), l.points, l.points / kPointsPerFrame, 4, setting));
      b.cases.back().published_cpu = l.cpu;
      b.cases.back().published_gpu = l.gpu;
    }
    b.cases.push_back(gridded("table3_1e5", {38, 10, 11}, setting));
    b.cases.push_back(gridded("table3_1e6", {79, 24, 22}, setting));
    b.cases.push_back(gridded("table3_1e7", {193, 48, 45}, setting));
  }
  return b;
}

}  // namespace fascia::app
