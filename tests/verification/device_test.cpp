#include "gpu/space/device.hpp"
#include "assembly/simulation/simulation.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "core/base/errors.hpp"
#include "fascia/choose_backend.hpp"
#include "gpu/run/run.hpp"
#include "gpu/tiles/tile_points.hpp"
#include "tests/support/models.hpp"
#include "tests/support/small_scenes.hpp"
#include "tests/support/solve_where.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

/// Scenes by what runs on the device, against the processor's own code: in the space of the host always, on the device
/// where there is one.
namespace fascia::test::device_test {
namespace {

/// Energy, forces and products agree to this; rounding of sums in another order leaves 1e-14 to 1e-13.
constexpr double kSameState = 1e-12;
/// Solutions, with Newton's tolerance far below; or 1e3 ε κ, where that is more.
constexpr double kSameSolution = 1e-10;
constexpr double kLinearTolerance = 1e-10;

/// A lower bound of the preconditioned tangent's condition: conjugate gradients take ½ √κ ln(2 / tolerance) iterations.
double condition(const RunReport& report) {
  const double each = static_cast<double>(report.linear_iterations) / std::max(report.newton_iterations, 1);
  return std::pow(2 * each / std::log(2 / kLinearTolerance), 2);
}

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> d(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) d[i] = a[i] - b[i];
  return norm(d) / std::max(norm(b), 1e-300);
}

double difference(double a, double b) { return std::abs(a - b) / std::max(std::abs(b), 1e-300); }

/// A state that deforms every body of a scene by a few per cent of its nodes' spacing.
State deformed(const Simulation& s) {
  double spacing = 1e300;
  for (const double length : s.model.points.part_length) spacing = std::min(spacing, length);
  State state = random_state(s.model, 0.03 * spacing, 0.03);
  place_dependents(s.model.points, state);
  return state;
}

class Device : public ::testing::TestWithParam<std::tuple<Where, std::string>> {
 protected:
  void SetUp() override {
    std::string reason;
    if (where() == Where::device && !gpu::find_device(reason)) GTEST_SKIP() << reason;
  }
  /// Some scenes use meshes that are not everywhere.
  static std::optional<Simulation> loaded(const std::vector<std::string>& settings = {}) {
    try {
      return small_scene(scene(), settings);
    } catch (const FileError& e) {
      why_not = e.what();
      return std::nullopt;
    }
  }
  static inline std::string why_not;
  static Where where() { return std::get<0>(GetParam()); }
  static std::string scene() { return std::get<1>(GetParam()); }
};

using DeviceState = Device;

TEST_P(DeviceState, HasTheProcessorsEnergyForcesAndProduct) {
  const std::optional<Simulation> simulation = loaded();
  if (!simulation) GTEST_SKIP() << why_not;
  const Simulation& s = *simulation;
  const SolverSettings settings = settings_of(s.scene.solver);
  const State state = deformed(s);
  const std::vector<double> factors = s.factors(1), d = random_direction(s.model);
  ThreadPool pool(1);
  MechanicalSystem system(s.model, pool, settings);
  system.set_factors(factors);
  system.begin_step(state, 0);
  const Evaluation expected = system.evaluate();
  const auto evaluate = where() == Where::host ? gpu::evaluate_on_host : gpu::evaluate;
  const gpu::DeviceEvaluation got = evaluate(s.model, state, factors, settings, d);
  EXPECT_LE(difference(got.judged.energy, expected.energy), kSameState);
  EXPECT_LE(difference(got.energy.elastic, system.internal_energy().elastic), kSameState);
  EXPECT_LE(difference(got.judged.residual, expected.residual), kSameState);
  EXPECT_LE(difference(got.judged.relative, expected.relative), kSameState);
  EXPECT_LE(difference(got.judged.relative_floor, expected.relative_floor), kSameState);
  EXPECT_LE(difference(got.gradient, {system.gradient().begin(), system.gradient().end()}), kSameState);
  EXPECT_LE(difference(got.product, system.product(d)), kSameState);
}

/// Products of 32 bits differ by their rounding.
constexpr double kSameRounded = 1e-6;

TEST_P(DeviceState, HasTheProductRounded) {
  const std::optional<Simulation> simulation = loaded();
  if (!simulation) GTEST_SKIP() << why_not;
  const Simulation& s = *simulation;
  SolverSettings settings = settings_of(s.scene.solver);
  const State state = deformed(s);
  const std::vector<double> factors = s.factors(1), d = random_direction(s.model);
  const auto evaluate = where() == Where::host ? gpu::evaluate_on_host : gpu::evaluate;
  const gpu::DeviceEvaluation expected = evaluate(s.model, state, factors, settings, d);
  std::printf("%-30s |dKd|/|Kd|", scene().c_str());
  for (const Precision precision : {Precision::mixed, Precision::single}) {
    settings.precision = precision;
    const gpu::DeviceEvaluation got = evaluate(s.model, state, factors, settings, d);
    const double error = difference(got.product, expected.product);
    std::printf("  %s %8.1e", precision == Precision::mixed ? "mixed" : "single", error);
    EXPECT_LE(error, kSameRounded);
    EXPECT_GT(error, 0.0);
    EXPECT_EQ(difference(got.gradient, expected.gradient), 0.0);
  }
  std::printf("\n");
}

using DeviceSolution = Device;

TEST_P(DeviceSolution, IsThatOfEveryPrecision) {
  const std::optional<Simulation> simulation = loaded({"solver.linear.kind=cg", "solver.linear.max_iterations=100000"});
  if (!simulation) GTEST_SKIP() << why_not;
  const Simulation& s = *simulation;
  SolverSettings settings = settings_of(s.scene.solver);
  const Solved expected = solve(s, where(), settings);
  std::printf("%-30s double: Newton %3d CG %6d", scene().c_str(), expected.report.newton_iterations,
              expected.report.linear_iterations);
  for (const Precision precision : {Precision::mixed, Precision::single}) {
    settings.precision = precision;
    const Solved got = solve(s, where(), settings);
    const double error = displacement_difference(got.state, expected.state);
    std::printf("  %s: |du|/|u| %8.1e Newton %3d CG %6d", precision == Precision::mixed ? "mixed" : "single", error,
                got.report.newton_iterations, got.report.linear_iterations);
    EXPECT_EQ(got.report.message, expected.report.message);
    EXPECT_EQ(got.report.steps, expected.report.steps);
    EXPECT_LE(error, 1e-6);
  }
  std::printf("\n");
}

const std::vector<std::string> kToRounding = {"solver.linear.kind=cg", "solver.linear.tolerance=1e-10",
                                              "solver.linear.max_iterations=100000", "solver.newton.tolerance=1e-12"};

/// Solves on the processor, and compares.
void expect_solution_of_processor(const Simulation& s, Where where, const SolverSettings& settings) {
  const auto [expected, on_cpu] = solve(s, Where::processor, settings);
  const auto [got, there] = solve(s, where, settings);
  EXPECT_EQ(there.message, on_cpu.message);
  EXPECT_EQ(there.steps, on_cpu.steps);
  const double error = displacement_difference(got, expected);
  std::printf("%-30s |du|/|u| %8.1e  Newton %3d %3d  CG %6d %6d\n", s.scene.path.stem().c_str(), error,
              there.newton_iterations, on_cpu.newton_iterations, there.linear_iterations, on_cpu.linear_iterations);
  EXPECT_LE(error, std::max(kSameSolution, 1e3 * std::numeric_limits<double>::epsilon() * condition(on_cpu)));
  // In tiles the tangent has the stress of the state, and Newton's method takes more iterations.
  const bool in_tiles = where == Where::device && not_for_tiles(s.model.points).empty();
  const int more = in_tiles ? std::max(2, 3 * on_cpu.newton_iterations) : 2;
  EXPECT_LE(there.newton_iterations, on_cpu.newton_iterations + more);
  EXPECT_GE(there.newton_iterations, on_cpu.newton_iterations - 2);
}

TEST_P(DeviceSolution, IsThatOfTheProcessor) {
  const std::optional<Simulation> simulation = loaded(kToRounding);
  if (!simulation) GTEST_SKIP() << why_not;
  ASSERT_EQ(not_on_gpu(*simulation), "");
  expect_solution_of_processor(*simulation, where(), settings_of(simulation->scene.solver));
}

using DeviceLevels = Device;
using DeviceChoice = Device;

/// Made of the same tangent by the same code: as long as they are new, levels take as many iterations here as there.
/// Kept for later tangents they smooth with the matrix that they were made of, where the processor has the present one:
/// up to half as many iterations more, from which on they are made again.
TEST_P(DeviceLevels, TakeTheIterationsOfTheProcessors) {
  const auto with = [](std::vector<std::string> more) {
    more.insert(more.end(), {"solver.linear.kind=cg", "solver.linear.preconditioner=multigrid",
                             "solver.linear.tolerance=1e-10", "solver.newton.tolerance=1e-12"});
    return more;
  };
  std::optional<Simulation> simulation = loaded(with({}));
  if (!simulation) GTEST_SKIP() << why_not;
  ASSERT_EQ(not_on_gpu(*simulation), "");
  Simulation& s = *simulation;
  SolverSettings settings = settings_of(s.scene.solver);
  const auto [expected, on_cpu] = solve(s, Where::processor, settings);
  const auto [got, there] = solve(s, where(), settings);
  const double error = displacement_difference(got, expected);
  std::printf("%-30s |du|/|u| %8.1e  Newton %3d %3d  CG %6d %6d\n", scene().c_str(), error, there.newton_iterations,
              on_cpu.newton_iterations, there.linear_iterations, on_cpu.linear_iterations);
  EXPECT_EQ(there.message, on_cpu.message);
  EXPECT_EQ(there.steps, on_cpu.steps);
  EXPECT_LE(error, kSameSolution);
  const auto each = [](const RunReport& run) {
    return static_cast<double>(run.linear_iterations) / run.newton_iterations;
  };
  EXPECT_LE(each(there), 1.5 * each(on_cpu) + 1);
  if (scene() == "shell_roof") {
    SolverSettings mixed = settings;
    mixed.precision = Precision::mixed;
    EXPECT_LE(displacement_difference(solve(s, where(), mixed).state, expected), 1e-9);
  }
  // The first solve alone; a large motion is cut into more steps, whose levels are kept. Of quadratic elements the
  // processor has a level of corners as well: there it is linear ones that take as many.
  if (scene() == "soft_cantilever_tetrahedra") simulation = loaded(with({"bodies.beam.order=1"}));
  s.scene.solver.load_steps = s.scene.solver.steps = 1;
  settings.max_iterations = 1;
  settings.proceed_on_limit = true;
  const RunReport first = solve(s, Where::processor, settings).report;
  EXPECT_GT(first.linear_iterations, 0);
  if (first.newton_iterations > 1) return;
  EXPECT_NEAR(solve(s, where(), settings).report.linear_iterations, first.linear_iterations,
              0.05 * first.linear_iterations + 1);
}

/// Blocks end at their limit; levels then converge, where no factor takes over.
TEST_P(DeviceChoice, TakesLevelsWhereBlocksEndAtTheirLimit) {
  const Simulation s = small_scene("shell_roof", {"solver.linear.kind=cg", "solver.linear.tolerance=1e-12",
                                                  "bodies.roof.domain.cylinder.cells=[24,24]"});
  const SolverSettings settings = settings_of(s.scene.solver);
  const auto [expected, on_cpu] = solve(s, Where::processor, settings);
  const auto [got, there] = solve(s, where(), settings);
  std::printf("CG %d %d\n", there.linear_iterations, on_cpu.linear_iterations);
  EXPECT_EQ(there.message, on_cpu.message);
  EXPECT_GT(on_cpu.linear_iterations, 1000);
  EXPECT_LE(there.linear_iterations, 1.1 * on_cpu.linear_iterations);
  EXPECT_LE(displacement_difference(got, expected), 1e-8);
}

/// Points shared by several devices, which may be one and the same.
class SharedSolution : public ::testing::TestWithParam<std::string> {};

TEST_P(SharedSolution, IsThatOfTheProcessor) {
  std::string reason;
  const std::vector<int> devices = gpu::find_devices(kMostDevices, reason);
  if (devices.empty()) GTEST_SKIP() << reason;
  const Simulation s = small_scene(GetParam(), kToRounding);
  SolverSettings settings = settings_of(s.scene.solver);
  for (const std::size_t shares : {2U, 3U}) {
    settings.devices.clear();
    for (std::size_t i = 0; i < shares; ++i) settings.devices.push_back(devices[i % devices.size()]);
    expect_solution_of_processor(s, Where::device, settings);
  }
}

INSTANTIATE_TEST_SUITE_P(device, SharedSolution,
                         ::testing::Values("soft_cantilever", "traction_clamped", "settling_beam", "tumbling_box"),
                         [](const auto& scene) { return scene.param; });

TEST(DeviceShares, RefuseWhatTheyCannotShare) {
  std::string reason;
  const std::vector<int> devices = gpu::find_devices(1, reason);
  if (devices.empty()) GTEST_SKIP() << reason;
  const auto refused = [&](const std::string& scene, const std::vector<std::string>& overrides) {
    const Simulation s = small_scene(scene, overrides);
    SolverSettings settings = settings_of(s.scene.solver);
    settings.devices = {devices[0], devices[0]};
    EXPECT_THROW(solve(s, Where::device, settings), gpu::NotShared) << scene;
  };
  refused("shell_roof", {});
  refused("settling_beam", {"solver.kind=newmark"});
}

std::string name_of(const ::testing::TestParamInfo<Device::ParamType>& info) {
  return (std::get<0>(info.param) == Where::host ? "host_" : "device_") + std::get<1>(info.param);
}

/// Every kind of body, coupling and load.
const auto kStates = ::testing::Values(
    "soft_cantilever", "affine_beside_rigid", "scattered_cantilever", "paper_sheet", "line_cantilever",
    "traction_clamped", "breathing_liver", "tumbling_box", "five_tissues", "three_beams", "uterus_bladder",
    "bone_plate", "hanging_liver", "ligament_springs", "riding_surface", "coupled_surfaces", "cook_neo_hookean",
    "soft_cantilever_tetrahedra", "soft_cantilever_hexahedra", "pushed_cylinder", "nearly_incompressible", "shell_roof",
    "shell_liver", "sheet_beside_shell", "elastica", "shell_pull_out", "thinning_volume", "roll_up", "liver_tetrahedra",
    "paper_coupling");

INSTANTIATE_TEST_SUITE_P(Scenes, DeviceState,
                         ::testing::Combine(::testing::Values(Where::host, Where::device), kStates), name_of);

/// Every scheme, kind of element and coupling, in seconds.
const auto kSolutions = ::testing::Values(
    "soft_cantilever", "affine_cantilever", "svk_uniaxial", "sheet_bending", "traction_clamped", "settling_beam",
    "tumbling_box", "midpoint_spin", "free_fall", "rigid_turn", "bone_plate", "riding_surface", "ligament_springs",
    "soft_cantilever_tetrahedra", "shell_spin", "struck_beam", "roll_up", "line_swing", "hanging_column", "shell_roof",
    "relaxing_ligament", "contracting_muscle");

/// Where all is prescribed there is nothing to iterate on, nor to factorise.
TEST_P(DeviceChoice, OfALinearSolverIsTheProgramsOwn) {
  const std::optional<Simulation> simulation = loaded();
  if (!simulation) GTEST_SKIP() << why_not;
  expect_solution_of_processor(*simulation, where(), settings_of(simulation->scene.solver));
}

/// One Newton iteration is not enough, however short the load step.
TEST_P(DeviceChoice, KeepsTheStateInWhichItFailed) {
  const Simulation s = small_scene("soft_cantilever", kToRounding);
  SolverSettings settings = settings_of(s.scene.solver);
  settings.max_iterations = 1;
  const RunReport expected = solve(s, Where::processor, settings).report, got = solve(s, where(), settings).report;
  EXPECT_EQ(got.message, expected.message);
  ASSERT_TRUE(expected.failed && got.failed);
  EXPECT_EQ(got.failed->step, expected.failed->step);
  EXPECT_LE(displacement_difference(got.failed->state, expected.failed->state), kSameSolution);
  EXPECT_LE(difference(got.failed->gradient, expected.failed->gradient), 1e-6);  // of what is left, 1e-4 of the loads
}

INSTANTIATE_TEST_SUITE_P(Scenes, DeviceChoice,
                         ::testing::Combine(::testing::Values(Where::host, Where::device),
                                            ::testing::Values("rigid_turn")),
                         name_of);
INSTANTIATE_TEST_SUITE_P(
    Scenes, DeviceLevels,
    ::testing::Combine(::testing::Values(Where::host, Where::device),
                       ::testing::Values("soft_cantilever", "affine_cantilever", "sheet_bending", "settling_beam",
                                         "bone_plate", "ligament_springs", "shell_roof", "shell_bladder",
                                         "soft_cantilever_tetrahedra", "roll_up", "hanging_column")),
    name_of);
INSTANTIATE_TEST_SUITE_P(Scenes, DeviceSolution,
                         ::testing::Combine(::testing::Values(Where::host, Where::device), kSolutions), name_of);

}  // namespace
}  // namespace fascia::test::device_test
