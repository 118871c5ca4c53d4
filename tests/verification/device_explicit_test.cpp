#include "app/backend.hpp"
#include "app/scene/parse.hpp"
#include "app/simulation.hpp"
#include "app/solver_settings.hpp"
#include "gpu/device.hpp"
#include "gpu/run.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

/// Central differences as the device steps them, against the processor's own: in the space of the host always, on the
/// device where there is one.
namespace fascia::test {
namespace {

using app::Simulation;

enum class Where { host, device };

/// A scene, and what of it the runs need beside the file: a density, or damping.
struct Case {
  std::string name, scene;
  std::vector<std::string> settings;
  /// States agree to this, relative to the largest displacement and velocity: rounding of sums in another order, grown
  /// by the motion.
  double bound = 1e-9;
};
std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

Simulation load(const Case& c) {
  return app::build_simulation(
      app::parse_scene_file(std::filesystem::path(FASCIA_SOURCE_DIR) / "scenes" / (c.scene + ".toml"), c.settings));
}

double apart(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
  double largest = 1e-300, error = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, norm(b[i]));
    error = std::max(error, norm(a[i] - b[i]));
    if (std::isnan(norm(a[i] - b[i]))) return NAN;
  }
  return error / largest;
}

double apart(std::span<const double> a, std::span<const double> b) {
  double largest = 1e-300, error = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, std::abs(b[i]));
    error = std::max(error, std::abs(a[i] - b[i]));
  }
  return error / largest;
}

/// Both runs of a scene.
struct Runs {
  State expected, got;
  RunReport on_cpu, there;
  std::vector<double> expected_forces, forces;  ///< on the supports, at the last step seen
  std::vector<int> expected_seen, seen;         ///< steps
  double energy = 0, expected_energy = 0;
};

Runs run_both(const Simulation& s, Where where, double step, int steps) {
  const SolverSettings settings = app::settings_of(s.scene.solver);
  const FactorFunction factors = [&](double t) { return s.factors(t); };
  ThreadPool pool(1);
  MechanicalSystem system(s.model, pool, settings), shown(s.model, pool, settings);
  const double dt = step * stable_time_step(system, s.initial);
  const ExplicitSettings dynamics{dt, steps, [](const StepInfo& info) { return info.step % 77 == 0; }};
  Runs r{s.initial, s.initial, {}, {}, {}, {}, {}, {}};
  r.on_cpu = run_explicit(system, r.expected, factors, dynamics, [&](const StepInfo& i, const State&, auto& at) {
    r.expected_seen.push_back(i.step);
    r.expected_energy = at.internal_energy().total();
    r.expected_forces.assign(at.gradient().begin(), at.gradient().end());
    return true;
  });
  const auto run = where == Where::host ? gpu::run_explicit_on_host : gpu::run_explicit;
  r.there = run(s.model, r.got, factors, settings, dynamics, [&](const StepInfo& i, gpu::DeviceStep& at) {
    r.seen.push_back(i.step);
    r.energy = at.energy().total();
    at.show(shown, factors(i.time));
    r.forces.assign(shown.gradient().begin(), shown.gradient().end());
    return true;
  });
  return r;
}

class DeviceExplicit : public ::testing::TestWithParam<std::tuple<Where, Case>> {
 protected:
  void SetUp() override {
    std::string reason;
    if (where() == Where::device && gpu::usable_devices(reason).empty()) GTEST_SKIP() << reason;
  }
  static Where where() { return std::get<0>(GetParam()); }
  static const Case& scene() { return std::get<1>(GetParam()); }
};

TEST_P(DeviceExplicit, StepsAreThoseOfTheProcessor) {
  constexpr int kSteps = 300;
  const double bound = scene().bound;
  const Runs r = run_both(load(scene()), where(), 0.5, kSteps);
  EXPECT_EQ(r.there.message, r.on_cpu.message);
  EXPECT_EQ(r.there.steps, kSteps);
  EXPECT_EQ(r.seen, r.expected_seen);
  const double u = apart(r.got.u, r.expected.u), v = apart(r.got.v, r.expected.v);
  const double f = apart(r.forces, r.expected_forces), e = std::abs(r.energy / r.expected_energy - 1);
  std::printf("%-24s u %8.1e  v %8.1e  forces %8.1e  energy %8.1e\n", scene().name.c_str(), u, v, f, e);
  EXPECT_LE(u, bound);
  EXPECT_LE(v, bound);
  EXPECT_LE(f, bound);
  EXPECT_TRUE(e <= bound || r.expected_energy == 0);
  double turn = 0;
  for (std::size_t k = 0; k < r.got.turned.size(); ++k)
    for (std::size_t a = 0; a < 3; ++a) turn = std::max(turn, std::abs(r.got.turned[k][a] - r.expected.turned[k][a]));
  EXPECT_LE(turn, bound);
  EXPECT_EQ(r.got.time, r.expected.time);
}

using DeviceWatch = DeviceExplicit;

TEST_P(DeviceWatch, StopsWhereTheProcessorDoes) {
  const Runs r = run_both(load(scene()), where(), 1.1, 2000);
  EXPECT_EQ(r.on_cpu.status, RunStatus::diverged);
  EXPECT_EQ(r.there.status, RunStatus::diverged);
  EXPECT_EQ(r.there.message, r.on_cpu.message);
  EXPECT_EQ(r.there.steps, r.on_cpu.steps);
  EXPECT_EQ(r.there.time, r.on_cpu.time);
  EXPECT_EQ(r.seen, r.expected_seen);
  EXPECT_EQ(r.got.time, r.expected.time);
  EXPECT_EQ(r.got.u.size(), r.expected.u.size());
}

std::string name_of(const ::testing::TestParamInfo<DeviceExplicit::ParamType>& info) {
  return (std::get<0>(info.param) == Where::host ? "host_" : "device_") + std::get<1>(info.param).name;
}

const auto kWheres = ::testing::Values(Where::host, Where::device);

const auto kCases = ::testing::Values(
    Case{"hexahedra", "explicit_cantilever", {}}, Case{"tetrahedra", "tetrahedra_block_explicit", {}},
    Case{"tumbling_box", "tumbling_box", {}}, Case{"free_fall", "free_fall", {}},
    Case{"midpoint_spin", "midpoint_spin", {}}, Case{"shell_spin", "shell_spin", {}},
    Case{"bone_plate", "bone_plate", {}}, Case{"riding_surface", "riding_surface", {}},
    Case{"settling_beam", "settling_beam", {}}, Case{"struck_beam", "struck_beam", {}},
    Case{"line_swing", "line_swing", {}}, Case{"breathing_liver", "breathing_liver", {}},
    Case{"hanging_shells", "hanging_shells", {}}, Case{"paper_coupling", "paper_coupling", {}},
    Case{"uterus_bladder", "uterus_bladder", {}}, Case{"filled_ball", "filled_ball", {}},
    Case{"scattered_stretch", "scattered_stretch", {}}, Case{"shell_step", "shell_step", {}},
    Case{"rigid_turn", "rigid_turn", {}}, Case{"affine_cantilever", "affine_cantilever", {}},
    Case{"roll_up", "roll_up", {}}, Case{"affine_beside_rigid", "affine_beside_rigid", {}},
    Case{"coupled_surfaces", "coupled_surfaces", {}}, Case{"ligament_springs", "ligament_springs", {}},
    Case{"traction_clamped", "traction_clamped", {}}, Case{"shell_pull_out", "shell_pull_out", {}},
    Case{"scattered_cantilever", "scattered_cantilever", {}});

INSTANTIATE_TEST_SUITE_P(Scenes, DeviceExplicit, ::testing::Combine(kWheres, kCases), name_of);

const auto kUnstable =
    ::testing::Values(Case{"hexahedra", "explicit_cantilever", {}}, Case{"tumbling_box", "tumbling_box", {}});

INSTANTIATE_TEST_SUITE_P(Scenes, DeviceWatch, ::testing::Combine(kWheres, kUnstable), name_of);

}  // namespace
}  // namespace fascia::test
