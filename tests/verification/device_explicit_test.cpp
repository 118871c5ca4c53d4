#include "assembly/simulation/simulation.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "core/run/explicit_step.hpp"
#include "core/space/space.hpp"
#include "fascia/choose_backend.hpp"
#include "gpu/explicit/explicit.hpp"
#include "gpu/run/run.hpp"
#include "gpu/space/device.hpp"
#include "tests/support/small_scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

/// Central differences as the device steps them, against the processor's own: in the space of the host always, on the
/// device where there is one.
namespace fascia::test::device_explicit_test {
namespace {

enum class Where { host, device };

/// States agree to this, relative to the largest displacement and velocity: rounding of sums in another order, grown by
/// the motion.
constexpr double kSameState = 1e-9;

/// What scenes have here that no file has: followers of vertices and of frames.
std::vector<std::string> settings(const std::string& scene) {
  if (scene == "explicit_cantilever")
    return {"loads=[{body='beam',where={box={min=[0.99,-1,-1],max=[1.1,1,1]}},total_force=[0,50,0],follower=true}]"};
  if (scene == "shell_roll_up") return {"loads[0].follower=true"};
  return {};
}

Simulation load(const std::string& scene) { return small_scene(scene, settings(scene)); }

/// A part of the stable time step; where nothing is free there is none, and a ten thousandth of the whole.
double time_step(const Simulation& s, MechanicalSystem& system, double part) {
  const double stable = stable_time_step(system, s.initial);
  return std::isfinite(stable) ? part * stable : 1e-4;
}

double kinetic_energy(const Model& model, const State& state) {
  double sum = 0;
  for (std::size_t i = 0; i < state.u.size(); ++i)
    sum += 0.5 * inertia_product(model.inertia[i], state.v[i], state.Q_dot[i]);
  return sum;
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

/// @param part  of the stable step
/// @param automatic  up to the time that so many such steps take
Runs run_both(const Simulation& s, Where where, double part, int steps, bool automatic = false) {
  const SolverSettings settings = settings_of(s.scene.solver);
  const FactorFunction factors = [&](double t) { return s.factors(t); };
  ThreadPool pool(1);
  MechanicalSystem system(s.model, pool, settings);
  const double dt = time_step(s, system, part);
  ExplicitSettings dynamics{dt, steps, [](const StepInfo& info) { return info.step % 77 == 0; }};
  dynamics.automatic = automatic;
  dynamics.duration = automatic ? steps * dt : 0;
  Runs r{s.initial, s.initial, {}, {}, {}, {}, {}, {}};
  r.on_cpu = run_explicit(system, r.expected, factors, dynamics, [&](const StepInfo& i, const State&, auto& at) {
    r.expected_seen.push_back(i.step);
    r.expected_energy = at.internal_energy().total();
    r.expected_forces.assign(at.gradient().begin(), at.gradient().end());
    return true;
  });
  const auto run = where == Where::host ? gpu::run_explicit_on_host : gpu::run_explicit;
  r.there = run(s.model, r.got, factors, settings, dynamics, [&](const StepInfo& i, ReachedStep& at) {
    r.seen.push_back(i.step);
    r.energy = at.energy().total();
    ReachedForces acting;
    at.read({true, false, false}, acting);
    r.forces = acting.gradient;
    return true;
  });
  return r;
}

class DeviceExplicit : public ::testing::TestWithParam<std::tuple<Where, std::string>> {
 protected:
  void SetUp() override {
    std::string reason;
    if (where() == Where::device && !gpu::find_device(reason)) GTEST_SKIP() << reason;
  }
  static Where where() { return std::get<0>(GetParam()); }
  static std::string scene() { return std::get<1>(GetParam()); }
};

TEST_P(DeviceExplicit, StepsAreThoseOfTheProcessor) {
  constexpr int kSteps = 300;
  const Simulation s = load(scene());
  ASSERT_EQ(not_on_gpu(s), "");
  const Runs r = run_both(s, where(), 0.5, kSteps);
  EXPECT_EQ(r.there.message, r.on_cpu.message);
  EXPECT_EQ(r.there.steps, kSteps);
  EXPECT_EQ(r.seen, r.expected_seen);
  EXPECT_EQ(r.got.time, r.expected.time);
  const double u = apart(r.got.u, r.expected.u), v = apart(r.got.v, r.expected.v);
  const double f = apart(r.forces, r.expected_forces);
  const double energies = r.expected_energy + kinetic_energy(s.model, r.expected);
  const double e = std::abs(r.energy - r.expected_energy) / energies;
  std::printf("%-24s u %8.1e  v %8.1e  forces %8.1e  energy %8.1e\n", scene().c_str(), u, v, f, e);
  EXPECT_LE(u, kSameState);
  EXPECT_LE(v, kSameState);
  EXPECT_LE(f, kSameState);
  EXPECT_LE(e, kSameState);
  for (std::size_t k = 0; k < r.got.turned.size(); ++k)
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(r.got.turned[k][a], r.expected.turned[k][a], kSameState);
}

using DeviceAutomatic = DeviceExplicit;

/// The same steps, of the same lengths, where they follow the state.
TEST_P(DeviceAutomatic, StepsFollowTheStateAsOnTheProcessor) {
  constexpr int kSteps = 200;
  const Runs r = run_both(load(scene()), where(), 1, kSteps, true);
  std::printf("%-24s %d steps, %zu seen\n", scene().c_str(), r.on_cpu.steps, r.seen.size());
  EXPECT_EQ(r.on_cpu.status, RunStatus::converged) << r.on_cpu.message;
  EXPECT_EQ(r.there.status, RunStatus::converged) << r.there.message;
  EXPECT_EQ(r.there.steps, r.on_cpu.steps);
  EXPECT_EQ(r.seen, r.expected_seen);
  EXPECT_EQ(r.got.time, r.expected.time);
  constexpr double kSameSteps = 1e-6;  // their lengths come from differences of forces, good to about 1e-7
  EXPECT_LE(apart(r.got.u, r.expected.u), kSameSteps);
  EXPECT_LE(apart(r.got.v, r.expected.v), kSameSteps);
}

class ExplicitEnergies : public ::testing::TestWithParam<std::string> {};

/// What the watch compares.
TEST_P(ExplicitEnergies, AreThoseOfTheProcessor) {
  const Simulation s = load(GetParam());
  const FactorFunction factors = [&](double t) { return s.factors(t); };
  ThreadPool pool(1);
  MechanicalSystem system(s.model, pool, settings_of(s.scene.solver));
  const double dt = time_step(s, system, 0.5);
  const ExplicitPlan plan({dt, 200, {}}, 0);
  ExplicitStepper expected(system, s.initial, plan, factors);
  gpu::ExplicitSystem<HostSpace> got(s.model, s.initial, plan, factors);
  for (int step = 1; step <= 200; ++step) {
    expected.advance();
    got.advance();
    const ExplicitProgress there = got.progress(), here = expected.progress();
    const double given = here.given + here.largest_work;
    ASSERT_NEAR(there.kinetic, here.kinetic, kSameState * given);
    ASSERT_NEAR(there.given + there.largest_work, given, kSameState * given);
    ASSERT_EQ(there.unsound, here.unsound);
    ASSERT_EQ(there.step, step);
    ASSERT_EQ(here.step, step);
  }
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
  return (std::get<0>(info.param) == Where::host ? "host_" : "device_") + std::get<1>(info.param);
}

const auto kWheres = ::testing::Values(Where::host, Where::device);

/// Every kind of body, coupling, load, damping and prescribed motion, and stresses that fade.
const auto kScenes =
    ::testing::Values("explicit_cantilever", "tetrahedra_block_explicit", "tumbling_box", "free_fall", "midpoint_spin",
                      "shell_spin", "bone_plate", "riding_surface", "settling_beam", "struck_beam", "line_swing",
                      "breathing_liver", "hanging_shells", "paper_coupling", "uterus_bladder", "filled_ball",
                      "scattered_stretch", "rigid_turn", "affine_cantilever", "roll_up", "affine_beside_rigid",
                      "ligament_springs", "traction_clamped", "coupled_surfaces", "shell_roll_up", "relaxing_ligament");

INSTANTIATE_TEST_SUITE_P(Scenes, DeviceExplicit, ::testing::Combine(kWheres, kScenes), name_of);
/// Vertices, rigid and affine frames, shells, tethers, springs, fluids, dependent nodes, damping, motions that stretch.
INSTANTIATE_TEST_SUITE_P(Scenes, DeviceAutomatic,
                         ::testing::Combine(kWheres,
                                            ::testing::Values("explicit_cantilever", "tumbling_box", "shell_spin",
                                                              "scattered_stretch", "filled_ball", "affine_cantilever",
                                                              "ligament_springs", "settling_beam", "bone_plate",
                                                              "rigid_turn", "relaxing_ligament")),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Scenes, DeviceWatch,
                         ::testing::Combine(kWheres, ::testing::Values("explicit_cantilever", "tumbling_box")),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Scenes, ExplicitEnergies,
                         ::testing::Values("breathing_liver", "scattered_stretch", "rigid_turn", "filled_ball",
                                           "uterus_bladder", "shell_spin", "explicit_cantilever", "affine_cantilever"),
                         [](const auto& param) { return "host_" + param.param; });

}  // namespace
}  // namespace fascia::test::device_explicit_test
