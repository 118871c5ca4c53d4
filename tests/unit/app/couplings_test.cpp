#include "tests/unit/app/scene_text.hpp"

#include <gtest/gtest.h>

// Rigid bodies, surfaces, the space between bodies, shared nodes and couplings as they are read.
namespace fascia::app::couplings_test {
namespace {

using test::parse;
using test::parse_beam;

/// The beam, a rigid body "bone" and more.
Scene parse_bone(const std::string& domain, const std::string& more = "mass = 1\n") {
  return parse_beam("[bodies.bone]\nmodel = \"rigid\"\ndomain = { " + domain + " }\n" + more);
}
Body bone(const std::string& domain, const std::string& more = "mass = 1\n") {
  return parse_bone(domain, more).bodies.at(1);
}

/// The beam, a bone and a body "tissue" between them.
Body tissue(const std::string& domain, const std::string& more) {
  return parse_bone("file = \"bone.stl\"",
                    "density = 1\n[bodies.tissue]\nmodel = \"meshless\"\nmaterial = \"soft\"\n"
                    "mass = 1\ndomain = { between = [\"bone\", \"beam\"]" +
                        domain + " }\n" + more)
      .bodies.at(2);
}

TEST(RigidBodies, Mass) {
  const Body heavy = bone("file = \"bone.stl\"",
                          "mass = \"200 g\"\ninitial = { velocity = [1, 0, 0] }\n"
                          "transform = { scale = 0.001 }\n");
  EXPECT_EQ(heavy.model, BodyModel::rigid);
  EXPECT_TRUE(is_carrier(heavy));
  EXPECT_FALSE(is_shell(heavy));
  EXPECT_FALSE(is_mesh_model(heavy));
  EXPECT_DOUBLE_EQ(*heavy.mass, 0.2);
  EXPECT_FALSE(heavy.inertia);
  EXPECT_FALSE(heavy.cells);
  EXPECT_EQ(heavy.initial.velocity[0], 1);
  EXPECT_EQ(heavy.transform.scale, 0.001);
  EXPECT_DOUBLE_EQ(*bone("file = \"bone.stl\"", "density = \"2 g/cm3\"\n").density, 2000);
}

TEST(RigidBodies, Inertia) {
  const Body body = bone("file = \"bone.stl\"",
                         "mass = 1\ninertia = [[\"20 kg cm2\", 1e-4, 0], [1e-4, 0.003, 0], [0, "
                         "0, 0.005]]\n");
  ASSERT_TRUE(body.inertia);
  EXPECT_DOUBLE_EQ((*body.inertia)(0, 0), 0.002);
  EXPECT_EQ((*body.inertia)(0, 1), 1e-4);
  EXPECT_EQ((*body.inertia)(1, 1), 0.003);
  EXPECT_EQ((*body.inertia)(2, 2), 0.005);
  EXPECT_EQ(body.inertia_place.line, 14);
  EXPECT_EQ(body.inertia_place.key, "bodies.bone.inertia");
}

TEST(RigidBodies, CellsOfSolids) {
  const std::string box = "box = { min = [0, 0, 0], max = [1, 1, 1]";
  EXPECT_EQ(bone(box + " }").cells->count, (std::vector<int>{1, 1, 1}));
  EXPECT_EQ(bone(box + ", cells = [4, 3, 2] }", "density = 1\n").cells->count, (std::vector<int>{4, 3, 2}));
  const Body block = bone(
      "block = { corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], "
      "[0, 1, 1]], cells = [1, 2, 3] }");
  EXPECT_TRUE(std::holds_alternative<BlockDomain>(block.domain));
  EXPECT_EQ(block.cells->count, (std::vector<int>{1, 2, 3}));
}

TEST(RigidBodies, CellsOfSurfaces) {
  const Body pipe = bone(
      "cylinder = { from = [0, 0, 0], to = [0, 0, 3], radius = 1, cells = [3, 7], caps = false, "
      "diagonal = \"left\" }");
  EXPECT_FALSE(std::get<CylinderDomain>(pipe.domain).caps);
  EXPECT_EQ(pipe.cells->count, (std::vector<int>{3, 7}));
  EXPECT_EQ(pipe.cells->diagonal, CellDiagonal::left);
  EXPECT_EQ(bone("sphere = { center = [0, 0, 0], radius = 1, cells = [16] }", "density = 1\n").cells->count,
            std::vector<int>{16});
  EXPECT_EQ(bone("ellipsoid = { center = [0, 0, 0], radii = [1, 2, 3], cells = [8] }").cells->count,
            std::vector<int>{8});
  EXPECT_EQ(
      bone("annulus = { center = [0, 0, 0], normal = [0, 0, 1], inner = 1, outer = 2, cells = [1, 8] }").cells->count,
      (std::vector<int>{1, 8}));
  EXPECT_EQ(
      bone("rectangle = { origin = [0, 0, 0], edge_u = [2, 0, 0], edge_v = [0, 1, 0], cells = [4, 2] }").cells->count,
      (std::vector<int>{4, 2}));
}

TEST(Surfaces, RideOnOthers) {
  const Scene scene = parse_beam(
      "[bodies.skin]\nmodel = \"surface\"\ndomain = { file = \"skin.obj\" }\ntransform = { scale = 0.01 }\n"
      "[couplings.ride]\nkind = \"embed\"\nbody = \"skin\"\nwhere = \"all\"\nto = \"beam\"\n"
      "[probes.a]\nbody = \"skin\"\nquantity = \"displacement\"\nat = [0, 0, 0]\n");
  const Body& skin = scene.bodies.at(1);
  EXPECT_EQ(skin.model, BodyModel::surface);
  EXPECT_TRUE(is_carrier(skin));
  EXPECT_FALSE(skin.mass);
  EXPECT_FALSE(skin.density);
  EXPECT_TRUE(skin.materials.empty());
}

TEST(Between, Volume) {
  const Body body = tissue("", "frames = { poisson_disk = 0.1 }\n");
  const auto& between = std::get<BetweenDomain>(body.domain);
  EXPECT_EQ(between.bodies, (std::array<std::string, 2>{"bone", "beam"}));
  EXPECT_EQ(between.as, BetweenKind::volume);
  EXPECT_TRUE(std::holds_alternative<AllRegion>(between.where.shape));
  EXPECT_EQ(between.places[0].line, 18);
  EXPECT_EQ(between.places[0].column, 23);
  EXPECT_EQ(between.places[1].column, 31);
  EXPECT_EQ(between.places[1].key, "bodies.tissue.domain.between[1]");
  EXPECT_FALSE(body.shares);
}

TEST(Between, SheetAndStrands) {
  const Body sheet = tissue(", where = { group = \"edge\" }, as = \"sheet\"",
                            "thickness = \"2 mm\"\nframes = { count = 50 }\npoints = { count = 200, through = 1 }\n");
  const auto& between = std::get<BetweenDomain>(sheet.domain);
  EXPECT_EQ(between.as, BetweenKind::sheet);
  EXPECT_EQ(std::get<GroupRegion>(between.where.shape).name, "edge");
  EXPECT_DOUBLE_EQ(sheet.thickness.at(0).value, 0.002);
  EXPECT_EQ(sheet.through, 1);
  const Body strands = tissue(", as = \"strands\"", "radius = 0.001\nframes = { poisson_disk = 0.1 }\n");
  EXPECT_EQ(std::get<BetweenDomain>(strands.domain).as, BetweenKind::strands);
  EXPECT_EQ(strands.radius, 0.001);
  EXPECT_EQ(std::get<BetweenDomain>(tissue(", as = \"volume\"", "frames = { count = 9 }\n").domain).as,
            BetweenKind::volume);
}

TEST(Shares, AreListed) {
  const Body body = tissue("",
                           "[bodies.tissue.frames]\npoisson_disk = 0.1\n[[bodies.tissue.frames.share]]\n"
                           "body = \"bone\"\n[[bodies.tissue.frames.share]]\nbody = \"beam\"\nrotations = false\n"
                           "where = { sphere = { center = [0, 0, 0], radius = 1 } }\n");
  ASSERT_TRUE(body.shares);
  ASSERT_EQ(body.shares->size(), 2u);
  const SharedNodes &first = body.shares->at(0), &second = body.shares->at(1);
  EXPECT_EQ(first.body, "bone");
  EXPECT_TRUE(first.rotations);
  EXPECT_TRUE(std::holds_alternative<AllRegion>(first.where.shape));
  EXPECT_EQ(first.place.key, "bodies.tissue.frames.share[0]");
  EXPECT_EQ(first.body_place.key, "bodies.tissue.frames.share[0].body");
  EXPECT_EQ(first.body_place.line, 22);
  EXPECT_EQ(first.body_place.column, 8);
  EXPECT_EQ(second.body, "beam");
  EXPECT_FALSE(second.rotations);
  EXPECT_TRUE(std::holds_alternative<SphereRegion>(second.where.shape));
}

TEST(Shares, MayBeNone) {
  const Body none = tissue("", "frames = { count = 9, share = [] }\n");
  ASSERT_TRUE(none.shares);
  EXPECT_TRUE(none.shares->empty());
  EXPECT_FALSE(parse(test::beam).bodies[0].shares);
}

TEST(Shares, StandBesideAGrid) {
  const Scene scene = parse_bone("file = \"bone.stl\"",
                                 "mass = 1\n[bodies.tail]\nmodel = \"meshless\"\ndomain = { box "
                                 "= { min = [4, 0, 0], max = [5, 1, 1] } }\nmass = 1\n"
                                 "material = \"soft\"\nframes = { grid = [2, 2, 2], share = [{ "
                                 "body = \"beam\" }] }\n");
  EXPECT_EQ(scene.bodies.at(2).shares->at(0).body, "beam");
  EXPECT_EQ(std::get<GridFrames>(scene.bodies.at(2).frames).count, (std::vector<int>{2, 2, 2}));
}

TEST(Shares, TwoBodiesMayNeedAThird) {
  const std::string end = " }\nmass = 1\nmaterial = \"soft\"\nframes = { count = 9, share = [{ body = \"bone\" }] }\n";
  const Scene scene =
      parse_bone("file = \"bone.stl\"",
                 "mass = 1\n[bodies.a]\nmodel = \"meshless\"\ndomain = { between = [\"bone\", \"b\"]" + end +
                     "[bodies.b]\nmodel = \"meshless\"\ndomain = { box = { min = [4, 0, 0], max = [5, 1, 1] }" + end);
  EXPECT_EQ(scene.bodies.size(), 4u);
}

TEST(Couplings, WeldAndEmbed) {
  const Scene scene = parse_bone("file = \"bone.stl\"",
                                 "mass = 1\n[couplings.foot]\nkind = \"weld\"\nbody = \"beam\"\nto = \"bone\"\n"
                                 "where = { halfspace = { point = [0, 0, 0], normal = [-1, 0, 0] } }\n"
                                 "[couplings.core]\nkind = \"embed\"\nbody = \"bone\"\nwhere = \"all\"\n"
                                 "to = \"beam\"\n");
  ASSERT_EQ(scene.couplings.size(), 2u);
  const Coupling &weld = scene.couplings[0], &embed = scene.couplings[1];
  EXPECT_EQ(weld.name, "foot");
  EXPECT_EQ(weld.kind, CouplingKind::weld);
  EXPECT_EQ(weld.body, "beam");
  EXPECT_EQ(weld.to, "bone");
  EXPECT_TRUE(std::holds_alternative<HalfspaceRegion>(weld.where.shape));
  EXPECT_EQ(weld.place.key, "couplings.foot");
  EXPECT_EQ(weld.place.line, 14);
  EXPECT_EQ(weld.to_place.key, "couplings.foot.to");
  EXPECT_EQ(weld.to_place.line, 17);
  EXPECT_EQ(embed.kind, CouplingKind::embed);
  EXPECT_EQ(embed.to, "beam");
}

TEST(Couplings, Springs) {
  const Scene scene = parse_beam(
      "[couplings.ligament]\nkind = \"spring\"\nbody = \"beam\"\nwhere = { nearest = [4, 0, 0] }\n"
      "point = [\"50 cm\", 0, 1]\nstiffness = \"2 N/mm\"\n[couplings.along]\nkind = \"spring\"\nbody = \"beam\"\n"
      "where = \"all\"\npoint = [0, 0, 0]\nstiffness = 3\ndirection = [0, 3, 4]\n");
  const Coupling &free = scene.couplings.at(0), &along = scene.couplings.at(1);
  EXPECT_EQ(free.kind, CouplingKind::spring);
  EXPECT_EQ(free.point, (Vec3d{{0.5, 0, 1}}));
  EXPECT_DOUBLE_EQ(free.stiffness, 2000);
  EXPECT_FALSE(free.direction);
  ASSERT_TRUE(along.direction);
  EXPECT_NEAR(norm(*along.direction - Vec3d{{0, 0.6, 0.8}}), 0, 1e-15);
}

TEST(Couplings, OverridesReachThem) {
  const Scene scene = parse_beam(
      "[couplings.ligament]\nkind = \"spring\"\nbody = \"beam\"\nwhere = \"all\"\npoint = [0, 0, 1]\nstiffness = 1\n",
      {"couplings.ligament.stiffness=5 N/cm"});
  EXPECT_DOUBLE_EQ(scene.couplings.at(0).stiffness, 500);
}

}  // namespace
}  // namespace fascia::app::couplings_test
