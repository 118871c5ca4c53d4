#include "tests/unit/app/scene_text.hpp"

#include <gtest/gtest.h>

// What the reader makes of tetrahedra, hexahedra and their materials.
namespace fascia::app::elements_test {
namespace {

using test::mesh_body;
using test::meshed_box;

Body body_of(std::string_view model, std::string_view domain, std::string_view more = "") {
  return test::parse(mesh_body(model, domain, more)).bodies.at(0);
}

TEST(Elements, DefaultsAreThoseOfTheManual) {
  const Body body = body_of("tetrahedra", meshed_box);
  EXPECT_EQ(body.model, BodyModel::tetrahedra);
  EXPECT_TRUE(is_mesh_model(body));
  EXPECT_EQ(body.formulation, Formulation::large_strain);
  EXPECT_EQ(body.order, 1);
  EXPECT_EQ(body.incompressibility, 0);
  EXPECT_EQ(body.locking, Locking::automatic);
  ASSERT_TRUE(body.cells);
  EXPECT_EQ(body.cells->count, (std::vector{8, 2, 2}));
  EXPECT_EQ(body.cells->split, 6);
  EXPECT_EQ(body.mass, 1.0);
  EXPECT_EQ(body.materials.at(0).material.law, Law::st_venant_kirchhoff);
}

TEST(Elements, MeshlessBodiesKeepTheirModel) {
  const Body body = test::parse(test::beam).bodies.at(0);
  EXPECT_EQ(body.model, BodyModel::meshless);
  EXPECT_FALSE(is_mesh_model(body));
  EXPECT_FALSE(body.cells);
}

TEST(Elements, ReadsTheKeysOfTetrahedra) {
  const Body body = body_of("tetrahedra", meshed_box,
                            "formulation = \"corotational\"\norder = 2\nincompressibility = \"2 kPa\"\n"
                            "locking = \"none\"\ninitial = { velocity = [1, 0, 0] }\ntransform = { scale = 2 }\n");
  EXPECT_EQ(body.formulation, Formulation::corotational);
  EXPECT_EQ(body.order, 2);
  EXPECT_EQ(body.incompressibility, 2000);
  EXPECT_EQ(body.locking, Locking::none);
  EXPECT_EQ(body.initial.velocity[0], 1);
  EXPECT_EQ(body.transform.scale, 2);
  EXPECT_EQ(body_of("tetrahedra", meshed_box, "locking = \"f-bar\"\n").locking, Locking::f_bar);
  EXPECT_EQ(body_of("tetrahedra", meshed_box, "formulation = \"st-venant-kirchhoff\"\n").formulation,
            Formulation::large_strain);
  EXPECT_EQ(body_of("tetrahedra", meshed_box, "incompressibility = 0\n").incompressibility, 0);
}

TEST(Elements, ReadsHexahedra) {
  const Body body = body_of("hexahedra", meshed_box, "formulation = \"linear\"\norder = 2\n");
  EXPECT_EQ(body.model, BodyModel::hexahedra);
  EXPECT_EQ(body.formulation, Formulation::linear);
  EXPECT_EQ(body.order, 2);
}

TEST(Elements, PlacesPointAtTheText) {
  const Body body = body_of("tetrahedra", meshed_box,
                            "formulation = \"linear\"\norder = 2\nincompressibility = 1\nlocking = \"none\"\n");
  EXPECT_EQ(body.cells_place.key, "bodies.block.domain.box.cells");
  EXPECT_EQ(body.cells_place.column, 62);
  EXPECT_EQ(body.formulation_place.key, "bodies.block.formulation");
  EXPECT_EQ(body.formulation_place.line, 9);
  EXPECT_EQ(body.order_place.line, 10);
  EXPECT_EQ(body.incompressibility_place.line, 11);
  EXPECT_EQ(body.locking_place.line, 12);
  const Body short_one = body_of("tetrahedra", meshed_box);
  EXPECT_EQ(short_one.locking_place.key, "bodies.block.locking");
  EXPECT_EQ(short_one.locking_place.line, 4);
}

TEST(Elements, ReadsGeneratedDomains) {
  const Body split = body_of("tetrahedra", "box = { min = [0, 0, 0], max = [1, 1, 1], cells = [1, 2, 3], split = 5 }");
  EXPECT_EQ(split.cells->split, 5);
  const Body cylinder =
      body_of("hexahedra", "cylinder = { from = [0, 0, 0], to = [1, 0, 0], radius = 1, cells = [10, 8] }");
  EXPECT_EQ(std::get<CylinderDomain>(cylinder.domain).radius, 1);
  EXPECT_EQ(cylinder.cells->count, (std::vector{10, 8}));
  const Body ellipsoid =
      body_of("tetrahedra", "ellipsoid = { center = [0, 0, 0], radii = [1, 2, 3], cells = [12, 2] }");
  EXPECT_EQ(ellipsoid.cells->count, (std::vector{12, 2}));
}

TEST(Elements, ReadsBlocks) {
  const Body block = body_of("hexahedra",
                             "block = { corners = [[0, 0, 0], [48, 44, 0], [48, 60, 0], [0, 44, 0], [0, 0, 1], "
                             "[48, 44, 1], [48, 60, 1], [0, 44, \"1 m\"]], cells = [4, 4, 1] }");
  const auto& corners = std::get<BlockDomain>(block.domain).corners;
  EXPECT_EQ(corners[2], (Vec3d{{48, 60, 0}}));
  EXPECT_EQ(corners[7], (Vec3d{{0, 44, 1}}));
  EXPECT_EQ(block.cells->count, (std::vector{4, 4, 1}));
}

TEST(Elements, MeshFilesHaveTheirOwnCells) {
  const Body body = body_of("tetrahedra", "file = \"liver.msh\"");
  EXPECT_EQ(std::get<FileDomain>(body.domain).path, "liver.msh");
  EXPECT_FALSE(body.cells);
}

TEST(Elements, ReadsNeoHookeanMaterials) {
  const std::string rubber = "[materials.rubber]\nlaw = \"neo-hookean\"\nlame = { lambda = -1, mu = 3 }\n";
  const std::string text = mesh_body("tetrahedra", meshed_box) + rubber;
  const Scene scene = test::parse(std::string(text).replace(text.find("\"soft\""), 6, "\"rubber\""));
  EXPECT_EQ(scene.bodies.at(0).materials.at(0).material.law, Law::neo_hookean);
  EXPECT_EQ(scene.bodies.at(0).materials.at(0).material.lambda, -1);
  const Scene solid = test::parse(
      test::beam_with("material = \"soft\"", "material = { law = \"neo-hookean\", young = 1, poisson = 0.4 }"));
  EXPECT_EQ(solid.bodies.at(0).materials.at(0).material.law, Law::neo_hookean);
}

TEST(Elements, ReadsTractions) {
  const Scene scene = test::parse_beam(
      "[[loads]]\nbody = \"beam\"\nwhere = \"all\"\ntraction = [0, \"-1 kPa\", 0]\nover = 1\nfollower = false\n");
  ASSERT_TRUE(scene.loads.at(0).traction);
  EXPECT_EQ(*scene.loads[0].traction, (Vec3d{{0, -1000, 0}}));
  EXPECT_TRUE(scene.loads[0].where);
  EXPECT_FALSE(scene.loads[0].total_force);
}

}  // namespace
}  // namespace fascia::app::elements_test
