#include "tests/unit/app/scene_text.hpp"

#include <gtest/gtest.h>

#include <numbers>

// Keys of shells as they are read.
namespace fascia::app::shells_test {
namespace {

using test::shell_body;

constexpr double pi = std::numbers::pi;

Body body_of(std::string_view domain, std::string_view more = "thickness = \"2 mm\"\n") {
  return test::parse(shell_body(domain, more)).bodies.at(0);
}

TEST(Shells, RectangleWithCells) {
  const Body body =
      body_of("rectangle = { origin = [0, 0, 0], edge_u = [2, 0, 0], edge_v = [0, 1, 0], cells = [4, 2] }");
  EXPECT_EQ(body.model, BodyModel::shell);
  EXPECT_TRUE(is_shell(body));
  EXPECT_FALSE(is_mesh_model(body));
  EXPECT_TRUE(std::holds_alternative<RectangleDomain>(body.domain));
  EXPECT_EQ(body.cells->count, (std::vector<int>{4, 2}));
  EXPECT_EQ(body.cells->diagonal, CellDiagonal::right);
  ASSERT_EQ(body.thickness.size(), 1u);
  EXPECT_DOUBLE_EQ(body.thickness[0].value, 0.002);
  EXPECT_EQ(body.mass, 1);
}

TEST(Shells, WholeCylinder) {
  const Body body = body_of("cylinder = { from = [0, 0, 0], to = [0, 0, 3], radius = 1, cells = [3, 7] }");
  const auto& cylinder = std::get<CylinderDomain>(body.domain);
  EXPECT_TRUE(cylinder.closed);
  EXPECT_TRUE(cylinder.caps);
  EXPECT_EQ(cylinder.angle, (std::array<double, 2>{0, 2 * pi}));
  EXPECT_EQ(body.cells->count, (std::vector<int>{3, 7}));
}

TEST(Shells, CylinderWithEveryKey) {
  const auto cylinder = [](const std::string& more) {
    const Body body =
        body_of("cylinder = { from = [0, 0, 0], to = [0, 0, 3], radius = 1, cells = [3, 8], " + more + " }");
    return std::get<CylinderDomain>(body.domain);
  };
  const CylinderDomain sector = cylinder("angle = [\"-30 degree\", \"0.5 rad\"]");
  EXPECT_DOUBLE_EQ(sector.angle[0], -pi / 6);
  EXPECT_DOUBLE_EQ(sector.angle[1], 0.5);
  EXPECT_FALSE(sector.closed);
  EXPECT_FALSE(sector.caps);
  const CylinderDomain turned = cylinder("angle = [\"90 degree\", \"450 degree\"], caps = false");
  EXPECT_TRUE(turned.closed);
  EXPECT_FALSE(turned.caps);
  const CylinderDomain slit = cylinder("closed = false");
  EXPECT_FALSE(slit.closed);
  EXPECT_FALSE(slit.caps);
  EXPECT_DOUBLE_EQ(slit.angle[1], 2 * pi);
}

TEST(Shells, Annulus) {
  const auto body = [](const std::string& more) {
    return body_of("annulus = { center = [0, 0, 1], normal = [0, 0, 2], inner = 6, outer = 10, cells = [6, 30]" + more +
                   " }");
  };
  const Body whole = body(", diagonal = \"alternating\"");
  const auto& annulus = std::get<AnnulusDomain>(whole.domain);
  EXPECT_TRUE(annulus.closed);
  EXPECT_EQ(annulus.inner, 6);
  EXPECT_EQ(annulus.outer, 10);
  EXPECT_EQ(annulus.normal, (Vec3d{{0, 0, 2}}));
  EXPECT_EQ(whole.cells->diagonal, CellDiagonal::alternating);
  const Body slit = body(", angle = [\"0 degree\", \"360 degree\"], closed = false, diagonal = \"left\"");
  EXPECT_FALSE(std::get<AnnulusDomain>(slit.domain).closed);
  EXPECT_EQ(slit.cells->diagonal, CellDiagonal::left);
}

TEST(Shells, Round) {
  const Body ball = body_of("sphere = { center = [1, 2, 3], radius = \"5 cm\", cells = [16] }");
  EXPECT_EQ(std::get<EllipsoidDomain>(ball.domain).radii, (Vec3d{{0.05, 0.05, 0.05}}));
  EXPECT_EQ(ball.cells->count, std::vector<int>{16});
  EXPECT_EQ(body_of("ellipsoid = { center = [1, 2, 3], radii = [1, 2, 3], cells = [8] }").cells->count,
            std::vector<int>{8});
}

TEST(Shells, SpheresAreSolidsToo) {
  const Body solid =
      test::parse(test::mesh_body("tetrahedra", "sphere = { center = [1, 2, 3], radius = 2, cells = [8, 2] }"))
          .bodies[0];
  EXPECT_EQ(std::get<EllipsoidDomain>(solid.domain).radii, (Vec3d{{2, 2, 2}}));
  EXPECT_EQ(solid.cells->count, (std::vector<int>{8, 2}));
  const Body frames = test::parse(test::beam_with("box = { min = [0, 0, 0], max = [4, 1, 1] }",
                                                  "sphere = { center = [1, 2, 3], radius = 2 }"))
                          .bodies[0];
  EXPECT_EQ(std::get<EllipsoidDomain>(frames.domain).center, (Vec3d{{1, 2, 3}}));
}

TEST(Shells, FilesAndLists) {
  const Body body = body_of("file = \"skin.stl\"",
                            "thickness = [{ where = { group = \"hilum\" }, value = 0.002 }, { value = 0.001 }]\n"
                            "transform = { scale = 0.001 }\ninitial = { velocity = [1, 0, 0] }\n");
  EXPECT_FALSE(body.cells);
  ASSERT_EQ(body.thickness.size(), 2u);
  EXPECT_EQ(std::get<GroupRegion>(body.thickness[0].where.shape).name, "hilum");
  EXPECT_EQ(body.thickness[1].value, 0.001);
  EXPECT_EQ(body.transform.scale, 0.001);
  EXPECT_EQ(body.initial.velocity[0], 1);
}

}  // namespace
}  // namespace fascia::app::shells_test
