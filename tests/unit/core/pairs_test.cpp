// A pair energy between two bodies, as contact has it: pairs come and go between steps, the matrix has their entries,
// and no step of Newton's method goes where the energy has no value.
#include "core/base/errors.hpp"
#include "core/run/drivers.hpp"
#include "core/run/explicit_dynamics.hpp"
#include "tests/support/dependent_models.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fascia::pairs_test {
namespace {

using namespace test;

/// Pairs of nodes that repel one another: κ (d − d̂)² ln(d̂/d) of their distance d < d̂, without value at d = 0.
class Barrier final : public UserBlock {
 public:
  Barrier(std::vector<Vec3d> rest, double reach, double stiffness)
      : UserBlock(2, {}, reach), rest_(std::move(rest)), kappa_(stiffness) {}

  /// Takes those of two sets of nodes that are near each other at a state.
  void find(const State& state, const std::vector<int>& first, const std::vector<int>& second, double within) {
    std::vector<int> pairs;
    for (const int a : first)
      for (const int b : second)
        if (norm(rest_[at(a)] + state.u[at(a)] - rest_[at(b)] - state.u[at(b)]) < within)
          pairs.insert(pairs.end(), {a, b});
    set_cells(std::move(pairs));
  }

  double forces(int c, std::span<const CellPose> poses, std::span<CellForce> gradient) const override {
    const Vec3d x = apart(c, poses);
    const double d = norm(x);
    if (d >= length) return 0;
    const Vec3d f = x * (slope(d) / d);
    gradient[0].force += f;
    gradient[1].force -= f;
    return kappa_ * (d - length) * (d - length) * std::log(length / d);
  }
  void product(int c, std::span<const CellPose> poses, Tangent tangent, std::span<const CellMotion> motions,
               std::span<CellForce> out) const override {
    const Vec3d x = apart(c, poses);
    const double d = norm(x);
    if (d >= length) return;
    const Vec3d n = x * (1 / d), dx = motions[0].dx - motions[1].dx;
    Vec3d f = n * (curvature(d) * dot(n, dx));
    if (tangent == Tangent::full) f += (dx - n * dot(n, dx)) * (slope(d) / d);
    out[0].force += f;
    out[1].force -= f;
  }
  double stiffness(int) const override { return kappa_ / length; }
  /// A pair may lose nine tenths of its distance in one step.
  double largest_step(int c, std::span<const CellPose> poses, std::span<const CellMotion> motions) const override {
    const Vec3d x = apart(c, poses), dx = motions[0].dx - motions[1].dx;
    ++asked_;
    const double approach = -dot(x, dx) / squared_norm(x);
    return approach > 0.9 ? 0.9 / approach : 1;
  }
  int asked() const { return asked_; }
  double nearest(const State& state) const {
    double least = 1e300;
    for (int c = 0; c < count(); ++c) {
      const Vec3d x = rest_[at(cell(c)[0])] + state.u[at(cell(c)[0])] - rest_[at(cell(c)[1])] - state.u[at(cell(c)[1])];
      least = std::min(least, norm(x));
    }
    return least;
  }

 private:
  Vec3d apart(int c, std::span<const CellPose> poses) const {
    return rest_[at(cell(c)[0])] + poses[0].u - rest_[at(cell(c)[1])] - poses[1].u;
  }
  double slope(double d) const { return kappa_ * (d - length) * (2 * std::log(length / d) - (d - length) / d); }
  double curvature(double d) const {
    const double e = d - length;
    return kappa_ * (2 * std::log(length / d) - 4 * e / d + e * e / (d * d));
  }

  std::vector<Vec3d> rest_;
  double kappa_;
  mutable int asked_ = 0;
};

/// Two blocks, one above the other with a gap that is wider on one side; a motion presses the upper one down.
struct Press {
  Model model;
  std::vector<int> below, above;  ///< nodes on both sides of the gap
  std::shared_ptr<Barrier> pairs;

  Press() {
    BlockOptions lower, upper;
    lower.grid = upper.grid = {3, 3, 3};
    upper.translation = {{0.01, 0.02, 1.3}};
    upper.rotation = rotation_about({{0, 1, 0}}, -0.1);
    PointSetBuilder points;
    const GridBody first(block_spec(lower), model, points), second(block_spec(upper), model, points);
    PrescribedMotion down;
    down.translation = {{0, 0, -0.28}};
    model.motions.push_back(down);
    for (int i = 0; i < model.node_count(); ++i) {
      const bool of_upper = i >= second.first_node();
      const Vec3d X = model.rest_position[at(i)];
      const double z = of_upper ? dot(upper.rotation.column(2), X - upper.translation) : X[2];
      if (std::abs(z - (of_upper ? 0 : 1)) < 1e-9) (of_upper ? above : below).push_back(i);
      if (std::abs(z - (of_upper ? 1 : 0)) > 1e-9) continue;
      FrameConstraint c;
      c.node = i;
      c.translations = c.rotations = 3;
      if (of_upper) c.translation_motion = c.rotation_motion = {0, 0, 0};
      model.constraints.push_back(c);
    }
    pairs = std::make_shared<Barrier>(model.rest_position, 0.15, 4000.0);
    points.add_user_block(pairs);
    model.points = std::move(points).finish(model.frame_kind);
  }
};

class PairsOf : public testing::TestWithParam<std::pair<LinearMethod, PreconditionerKind>> {};

TEST_P(PairsOf, PressTwoBodiesTogether) {
  Press press;
  ThreadPool pool(2);
  std::vector<double> residuals;
  int last = 0;
  double worst = 0;  // exponent of the residual's fall
  SolverSettings settings;
  settings.linear = GetParam().first;
  settings.preconditioner = GetParam().second;
  settings.cg.tolerance = 1e-10;
  settings.tolerance = 1e-12;
  settings.iterating = [&](const IterationInfo& info) {
    if (info.iteration == 1) residuals.clear();
    residuals.push_back(info.relative);
  };
  MechanicalSystem system(press.model, pool, settings);
  State state = State::at_rest(press.model);
  constexpr int kSteps = 20;
  int revisions = 0, quadratic = 0;
  for (int step = 1; step <= kSteps; ++step) {
    const long before = press.pairs->revision();
    press.pairs->find(state, press.below, press.above, 0.2);
    revisions += press.pairs->revision() != before ? 1 : 0;
    system.begin_step(state, 0);
    system.set_factors(std::vector<double>{static_cast<double>(step) / kSteps});
    Newton newton(system, settings, {step, 0});
    const NewtonReport report = newton.solve();
    ASSERT_EQ(report.status, NewtonStatus::converged) << step;
    for (std::size_t k = 2; k + 1 < residuals.size(); ++k)
      if (residuals[k] < 1e-3 && residuals[k + 1] > 1e-11) {
        ++quadratic;
        worst = std::max(worst, residuals[k + 1] / (residuals[k] * residuals[k]));
      }
    last = report.iterations;
    system.finish_step(step, state);
    EXPECT_EQ(system.executor().pattern(), revisions) << step;  // made anew where pairs changed, and only there
  }
  EXPECT_GT(press.pairs->count(), 8);
  EXPECT_GT(revisions, 1);
  EXPECT_LT(revisions, kSteps);
  EXPECT_LE(last, 8);
  EXPECT_GT(quadratic, 2);
  EXPECT_LT(worst, 1e4);  // r' ≤ C r²: from 1e-3 on each iteration doubles the digits
  EXPECT_GT(press.pairs->nearest(state), 0.01);
  EXPECT_GT(press.pairs->asked(), 0);
  // Both bodies carry the same force: what the foot holds, the head is held by.
  double foot = 0, head = 0;
  for (const FrameConstraint& c : press.model.constraints) {
    const double f = system.gradient()[at(press.model.points.dofs.begin(c.node)) + 2];
    (press.model.rest_position[at(c.node)][2] < 0.5 ? foot : head) += f;
  }
  EXPECT_GT(foot, 10);
  EXPECT_NEAR(foot, -head, 1e-8 * foot);
}
INSTANTIATE_TEST_SUITE_P(All, PairsOf,
                         testing::Values(std::pair{LinearMethod::cholesky, PreconditionerKind::automatic},
                                         std::pair{LinearMethod::cg, PreconditionerKind::block_jacobi},
                                         std::pair{LinearMethod::cg, PreconditionerKind::multigrid}),
                         [](const auto& solver) { return "solver" + std::to_string(solver.index); });

/// A step that would lead through a pair is cut short where the pair says so.
TEST(Pairs, NoStepGoesThroughOne) {
  Press press;
  ThreadPool pool(1);
  const SolverSettings settings;
  MechanicalSystem system(press.model, pool, settings);
  State state = State::at_rest(press.model);
  press.pairs->find(state, press.below, press.above, 1);
  system.begin_step(state, 0);
  system.set_factors(std::vector<double>{1.0});  // 0.28 in one go, through a gap of 0.2 on one side
  system.evaluate();
  const DirectionReport direction = system.direction();
  ASSERT_TRUE(direction.usable);
  const double part = system.largest_step(1);
  EXPECT_GT(part, 0);
  EXPECT_LT(part, 1);
  EXPECT_EQ(system.largest_step(0.5 * part), 0.5 * part);
  system.apply(part);
  EXPECT_TRUE(std::isfinite(system.evaluate().energy));
  EXPECT_GT(press.pairs->nearest(system.state()), 0);
}

/// A block that is thrown at another one bounces off: in a step of implicit Euler that its velocity would carry through
/// the gap, and in explicit steps, between which pairs come and go.
TEST(Pairs, SlowAThrownBlockInImplicitAndExplicitSteps) {
  double slowed = 0;
  for (const bool is_explicit : {false, true}) {
    Press press;
    press.model.motions.clear();
    std::vector<FrameConstraint>& held = press.model.constraints;
    std::erase_if(held, [](const FrameConstraint& c) { return c.translation_motion[0] >= 0; });
    ThreadPool pool(2);
    SolverSettings settings;
    MechanicalSystem system(press.model, pool, settings);
    State state = State::at_rest(press.model);
    const int first_of_upper = press.above.front();
    // With 45 J; nodes that repel each other let faster ones slip past.
    for (int i = first_of_upper; i < press.model.node_count(); ++i) state.v[at(i)] = {{0, 0, -0.3}};
    const auto look = [&](const StepInfo&, const State& reached, MechanicalSystem&) {
      press.pairs->find(reached, press.below, press.above, 1);
      EXPECT_GT(press.pairs->nearest(reached), 0);
      return true;
    };
    press.pairs->find(state, press.below, press.above, 0.05);  // none yet
    RunReport report;
    if (is_explicit) {
      report = run_explicit(
          system, state, [](double) { return std::vector<double>{}; }, {1e-3, 1500, {}}, look);
    } else {
      press.pairs->find(state, press.below, press.above, 1);
      report = run_implicit(
          system, state, [](double) { return std::vector<double>{}; }, settings, {TimeScheme::newmark, 0.05, 30}, look);
    }
    EXPECT_EQ(report.status, RunStatus::converged) << report.message;
    Vec3d v;
    for (int i = first_of_upper; i < press.model.node_count(); ++i) v += state.v[at(i)];
    // Pairs alone slow it; both integrators are of second order, and the coarse one has 30 steps.
    const double before = -0.3 * (press.model.node_count() - first_of_upper);
    EXPECT_GT(v[2], 0.9 * before) << (is_explicit ? "explicit" : "implicit");
    if (is_explicit) EXPECT_NEAR(v[2] / before, slowed, 0.03);
    slowed = v[2] / before;
    for (const int node : press.above) EXPECT_GT(press.model.rest_position[at(node)][2] + state.u[at(node)][2], 0.8);
  }
}

/// Elements and shells keep where their blocks are in the matrix; with other pairs, these are elsewhere.
TEST(Pairs, LeaveElementsTheirPlacesInTheMatrix) {
  CoupledModel m;
  m.add_tetrahedra({}, {{1, 1, 1}}, {2, 2, 2});
  const auto [first_of_shell, end] = m.add_shell({{0, 0, 1.1}});
  const auto pairs = std::make_shared<Barrier>(m.model.rest_position, 0.5, 4000.0);
  m.points.add_user_block(pairs);
  m.finish();
  const Model& model = m.model;
  std::vector<int> below, above;
  for (int i = 0; i < end; ++i) (i < first_of_shell ? below : above).push_back(i);
  ThreadPool pool(2);
  CpuExecutor executor(model.points, pool);
  std::vector<double> gradient(at(model.dof_count())), x = random_direction(model), y = gradient, free = gradient;
  const State state = random_state(model, 1e-3, 1e-2);
  for (const double within : {0.0, 0.4, 0.2}) {
    pairs->find(state, below, above, within);
    executor.gradient(state, {}, gradient);
    Linearization tangent;
    executor.linearize(state, {}, Tangent::full, tangent);
    executor.multiply(tangent, x, free);
    BlockMatrix matrix(model.points);
    executor.assemble(tangent, matrix);
    matrix.multiply(pool, x, y);
    for (std::size_t i = 0; i < y.size(); ++i) ASSERT_NEAR(y[i], free[i], 1e-10 * norm(free)) << within << " m, " << i;
  }
}

TEST(Pairs, WrongCellsAreRefusedAndNothingChanges) {
  Press press;
  struct Open final : UserBlock {
    Open() : UserBlock(2, {0, 1}, 1) {}
    using UserBlock::set_cells;
    double forces(int, std::span<const CellPose>, std::span<CellForce>) const override { return 0; }
    void product(int, std::span<const CellPose>, Tangent, std::span<const CellMotion>,
                 std::span<CellForce>) const override {}
    double stiffness(int) const override { return 1; }
  } block;
  EXPECT_THROW(block.set_cells({0}), InputError);
  EXPECT_THROW(block.set_cells({0, 0}), InputError);
  EXPECT_THROW(block.set_cells({-1, 0}), InputError);
  EXPECT_EQ(block.count(), 1);
  EXPECT_EQ(block.revision(), 0);
  block.set_cells({0, 1});
  EXPECT_EQ(block.revision(), 0);
  block.set_cells({});
  EXPECT_EQ(block.count(), 0);
  EXPECT_EQ(block.revision(), 1);
}

}  // namespace
}  // namespace fascia::pairs_test
