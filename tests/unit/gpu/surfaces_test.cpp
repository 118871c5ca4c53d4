#include "gpu/actions/surfaces.hpp"
#include "assembly/actions/actions.hpp"

#include "core/body/body_surface.hpp"
#include "core/solver/surface_loads.hpp"
#include "tests/unit/fem/surface_models.hpp"
#include "tests/unit/gpu/host_model.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <memory>

/// Surface loads in a space against those of the solver.
namespace fascia::surfaces_test {
namespace {

using namespace test;

/// A closed surface that is full of something heavy, one that is only pressed on, one with a hole, and a second volume.
void add_loads(Loaded& built) {
  std::vector<BodyFace> faces = built.body->faces();
  SurfaceLoad full = surface_of(*built.body, faces);
  full.pressure = 800;
  full.bulk_modulus = 5e4;
  full.volume = 1.3 * full.rest_volume;
  full.weight = {{300, -2000, 500}};
  full.weight_schedule = 1;
  SurfaceLoad pressed = surface_of(*built.body, faces), other = full;
  pressed.pressure = -300;
  other.bulk_modulus = 2e3;
  other.weight = {};
  other.schedule = 1;
  faces.pop_back();
  SurfaceLoad open = surface_of(*built.body, faces);
  open.pressure = 450;
  built.model.surfaces = {full, pressed, open, other};
}

struct Case {
  std::string name;
  std::function<Loaded()> build;
};

class SurfacesTest : public testing::TestWithParam<Case> {
 protected:
  using Own = gpu::Surfaces<HostSpace>;
  SurfacesTest()
      : built_(make()),
        executor_(built_.model.points, pool_),
        host_(built_.model, random_state(built_.model, 0.06, 0.4)),
        cpu_(built_.model),
        own_(built_.model) {}
  static Loaded make() {
    Loaded built = GetParam().build();
    add_loads(built);
    return built;
  }

  const State& state() const { return host_.state(); }
  std::vector<double> zeros() const { return std::vector<double>(at(built_.model.dof_count())); }
  std::vector<double> figures() const { return {own_.figures(), own_.figures() + own_.figure_count()}; }
  double evaluate(std::vector<double>& expected, std::vector<double>& load) {
    own_.add_forces(host_.nodes(), host_.pose(), factors_.data(), load.data());
    return cpu_.add_forces(state(), factors_, expected);
  }
  /// Of the loads alone.
  Linearization linearize(Tangent tangent) {
    std::vector<double> unused = zeros();
    Linearization lin;
    executor_.gradient(state(), {}, unused);
    executor_.linearize(state(), {}, tangent, lin);
    std::fill(lin.node_blocks.begin(), lin.node_blocks.end(), 0.0);
    cpu_.linearize(state(), factors_, lin);
    return lin;
  }
  void expect_same_tangent(Tangent tangent) {
    const Linearization lin = linearize(tangent);
    std::vector<double> blocks(lin.node_blocks.size());
    own_.linearize(host_.nodes(), host_.Q(), factors_.data(), tangent, blocks.data());
    if (tangent == Tangent::full && built_.model.frame_kind[0] == FrameKind::rigid)
      expect_near(blocks, lin.node_blocks, "node blocks");
    else
      EXPECT_EQ(blocks, lin.node_blocks);
    ASSERT_EQ(at(own_.terms()), lin.low_rank.size());
    for (int t = 0; t < own_.terms(); ++t)
      expect_near(std::vector<double>(own_.volume_gradient(t), own_.volume_gradient(t) + built_.model.dof_count()),
                  lin.low_rank[at(t)].g, "volume gradient");
    // At another pose since, the products are those of the linearisation.
    std::vector<double> unused = zeros(), expected = zeros(), y = zeros();
    own_.add_forces(host_.nodes(), rest_.pose(), factors_.data(), unused.data());
    const std::vector<double> d = random_direction(built_.model);
    for (const SurfaceTangent& term : lin.surfaces) add_product(term, built_.model.points.dofs, lin.Q, d, expected);
    own_.add_product(host_.nodes(), host_.Q(), host_.direction(d), y.data());
    expect_near(y, expected, "product");
    expected = y = zeros();
    for (const RankOne& term : lin.low_rank) add_product(term, d, expected);
    own_.add_volume_product(d.data(), y.data());
    expect_near(y, expected, "volumes");
  }

  Loaded built_;
  ThreadPool pool_{1};
  CpuExecutor executor_;
  HostModel host_, rest_{built_.model, State::at_rest(built_.model)};
  SurfaceLoads cpu_;
  Own own_;
  std::vector<double> factors_{0.7, 0.9};
};

TEST_P(SurfacesTest, Forces) {
  std::vector<double> expected = zeros(), load = zeros();
  const double energy = evaluate(expected, load);
  expect_near(load, expected, "forces");
  EXPECT_NEAR(own_.potential(figures()), energy, 1e-12 * std::abs(energy));
  for (int part = 0; part < built_.model.points.part_count(); ++part)
    EXPECT_NEAR(own_.rounding(part, figures()), cpu_.rounding(part), 1e-12 * cpu_.rounding(part));
  EXPECT_GT(cpu_.rounding(0), 0);
  const std::vector<double> own = figures();
  for (std::size_t s = 0; s < built_.model.surfaces.size(); ++s) {
    const SurfaceForces& f = cpu_.forces(s);
    const double* figure = own.data() + s * gpu::kSurfaceFigures;
    EXPECT_NEAR(figure[gpu::kVolumeInside], f.volume, 1e-13 * std::abs(f.volume));
    EXPECT_NEAR(figure[gpu::kPressure], f.pressure, 1e-12 * std::abs(f.pressure));
    EXPECT_NEAR(figure[gpu::kStiffness], f.stiffness, 1e-13 * f.stiffness);
  }
}

TEST_P(SurfacesTest, Tangents) {
  for (const Tangent tangent : {Tangent::full, Tangent::material}) {
    std::vector<double> unused = zeros(), other = zeros();
    evaluate(unused, other);
    expect_same_tangent(tangent);
  }
}

/// Newton's pressures of two steps, with a line search that goes back once: the products show them.
TEST_P(SurfacesTest, PressuresOfNewton) {
  for (int step = 0; step < 2; ++step) {
    cpu_.begin_step();
    own_.begin_step();
    for (int iteration = 0; iteration < 2; ++iteration) {
      std::vector<double> unused = zeros(), other = zeros();
      evaluate(unused, other);
      const Linearization lin = linearize(Tangent::full);
      std::vector<double> blocks(lin.node_blocks.size());
      own_.linearize(host_.nodes(), host_.Q(), factors_.data(), Tangent::full, blocks.data());
      std::vector<double> d = random_direction(built_.model, static_cast<unsigned>(3 + iteration));
      for (double& v : d) v *= 0.01;
      cpu_.aim(lin, d);
      own_.aim(d.data());
      cpu_.save();
      own_.save();
      cpu_.approach(1);
      own_.approach(1);
      if (iteration == 0) {
        cpu_.restore();
        own_.restore();
      }
      cpu_.approach(0.4);
      own_.approach(0.4);
      expect_same_tangent(Tangent::full);
    }
    cpu_.finish_step();
    own_.finish_step();
  }
}

std::vector<Case> cases() {
  return {{"tet4", [] { return elements(ElementShape::tet4); }},
          {"tet10", [] { return elements(ElementShape::tet10); }},
          {"hex8", [] { return elements(ElementShape::hex8); }},
          {"hex20", [] { return elements(ElementShape::hex20); }},
          {"rigid_frames", [] { return frames(false, {6, 5, 5}); }},
          {"affine_frames", [] { return frames(true, {6, 5, 5}); }}};
}

INSTANTIATE_TEST_SUITE_P(, SurfacesTest, testing::ValuesIn(cases()),
                         [](const auto& parameter) { return parameter.param.name; });

TEST(Surfaces, AreNone) {
  const Loaded built = elements(ElementShape::hex8);
  gpu::Surfaces<HostSpace> none(built.model);
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(none.terms(), 0);
  EXPECT_EQ(none.potential({}), 0);
}

}  // namespace
}  // namespace fascia::surfaces_test
