#include "core/step/surfaces.hpp"

#include "core/body/body_surface.hpp"
#include "core/node/node_force.hpp"
#include "tests/unit/fem/surface_models.hpp"
#include "tests/unit/gpu/host_model.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <memory>

/// Surface loads in the spaces of the host: forces against plain sums, tangents against one another. Derivatives are
/// held in tests/unit/fem/surface_load_test.cpp.
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

/// Forces as the formulas say them, one share after the other. @return  the potential
double plain_forces(const Model& model, const State& state, const std::vector<double>& factors,
                    std::vector<SurfaceForces>& forces, std::vector<double>& out) {
  double energy = 0;
  forces.resize(model.surfaces.size());
  for (std::size_t s = 0; s < forces.size(); ++s) {
    const SurfaceLoad& load = model.surfaces[s];
    evaluate(load, state, factors, forces[s]);
    energy += forces[s].energy;
    for (int v = 0; v < load.vertex_count(); ++v)
      for (const SurfaceShare& share : load.shares_of(v)) {
        const Vec3d& f = forces[s].force[at(v)];
        add_node_force(model.kind(share.node), state.D[at(share.node)], f * share.w, outer(f, share.b), {},
                       out.data() + model.points.dofs.begin(share.node));
      }
  }
  return energy;
}

class SurfacesTest : public testing::TestWithParam<Case> {
 protected:
  SurfacesTest()
      : built_(make()),
        host_(built_.model, random_state(built_.model, 0.06, 0.4)),
        pooled_(built_.model, PoolSpace(pool_)),
        own_(built_.model) {}
  static Loaded make() {
    Loaded built = GetParam().build();
    add_loads(built);
    return built;
  }

  std::vector<double> zeros() const { return std::vector<double>(at(built_.model.dof_count())); }
  template <class Surfaces>
  static std::vector<double> figures(const Surfaces& s) {
    return {s.figures(), s.figures() + s.figure_count()};
  }
  template <class Surfaces>
  std::vector<double> forces(Surfaces& surfaces, const HostModel& at_pose) {
    std::vector<double> load = zeros();
    surfaces.add_forces(host_.nodes(), at_pose.pose(), factors_.data(), load.data());
    return load;
  }
  /// All that a tangent gives, one after the other: blocks, volumes, products at another pose since.
  template <class Space>
  std::vector<double> tangent(Surfaces<Space>& surfaces, Tangent kind) {
    std::vector<double> all(built_.model.points.dofs.block_total()), y = zeros();
    SurfaceTangent<Space> tangent;
    forces(surfaces, host_);
    surfaces.linearize(host_.nodes(), host_.Q(), factors_.data(), kind, tangent, all.data());
    forces(surfaces, rest_);
    const std::vector<double> d = random_direction(built_.model);
    for (const TangentPart part : {TangentPart::symmetric, TangentPart::antisymmetric})
      surfaces.add_product(tangent, host_.nodes(), host_.Q(), d.data(), y.data(), part);
    all.insert(all.end(), y.begin(), y.end());
    y = zeros();
    surfaces.add_volume_product(tangent, d.data(), y.data());
    all.insert(all.end(), y.begin(), y.end());
    all.insert(all.end(), tangent.g.data(), tangent.g.data() + tangent.g.size());
    return all;
  }
  void expect_same_tangents() {
    for (const Tangent kind : {Tangent::full, Tangent::material})
      expect_near(tangent(own_, kind), tangent(pooled_, kind), "tangent");
  }
  /// An iteration of Newton's method that goes a part of the way, after a line search went back.
  template <class Space>
  void iterate(Surfaces<Space>& surfaces, bool back, const std::vector<double>& d) {
    std::vector<double> blocks(built_.model.points.dofs.block_total());
    SurfaceTangent<Space> tangent;
    forces(surfaces, host_);
    surfaces.linearize(host_.nodes(), host_.Q(), factors_.data(), Tangent::full, tangent, blocks.data());
    surfaces.aim(tangent, d.data());
    surfaces.save();
    surfaces.approach(1);
    if (back) surfaces.restore();
    surfaces.approach(0.4);
  }

  Loaded built_;
  ThreadPool pool_{3};
  HostModel host_, rest_{built_.model, State::at_rest(built_.model)};
  Surfaces<PoolSpace> pooled_;
  Surfaces<HostSpace> own_;
  std::vector<double> factors_{0.7, 0.9};
};

TEST_P(SurfacesTest, Forces) {
  std::vector<SurfaceForces> plain;
  std::vector<double> expected = zeros();
  const double energy = plain_forces(built_.model, host_.state(), factors_, plain, expected);
  const auto check = [&](auto& surfaces) {
    expect_near(forces(surfaces, host_), expected, "forces");
    const std::vector<double> own = figures(surfaces);
    EXPECT_NEAR(surfaces.potential(own), energy, 1e-12 * std::abs(energy));
    double squared = 0;
    for (std::size_t s = 0; s < plain.size(); ++s) {
      const SurfaceForces& f = plain[s];
      const double* figure = own.data() + s * kSurfaceFigures;
      EXPECT_NEAR(figure[kVolumeInside], f.volume, 1e-13 * std::abs(f.volume));
      EXPECT_NEAR(figure[kPressure], f.pressure, 1e-12 * std::abs(f.pressure));
      EXPECT_NEAR(figure[kStiffness], f.stiffness, 1e-13 * f.stiffness);
      squared += f.rounding * f.rounding;
    }
    EXPECT_GT(squared, 0);
    EXPECT_NEAR(surfaces.rounding(0, own), std::sqrt(squared), 1e-12 * std::sqrt(squared));
  };
  check(own_);
  check(pooled_);
}

TEST_P(SurfacesTest, Tangents) { expect_same_tangents(); }

/// Newton's pressures of two steps, with a line search that goes back once: the tangents show them.
TEST_P(SurfacesTest, PressuresOfNewton) {
  for (int step = 0; step < 2; ++step) {
    own_.begin_step();
    pooled_.begin_step();
    for (int iteration = 0; iteration < 2; ++iteration) {
      std::vector<double> d = random_direction(built_.model, static_cast<unsigned>(3 + iteration));
      for (double& v : d) v *= 0.01;
      iterate(own_, iteration == 0, d);
      iterate(pooled_, iteration == 0, d);
      expect_near(own_.followed(), pooled_.followed(), "pressures");
      expect_same_tangents();
    }
    own_.finish_step();
    pooled_.finish_step();
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
  Surfaces<HostSpace> none(built.model);
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(none.terms(), 0);
  EXPECT_EQ(none.potential({}), 0);
}

}  // namespace
}  // namespace fascia::surfaces_test
