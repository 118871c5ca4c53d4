#include "app/reader/parse.hpp"
#include "app/results/coupling_report.hpp"
#include "assembly/build/build_simulation.hpp"
#include "assembly/simulation/simulation.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "gpu/run/run.hpp"
#include "gpu/space/device.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

/// Forces at supports and in couplings after steps of the device, against those after the processor's: in the space of
/// the host always, on the device where there is one.
namespace fascia::test::device_forces_test {
namespace {

enum class Where { host, device };

/// Hexahedra, tissue that shares their vertices, tetrahedra that follow the tissue, a shell on these, and scattered
/// frames whose ends are held by tethers; pulled and turned, with both kinds of damping or stresses that fade, from a
/// motion that stretches them at once.
constexpr const char* kScene = R"(
[materials]
soft = { young = 1e4, poisson = 0.3, damping = { stiffness = "20 ms", mass = "5 Hz" } }
slack = { young = 1e4, poisson = 0.3, viscosity = [{ share = 0.3, time = "20 ms" }, { share = 0.3, time = 1 }] }
[bodies.organ]
model = "hexahedra"
domain = { box = { min = [0, 0, 0], max = [0.5, 0.5, 0.5], cells = [2, 2, 2] } }
density = 100
material = "soft"
initial = { velocity = [0.3, 0, 0.1] }
[bodies.tissue]
model = "meshless"
domain = { box = { min = [0.5, 0, 0], max = [1, 0.5, 0.5] } }
frames = { grid = [3, 3, 3], share = [{ body = "organ", where = { box = { min = [0.499, -1, -1], max = [0.501, 1, 1] } } }] }
density = 100
material = "soft"
[bodies.cap]
model = "tetrahedra"
domain = { box = { min = [1, 0, 0], max = [1.5, 0.5, 0.5], cells = [2, 2, 2] } }
density = 100
material = "slack"
[bodies.skin]
model = "shell"
domain = { rectangle = { origin = [1, 0, 0.5], edge_u = [0.5, 0, 0], edge_v = [0, 0.5, 0], cells = [2, 2] } }
thickness = 0.02
density = 100
material = "slack"
[bodies.cloud]
model = "meshless"
domain = { box = { min = [0, 1, 0], max = [1, 1.4, 0.4] } }
frames = { poisson_disk = 0.35 }
density = 100
material = "soft"
[couplings.seam]
kind = "embed"
body = "cap"
where = { box = { min = [0.999, -1, -1], max = [1.001, 2, 2] } }
to = "tissue"
[couplings.ride]
kind = "embed"
body = "skin"
where = "all"
to = "cap"
[[constraints]]
body = "organ"
where = { box = { min = [-0.1, -1, -1], max = [1e-4, 2, 2] } }
fix = "all"
[[constraints]]
body = "cap"
where = { box = { min = [1.4999, -1, -1], max = [1.6, 2, 2] } }
move = { translate = [0.1, 0.02, 0] }
over = "0.2 s"
[[constraints]]
body = "cloud"
where = { box = { min = [-0.1, -1, -1], max = [1e-4, 2, 2] } }
move = { translate = [-0.05, 0, 0], rotate = { axis = [1, 0, 0], angle = "10 deg", center = [0, 1.2, 0.2] } }
over = "0.2 s"
)";

Simulation load() {
  const auto path = std::filesystem::temp_directory_path() / ("device_forces_" + std::to_string(getpid()) + ".toml");
  std::ofstream(path) << kScene << "[solver]\nkind = \"implicit-euler\"\ntime_step = 0.01\nduration = 0.2\n";
  Scene scene = app::parse_scene_file(path, {});
  std::filesystem::remove(path);
  return build_simulation(std::move(scene));
}

/// What acts after a step, as numbers.
struct Forces {
  std::vector<double> gradient, couplings, tethers, blocks;
  InternalEnergy energy;
};

void append(const nlohmann::ordered_json& value, std::vector<double>& out) {
  if (value.is_number_float()) return out.push_back(value.get<double>());
  if (!value.is_structured()) return;
  for (const auto& entry : value) append(entry, out);
}

Forces forces_at(const Simulation& s, ReachedStep& reached) {
  ReachedForces acting;
  reached.read({true, true, true}, acting);
  Forces f{acting.gradient, {}, {}, {}, reached.energy()};
  for (const auto& [name, report] : app::coupling_report(s, acting, reached.state())) append(report, f.couplings);
  for (const Vec3d& pull : acting.tether_forces) f.tethers.insert(f.tethers.end(), pull.v, pull.v + 3);
  const BlockEnergies& e = acting.energies;
  for (const auto* of : {&e.groups, &e.stabilization, &e.blocks, &e.shells, &e.springs})
    f.blocks.insert(f.blocks.end(), of->begin(), of->end());
  // Of free degrees of freedom it is what Newton's method left.
  const DofFilter filter(s.model);
  filter.to_local(f.gradient);
  filter.keep_fixed(f.gradient);
  return f;
}

double largest_of(const std::vector<double>& values) {
  double largest = 1e-300;
  for (const double v : values) largest = std::max(largest, std::abs(v));
  return largest;
}

/// @param size  of what differences are judged by; 0: the largest value
void expect_same(const std::vector<double>& a, const std::vector<double>& b, const std::string& what, double size = 0) {
  constexpr double kSame = 1e-9;  // rounding, and what Newton's method leaves, through the damping
  ASSERT_EQ(a.size(), b.size()) << what;
  if (size == 0) size = largest_of(b);
  double error = 0;
  for (std::size_t i = 0; i < a.size(); ++i) error = std::max(error, std::abs(a[i] - b[i]));
  std::printf("  %s %8.1e", what.c_str(), error / size);
  EXPECT_LE(error, kSame * size) << what;
}

class DeviceForces : public ::testing::TestWithParam<std::tuple<Where, std::string>> {};

TEST_P(DeviceForces, AreThoseOfTheProcessor) {
  const auto& [where, kind] = GetParam();
  std::string reason;
  if (where == Where::device && !gpu::find_device(reason)) GTEST_SKIP() << reason;
  const bool host = where == Where::host;
  const Simulation s = load();
  SolverSettings settings = settings_of(s.scene.solver);
  settings.tolerance = 1e-12;
  const FactorFunction factors = [&](double t) { return s.factors(t); };
  ThreadPool pool(1);
  MechanicalSystem system(s.model, pool, settings);
  std::vector<Forces> expected, got;
  const auto see = [&](const StepInfo&, const State& state, MechanicalSystem& at) {
    SystemStep reached(at, state);
    expected.push_back(forces_at(s, reached));
    return true;
  };
  const auto see_there = [&](const StepInfo&, ReachedStep& at) {
    const long before = CpuExecutor::evaluations();
    got.push_back(forces_at(s, at));
    EXPECT_EQ(CpuExecutor::evaluations(), before) << "the processor evaluated what the device had";
    return true;
  };
  State on_cpu = s.initial, there = s.initial;
  if (kind == "explicit") {
    const ExplicitSettings dynamics{0.5 * stable_time_step(system, s.initial), 300,
                                    [](const StepInfo& info) { return info.step % 100 == 0; }};
    run_explicit(system, on_cpu, factors, dynamics, see);
    (host ? gpu::run_explicit_on_host : gpu::run_explicit)(s.model, there, factors, settings, dynamics, see_there);
  } else if (kind == "static") {
    run_statics(system, on_cpu, factors, settings, {4}, see);
    (host ? gpu::run_statics_on_host : gpu::run_statics)(s.model, there, factors, settings, {4}, see_there);
  } else {
    const TimeScheme scheme = kind == "midpoint"  ? TimeScheme::midpoint
                              : kind == "newmark" ? TimeScheme::newmark
                              : kind == "bdf2"    ? TimeScheme::bdf2
                                                  : TimeScheme::implicit_euler;
    const DynamicsSettings dynamics{scheme, 0.01, 4, 0, true};
    run_implicit(system, on_cpu, factors, settings, dynamics, see);
    (host ? gpu::run_implicit_on_host : gpu::run_implicit)(s.model, there, factors, settings, dynamics, see_there);
  }
  ASSERT_EQ(got.size(), expected.size());
  ASSERT_GE(got.size(), 3u);
  for (std::size_t i = 0; i < got.size(); ++i) {
    std::printf("%-16s", kind.c_str());
    expect_same(got[i].gradient, expected[i].gradient, "supports");
    expect_same(got[i].couplings, expected[i].couplings, "couplings");
    // At rest nothing but rounding pulls on what tethers alone hold.
    const double support = std::max(largest_of(expected[i].tethers), largest_of(expected[i].gradient));
    expect_same(got[i].tethers, expected[i].tethers, "tethers", kind == "static" ? support : 0);
    expect_same(got[i].blocks, expected[i].blocks, "blocks");
    const InternalEnergy &a = got[i].energy, &b = expected[i].energy;
    expect_same({a.elastic, a.stabilization, a.viscous}, {b.elastic, b.stabilization, b.viscous}, "energies");
    std::printf("\n");
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, DeviceForces,
                         ::testing::Combine(::testing::Values(Where::host, Where::device),
                                            ::testing::Values("static", "implicit_euler", "bdf2", "newmark", "midpoint",
                                                              "explicit")),
                         [](const auto& run) {
                           return (std::get<0>(run.param) == Where::host ? "host_" : "device_") +
                                  std::get<1>(run.param);
                         });

}  // namespace
}  // namespace fascia::test::device_forces_test
