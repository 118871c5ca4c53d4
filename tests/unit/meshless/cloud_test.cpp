#include "core/base/errors.hpp"
#include "core/structure/inertia.hpp"
#include "meshless/cloud_parts.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <numbers>

/// Bodies of scattered frames and thin grids: what must hold whatever the sampling.
namespace fascia::cloud_test {
namespace {

using namespace test;

/// A curved sheet: the surface of an ellipsoid, 2 cm thick.
CloudSpec shell_spec(const BlockOptions& o, ScatteredKind weights) {
  CloudSpec spec;
  static_cast<BodyMatter&>(spec) = block_spec(o);
  ScatterSpec scatter;
  SheetPart sheet;
  sheet.surface = ellipsoid_surface({}, {{0.5, 0.4, 0.3}}, 12);
  sheet.thickness.assign(sheet.surface.triangles.size(), 0.02);
  scatter.parts.sheets.push_back(sheet);
  scatter.parts.rotation = o.rotation;
  scatter.parts.translation = o.translation;
  scatter.frames = CountedChoice{80, 1};
  scatter.weights = weights;
  std::vector<std::string> messages;
  scatter_cloud(scatter, spec, messages);
  return spec;
}

/// A block with a sheet on one face and a strand on that.
CloudSpec mixed_spec(const BlockOptions& o) {
  CloudSpec spec;
  static_cast<BodyMatter&>(spec) = block_spec(o);
  ScatterSpec scatter;
  scatter.parts.solid = block_spec(o).domain;
  scatter.parts.solid->surface = box_surface({}, o.size, 4, 4, 4);
  SheetPart sheet;
  sheet.surface.points = {{{1, 0, 0.5}}, {{2, 0, 0.5}}, {{2, 1, 0.5}}, {{1, 1, 0.5}}};
  sheet.surface.triangles = {{0, 1, 2}, {0, 2, 3}};
  sheet.thickness = {0.05, 0.05};
  scatter.parts.sheets.push_back(sheet);
  scatter.parts.lines.push_back({{{{2, 0.5, 0.5}}, {{3, 0.5, 0.5}}}, {{0, 1}}, 0.03});
  scatter.frames = SpacedChoice{0.34, 1};
  std::vector<std::string> messages;
  scatter_cloud(scatter, spec, messages);
  return spec;
}

struct Case {
  std::string name;
  std::function<CloudSpec(const BlockOptions&)> spec;
  bool linear = true;  ///< linear fields are reproduced
  double volume = 1;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

std::vector<Case> cases() {
  const auto scattered = [](ScatteredKind kind) {
    return [kind](const BlockOptions& o) { return scattered_spec(o, 0.34, 1, kind); };
  };
  const auto thin = [](const std::vector<int>& grid) {
    return [grid](const BlockOptions& o) { return thin_spec(grid, o); };
  };
  const auto shell = [](const BlockOptions& o) { return shell_spec(o, ScatteredKind::mls); };
  double shell_area = 0;
  const TriangleMesh mesh = ellipsoid_surface({}, {{0.5, 0.4, 0.3}}, 12);
  for (const auto& t : mesh.triangles) {
    const auto p = [&](int k) { return mesh.points[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])]; };
    shell_area += 0.5 * norm(cross(p(1) - p(0), p(2) - p(0)));
  }
  const double disc = std::numbers::pi * 1e-4;
  return {{"rectangle", thin({5, 4}), true, 0.02},
          {"line", thin({6}), true, disc},
          {"scattered", scattered(ScatteredKind::mls)},
          {"shepard", scattered(ScatteredKind::shepard), false},
          {"wendland", scattered(ScatteredKind::wendland), false},
          {"spline", scattered(ScatteredKind::cubic_spline), false},
          {"shell", shell, false, 0.02 * shell_area},
          {"mixture", mixed_spec, false, 1.05 + std::numbers::pi * 9e-4}};
}

class Cloud : public testing::TestWithParam<Case> {
 protected:
  BuiltModel built(BlockOptions o = {}) const {
    o.half_blend = GetParam().name != "shepard" && GetParam().name != "wendland" && GetParam().name != "spline";
    return build_cloud(GetParam().spec(o));
  }
  static Mat3d gradient(const Attachment& a, const std::vector<Vec3d>& u, const std::vector<Mat3d>& D) {
    Mat3d H;
    for (std::size_t k = 0; k < a.nodes.size(); ++k)
      H += outer(u[static_cast<std::size_t>(a.nodes[k])], a.influences[k].g) +
           D[static_cast<std::size_t>(a.nodes[k])] * a.influences[k].B;
    return H;
  }
};

TEST_P(Cloud, IsAtRestWithoutStrainAndVolumesAddUp) {
  const BuiltModel b = built();
  const CloudBody& body = b.clouds[0];
  double volume = 0;
  for (std::size_t q = 0; q < body.points().size(); ++q) {
    const Attachment a = body.attach_point(q);
    Mat3d F;
    Vec3d x;
    double sum = 0;
    for (std::size_t k = 0; k < a.nodes.size(); ++k) {
      const Vec3d& X = b.model.rest_position[static_cast<std::size_t>(a.nodes[k])];
      F += outer(X, a.influences[k].g) + a.influences[k].B;
      x += X * a.influences[k].w + a.influences[k].b;
      sum += a.influences[k].w;
    }
    EXPECT_LT(norm(F - Mat3d::identity()), 1e-12);
    EXPECT_LT(norm(x - body.points()[q].X), 1e-13);
    EXPECT_NEAR(sum, 1, 1e-13);
    volume += body.points()[q].volume;
  }
  EXPECT_NEAR(volume, GetParam().volume, 1e-12 * volume);
}

TEST_P(Cloud, RigidMotionHasNoEnergyAndItsExactMomentum) {
  const BuiltModel b = built();
  ThreadPool pool(1);
  CpuExecutor executor(b.model.points, pool);
  std::vector<double> unused(static_cast<std::size_t>(b.model.dof_count()));
  const State turned = rigid_state(b.model, rotation_increment({{0.7, -1.1, 2.0}}), {{1, 2, 3}});
  EXPECT_LT(executor.gradient(turned, {}, unused).total(), 1e-24 * 1e4 * GetParam().volume);

  Momentum momentum;
  const Vec3d spin{{0.3, 0.5, -0.2}}, velocity{{1, 0.5, 2}};
  for (std::size_t i = 0; i < b.model.inertia.size(); ++i) {
    const Momentum m = momentum_of(b.model.inertia[i], b.model.rest_position[i], Mat3d::identity(),
                                   velocity + cross(spin, b.model.rest_position[i]), skew(spin), {});
    momentum.kinetic_energy += m.kinetic_energy;
    momentum.linear += m.linear;
    momentum.angular += m.angular;
    EXPECT_GT(b.model.inertia[i].mass, 0);
  }
  double energy = 0;
  Vec3d linear, angular;
  for (const BodyPoint& p : b.clouds[0].points()) {
    const Vec3d v = velocity + cross(spin, p.X);
    energy += 0.5 * 1000 * p.volume * squared_norm(v);
    linear += v * (1000 * p.volume);
    angular += cross(p.X, v) * (1000 * p.volume);
  }
  EXPECT_NEAR(momentum.kinetic_energy, energy, 1e-12 * energy);
  EXPECT_LT(norm(momentum.linear - linear), 1e-12 * norm(linear));
  EXPECT_LT(norm(momentum.angular - angular), 1e-12 * norm(angular));
}

TEST_P(Cloud, LinearFieldsGiveTheirGradientAlongTheMatter) {
  if (!GetParam().linear) return;  // not reproduced by these weights or on curved or mixed matter
  const BuiltModel b = built();
  const Mat3d H = Mat3d::from_columns({{0.01, 0.02, -0.01}}, {{0.03, -0.02, 0.01}}, {{0, 0.01, 0.02}});
  std::vector<Vec3d> u;
  for (const Vec3d& X : b.model.rest_position) u.push_back(H * X);
  const std::vector<Mat3d> still(u.size());
  double worst = 0;
  for (std::size_t q = 0; q < b.clouds[0].points().size(); ++q) {
    const BodyPoint& p = b.clouds[0].points()[q];
    const Mat3d difference = gradient(b.clouds[0].attach_point(q), u, still) - H;
    const Mat3d axes = p.axes < 0 ? Mat3d::identity() : b.clouds[0].axes()[static_cast<std::size_t>(p.axes)];
    const int tangents = p.law == Law::sheet ? 2 : p.law == Law::line ? 1 : 3;
    for (int a = 0; a < tangents; ++a) worst = std::max(worst, norm(difference * axes.column(a)));
  }
  std::printf("%-10s F of a linear field: %.1e off\n", GetParam().name.c_str(), worst);
  EXPECT_LT(worst, 1e-10 * norm(H));
}

TEST_P(Cloud, EnergyDoesNotDependOnPlacement) {
  if (GetParam().name == "mixture") return;  // built without a placement
  const BuiltModel here = built();
  BlockOptions o;
  o.rotation = rotation_about(normalized(Vec3d{{1, -2, 0.5}}), 1.3);
  o.translation = {{3, -1, 2}};
  const BuiltModel there = built(o);
  ASSERT_EQ(here.model.node_count(), there.model.node_count());
  const State state = random_state(here.model, 0.005, 0.1);
  State moved = State::at_rest(there.model);
  for (std::size_t i = 0; i < state.u.size(); ++i) {
    moved.u[i] = o.rotation * state.u[i];
    moved.D[i] = times_transpose(o.rotation * state.D[i], o.rotation);
  }
  ThreadPool pool(1);
  std::vector<double> unused(static_cast<std::size_t>(here.model.dof_count()));
  const double a = CpuExecutor(here.model.points, pool).gradient(state, {}, unused).total();
  const double b = CpuExecutor(there.model.points, pool).gradient(moved, {}, unused).total();
  EXPECT_NEAR(a, b, 1e-10 * a);
}

TEST_P(Cloud, EnergyDoesNotDependOnTheFramesNumbers) {
  if (GetParam().name == "rectangle" || GetParam().name == "line") return;  // a grid has one numbering
  BlockOptions o;
  CloudSpec spec = GetParam().spec(o);
  const BuiltModel plain = build_cloud(spec);
  if (GetParam().name != "scattered") return;  // one kind of weights is enough
  ScatterSpec listed;
  listed.parts.solid = block_spec(o).domain;
  listed.parts.solid->surface = box_surface({}, o.size, 8, 8, 8);
  ListedChoice backward, points;
  for (const CloudFrame& f : spec.frames) backward.position.push_back(f.x);
  std::reverse(backward.position.begin(), backward.position.end());
  for (const CloudPoint& p : spec.points) {
    points.position.push_back(p.place.X);
    points.volume.push_back(p.volume);
  }
  listed.frames = backward;
  listed.points = points;
  CloudSpec other;
  static_cast<BodyMatter&>(other) = block_spec(o);
  std::vector<std::string> messages;
  scatter_cloud(listed, other, messages);
  const BuiltModel reversed = build_cloud(other);
  const State state = random_state(plain.model, 0.01, 0.1);
  State mirrored = state;
  std::reverse(mirrored.u.begin(), mirrored.u.end());
  std::reverse(mirrored.D.begin(), mirrored.D.end());
  ThreadPool pool(1);
  std::vector<double> unused(static_cast<std::size_t>(plain.model.dof_count()));
  const double a = CpuExecutor(plain.model.points, pool).gradient(state, {}, unused).total();
  const double b = CpuExecutor(reversed.model.points, pool).gradient(mirrored, {}, unused).total();
  EXPECT_NEAR(a, b, 1e-10 * a);
}

TEST_P(Cloud, AnyPositionIsAttachedAsItsPointIs) {
  const BuiltModel b = built();
  const CloudBody& body = b.clouds[0];
  const State state = random_state(b.model, 0.01, 0.1);
  double worst = 0;
  for (std::size_t q = 0; q < body.points().size(); ++q) {
    const auto moved = [&](const Attachment& a) {
      Vec3d u;
      for (std::size_t k = 0; k < a.nodes.size(); ++k)
        u += state.u[static_cast<std::size_t>(a.nodes[k])] * a.influences[k].w +
             state.D[static_cast<std::size_t>(a.nodes[k])] * a.influences[k].b;
      return u;
    };
    EXPECT_LT(body.distance(body.points()[q].X), 1e-9);
    worst = std::max(worst, norm(moved(body.attach_point(q)) - moved(body.attach(body.points()[q].X))));
  }
  EXPECT_LT(worst, GetParam().name == "shell" || GetParam().name == "mixture" ? 1e-3 : 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Kinds, Cloud, testing::ValuesIn(cases()),
                         [](const auto& parameter) { return parameter.param.name; });

TEST(CloudErrors, AreNamedBeforeAnythingIsBuilt) {
  const auto message_of = [](const std::function<void(ScatterSpec&)>& change) {
    ScatterSpec scatter;
    scatter.parts.solid = block_spec({}).domain;
    scatter.parts.solid->surface = box_surface({}, {{1, 1, 1}}, 2, 2, 2);
    scatter.frames = SpacedChoice{0.5, 1};
    change(scatter);
    CloudSpec spec;
    static_cast<BodyMatter&>(spec) = block_spec({});
    std::vector<std::string> messages;
    try {
      scatter_cloud(scatter, spec, messages);
      build_cloud(spec);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(message_of([](ScatterSpec& s) {
              s.frames = ListedChoice{{{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}, {{1, 0, 0}}}, {}, {}};
            }).find("frames 1 and 4 coincide at (1, 0, 0)"),
            std::string::npos);
  EXPECT_NE(message_of([](ScatterSpec& s) {
              s.frames = ListedChoice{{{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}}, {}, {}};
            }).find("use at least 4"),
            std::string::npos);
  EXPECT_NE(message_of([](ScatterSpec& s) { s.support = 0.05; }).find("out of reach of every frame"),
            std::string::npos);
  EXPECT_NE(message_of([](ScatterSpec& s) {
              s.frames = SpacedChoice{0.25, 1};
              s.support = 1.0;
            }).find("frames reach one point"),
            std::string::npos);
}

/// Frames 0.2 apart, and points 0.08: a slab and a rod as thin as a point's spacing are told of, those several points
/// thick are not.
TEST(CloudMessages, TellOfASolidWhosePointsLieInALayer) {
  const auto told = [](const Vec3d& size) {
    ScatterSpec scatter;
    scatter.parts.solid = SolidDomain{{}, size, size[0] * size[1] * size[2], {}, {}, {}, {}};
    scatter.parts.solid->surface = box_surface({}, size, 4, 4, 4);
    scatter.frames = SpacedChoice{0.2, 1};
    CloudSpec spec;
    static_cast<BodyMatter&>(spec) = block_spec({});
    std::vector<std::string> messages;
    scatter_cloud(scatter, spec, messages);
    return std::any_of(messages.begin(), messages.end(), [](const std::string& message) {
      return message.find("lie in a layer or two") != std::string::npos;
    });
  };
  EXPECT_TRUE(told({{2, 2, 0.08}}));
  EXPECT_TRUE(told({{4, 0.1, 0.1}}));
  EXPECT_FALSE(told({{2, 2, 0.3}}));
  EXPECT_FALSE(told({{2, 0.3, 0.3}}));
  EXPECT_FALSE(told({{1, 1, 1}}));
}

TEST(CloudErrors, ASheetThickerThanItIsCurvedIsRefused) {
  ScatterSpec scatter;
  SheetPart sheet;
  sheet.surface = ellipsoid_surface({}, {{0.01, 0.01, 0.01}}, 12);
  sheet.thickness.assign(sheet.surface.triangles.size(), 0.02);
  scatter.parts.sheets.push_back(sheet);
  scatter.frames = CountedChoice{80, 1};
  CloudSpec spec;
  static_cast<BodyMatter&>(spec) = block_spec({});
  std::vector<std::string> messages;
  EXPECT_THROW(scatter_cloud(scatter, spec, messages), InputError);
}

}  // namespace
}  // namespace fascia::cloud_test
