#include "app/tune/tune_scenes.hpp"

#include "core/physics/law_constants.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace fascia::app {
namespace {

struct Sizes {
  const char* kind;
  int small, large;  ///< cells across: some 700 and 4,000 unknowns; scattered frames, which cost more, 250 and 700
};
constexpr std::array<Sizes, 8> kSizes{{{"frames", 3, 6},
                                       {"scattered", 2, 3},
                                       {"affine", 2, 4},
                                       {"hexahedra", 4, 8},
                                       {"hexahedra-2", 2, 4},
                                       {"tetrahedra", 4, 8},
                                       {"tetrahedra-2", 2, 4},
                                       {"shell", 8, 16}}};

constexpr double kYoung = 200e3, kPoisson = 0.3, kDensity = 1000, kStep = 0.01;

std::string body_of(const TuneCase& c) {
  const int n = c.size;
  if (c.kind == "shell")
    return fmt::format(
        "model = \"shell\"\nthickness = 0.05\ndomain = {{ rectangle = {{ origin = [0, 0, 0], edge_u = [2, 0, 0], "
        "edge_v = [0, 1, 0], cells = [{}, {}] }} }}\n",
        2 * n, n);
  const bool frames = c.kind == "frames" || c.kind == "affine";
  const std::string box = "min = [0, 0, 0], max = [2, 1, 1]";
  if (frames)
    return fmt::format(
        "model = \"meshless\"\ndomain = {{ box = {{ {} }} }}\nframes = {{ grid = [{}, {}, {}], kind = "
        "\"{}\" }}\n",
        box, 2 * n + 1, n + 1, n + 1, c.kind == "affine" ? "affine" : "rigid");
  if (c.kind == "scattered")
    return fmt::format("model = \"meshless\"\ndomain = {{ box = {{ {} }} }}\nframes = {{ poisson_disk = {} }}\n", box,
                       1.0 / c.size);
  const bool quadratic = c.kind.ends_with("-2");
  return fmt::format("model = \"{}\"\norder = {}\ndomain = {{ box = {{ {}, cells = [{}, {}, {}] }} }}\n",
                     c.kind.substr(0, c.kind.find('-')), quadratic ? 2 : 1, box, 2 * n, n, n);
}

double wave_speed() {
  const Lame lame = Lame::from_young(kYoung, kPoisson);
  return std::sqrt((lame.lambda + 2 * lame.mu) / kDensity);
}

/// Mean distance of the nearest node; of Poisson-disk samples less than their spacing.
double spacing_of(const TuneCase& c) {
  constexpr double kNearest = 0.885;
  return (c.kind == "scattered" ? kNearest : 1.0) / (c.kind.ends_with("-2") ? 2 * c.size : c.size);
}

std::string solver_of(const TuneCase& c) {
  // Of scattered frames a stable step lasts a 160th of the time that a wave takes from node to node, of others a tenth.
  if (c.explicit_steps)
    return fmt::format("kind = \"explicit\"\ntime_step = {}\nsteps = 300\n", spacing_of(c) / wave_speed() / 500);
  return (c.dynamics ? fmt::format("kind = \"newmark\"\ntime_step = {}\nsteps = 10\n", kStep)
                     : fmt::format("kind = \"static\"\nload_steps = {}\n", c.kind == "scattered" ? 1 : 3)) +
         fmt::format("linear = {{ kind = \"{}\", preconditioner = \"{}\" }}\n",
                     c.factorised && !c.dynamics ? "cholesky" : "cg", c.factorised && c.dynamics ? "cholesky" : "auto");
}

}  // namespace

std::vector<TuneCase> tune_cases(bool quick, int threads) {
  std::vector<TuneCase> cases;
  for (const Sizes& s : kSizes)
    for (const int size : {s.small, s.large})
      for (const bool factorised : {true, false}) cases.push_back({s.kind, size, factorised});
  for (const Sizes& s : kSizes) cases.push_back({s.kind, s.large, false, false, 1, true});
  if (quick) return cases;
  for (const Sizes& s : kSizes) cases.push_back({s.kind, s.small, true, true});
  for (const Sizes& s : kSizes) cases.push_back({s.kind, s.small, false, true});
  for (const Sizes& s : kSizes)
    for (const bool factorised : {true, false})
      if (threads > 1) cases.push_back({s.kind, s.large, factorised, false, threads});
  for (const Sizes& s : kSizes) cases.push_back({s.kind, s.large, false, true});
  return cases;
}

std::string tune_scene(const TuneCase& c) {
  return fmt::format(
      "[world]\ngravity = [0, 0, -1]\n\n[bodies.body]\n{}density = {}\nmaterial = {{ young = {}, poisson = {} "
      "}}\n\n[[constraints]]\nbody = \"body\"\nwhere = {{ box = {{ min = [-1e-6, -1, -1], max = [1e-6, 2, 2] }} "
      "}}\nfix = \"all\"\n\n[solver]\n{}\n[output]\nfields = [\"displacement\"]\ncache = false\n",
      body_of(c), kDensity, kYoung, kPoisson, solver_of(c));
}

double courant_of(const TuneCase& c) { return c.dynamics ? wave_speed() * kStep / spacing_of(c) : 0; }

}  // namespace fascia::app
