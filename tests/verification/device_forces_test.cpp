#include "app/assembly/simulation.hpp"
#include "app/reader/parse.hpp"
#include "app/results/coupling_report.hpp"
#include "app/run/solver_settings.hpp"
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

using app::Simulation;

enum class Where { host, device };

/// Hexahedra, tissue that shares their vertices, tetrahedra that follow the tissue, a shell on these, and scattered
/// frames whose ends are held by tethers; pulled and turned, with both kinds of damping, from a motion that stretches
/// them at once.
constexpr const char* kScene = R"(
[materials]
soft = { young = 1e4, poisson = 0.3, damping = { stiffness = "20 ms", mass = "5 Hz" } }
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
material = "soft"
[bodies.skin]
model = "shell"
domain = { rectangle = { origin = [1, 0, 0.5], edge_u = [0.5, 0, 0], edge_v = [0, 0.5, 0], cells = [2, 2] } }
thickness = 0.02
density = 100
material = "soft"
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
  app::Scene scene = app::parse_scene_file(path, {});
  std::filesystem::remove(path);
  return app::build_simulation(std::move(scene));
}

/// What acts after a step, as numbers.
struct Forces {
  std::vector<double> gradient, couplings, tethers;
  InternalEnergy energy;
};

void append(const nlohmann::ordered_json& value, std::vector<double>& out) {
  if (value.is_number_float()) return out.push_back(value.get<double>());
  if (!value.is_structured()) return;
  for (const auto& entry : value) append(entry, out);
}

Forces forces_at(const Simulation& s, const MechanicalSystem& system, const State& state,
                 const InternalEnergy& energy) {
  Forces f{{system.gradient().begin(), system.gradient().end()}, {}, {}, energy};
  for (const auto& [name, report] : app::coupling_report(s, system, state)) append(report, f.couplings);
  for (const Tether& tether : s.model.tethers) {
    const Vec3d pull = system.executor().points().tether_force(tether, state);
    f.tethers.insert(f.tethers.end(), pull.v, pull.v + 3);
  }
  // Of free degrees of freedom it is what Newton's method left.
  system.filter().to_local(f.gradient);
  system.filter().keep_fixed(f.gradient);
  return f;
}

void expect_same(const std::vector<double>& a, const std::vector<double>& b, const std::string& what) {
  constexpr double kSame = 1e-9;  // rounding, and what Newton's method leaves, through the damping
  ASSERT_EQ(a.size(), b.size()) << what;
  double largest = 1e-300, error = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, std::abs(b[i]));
    error = std::max(error, std::abs(a[i] - b[i]));
  }
  std::printf("  %s %8.1e", what.c_str(), error / largest);
  EXPECT_LE(error, kSame * largest) << what;
}

class DeviceForces : public ::testing::TestWithParam<std::tuple<Where, std::string>> {};

TEST_P(DeviceForces, AreThoseOfTheProcessor) {
  const auto& [where, kind] = GetParam();
  std::string reason;
  if (where == Where::device && !gpu::find_device(reason)) GTEST_SKIP() << reason;
  const bool host = where == Where::host;
  const Simulation s = load();
  SolverSettings settings = app::settings_of(s.scene.solver);
  settings.tolerance = 1e-12;
  const FactorFunction factors = [&](double t) { return s.factors(t); };
  ThreadPool pool(1);
  MechanicalSystem system(s.model, pool, settings), shown(s.model, pool, settings);
  std::vector<Forces> expected, got;
  const auto see = [&](const StepInfo&, const State& state, MechanicalSystem& at) {
    expected.push_back(forces_at(s, at, state, at.internal_energy()));
    return true;
  };
  const auto see_there = [&](const StepInfo& step, gpu::DeviceStep& at) {
    at.show(shown, factors(step.time));
    got.push_back(forces_at(s, shown, at.state(), at.energy()));
    return true;
  };
  State on_cpu = s.initial, there = s.initial;
  if (kind == "explicit") {
    const ExplicitSettings dynamics{0.5 * stable_time_step(system, s.initial), 300,
                                    [](const StepInfo& info) { return info.step % 100 == 0; }};
    run_explicit(system, on_cpu, factors, dynamics, see);
    (host ? gpu::run_explicit_on_host : gpu::run_explicit)(s.model, there, factors, settings, dynamics, see_there);
  } else {
    const TimeScheme scheme = kind == "midpoint"  ? TimeScheme::midpoint
                              : kind == "newmark" ? TimeScheme::newmark
                              : kind == "bdf2"    ? TimeScheme::bdf2
                                                  : TimeScheme::implicit_euler;
    const DynamicsSettings dynamics{scheme, 0.01, 4};
    run_implicit(system, on_cpu, factors, settings, dynamics, see);
    (host ? gpu::run_implicit_on_host : gpu::run_implicit)(s.model, there, factors, settings, dynamics, see_there);
  }
  ASSERT_EQ(got.size(), expected.size());
  ASSERT_GE(got.size(), 3u);
  for (std::size_t i = 0; i < got.size(); ++i) {
    std::printf("%-16s", kind.c_str());
    expect_same(got[i].gradient, expected[i].gradient, "supports");
    expect_same(got[i].couplings, expected[i].couplings, "couplings");
    expect_same(got[i].tethers, expected[i].tethers, "tethers");
    const InternalEnergy &a = got[i].energy, &b = expected[i].energy;
    expect_same({a.elastic, a.stabilization, a.viscous}, {b.elastic, b.stabilization, b.viscous}, "energies");
    std::printf("\n");
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, DeviceForces,
                         ::testing::Combine(::testing::Values(Where::host, Where::device),
                                            ::testing::Values("implicit_euler", "bdf2", "newmark", "midpoint",
                                                              "explicit")),
                         [](const auto& run) {
                           return (std::get<0>(run.param) == Where::host ? "host_" : "device_") +
                                  std::get<1>(run.param);
                         });

}  // namespace
}  // namespace fascia::test::device_forces_test
