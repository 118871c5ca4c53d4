#include "app/reader/parse.hpp"
#include "assembly/specification/check.hpp"
#include "fascia/stepper.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/stepped_scenes.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace fascia::specification_test {

namespace {

namespace fs = std::filesystem;

/// Whatever a reader accepts passes.
TEST(Specification, EveryShippedSceneIsOne) {
  int scenes = 0;
  for (const auto& entry : fs::directory_iterator(test::source_dir() / "scenes")) {
    if (entry.path().extension() != ".toml") continue;
    const Scene scene = app::parse_scene_file(entry.path(), {});
    if (scene.states_need()) continue;
    try {
      check_specification(scene);
    } catch (const SceneError& e) {
      ADD_FAILURE() << e.what();
    }
    ++scenes;
  }
  EXPECT_GT(scenes, 60);
}

std::string trouble(const std::function<void(Scene&)>& spoil) {
  Scene scene = test::driven_block(SolverKind::statics);
  spoil(scene);
  try {
    Stepper stepper(scene);
  } catch (const SceneError& e) {
    return e.what();
  }
  return "";
}

TEST(Specification, MistakesAreNamedByTheirKey) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(trouble([](Scene& s) { s.bodies.clear(), s.constraints.clear(), s.probes.clear(); }),
            "there is no body; give the scene one");
  EXPECT_EQ(trouble([](Scene& s) { s.bodies.push_back(s.bodies[0]); }),
            "bodies.block: has the name \"block\", which is empty or another body's; give each its own");
  EXPECT_EQ(trouble([](Scene& s) { s.constraints[0].body = "bloc"; }),
            "constraints[0]: names the body \"bloc\", which is not there");
  EXPECT_EQ(trouble([](Scene& s) { s.constraints[0].axes(0, 0) = 2; }),
            "constraints[0]: has axes that are no orthonormal rows; use unit vectors at right angles");
  EXPECT_EQ(trouble([](Scene& s) { s.constraints[0].where.shape = NotRegion{}; }),
            "constraints[0]: has a region of nothing: not without a part");
  EXPECT_EQ(trouble([](Scene& s) {
              s.constraints[0].where = in_box({{1, 1, 1}}, {{2, 2, 2}});
            }).substr(0, 65),
            "constraints[0].where: the region selects no frame of body \"block\"");
  EXPECT_EQ(trouble([](Scene& s) {
              s.bodies[0].frames = GridFrames{{3, 3}};
            }),
            "bodies.block.frames: has 2 numbers; must have 3");
  EXPECT_EQ(trouble([](Scene& s) {
              s.bodies[0].frames = GridFrames{{3, 3, 1}};
            }),
            "bodies.block.frames: has the number 1; must be at least 2");
  EXPECT_EQ(trouble([](Scene& s) { s.bodies[0].density.reset(); }),
            "bodies.block: must have a mass or a density, not both");
  EXPECT_EQ(trouble([](Scene& s) { s.bodies[0].density = -1; }),
            "bodies.block: density = -1 is out of range; must be above 0");
  EXPECT_EQ(trouble([](Scene& s) {
              s.bodies[0].materials[0].material.mu = nan, s.bodies[0].materials[0].material.lambda = 0;
            }),
            "bodies.block.material: mu = nan is out of range; must be above 0\n"
            "bodies.block.material: lambda = 0 is out of range; must be above -2/3 mu");
  EXPECT_EQ(trouble([](Scene& s) { s.bodies[0].materials.clear(); }), "bodies.block: has no material");
  EXPECT_EQ(trouble([](Scene& s) { s.bodies[0].model = BodyModel::tetrahedra; }),
            "bodies.block.cells: is missing; give MeshCells::count");
  EXPECT_EQ(trouble([](Scene& s) { s.loads.push_back({.body = "block"}); }),
            "loads[0]: must act on a region (where) or at a point (at)\nloads[0]: applies nothing");
  EXPECT_EQ(trouble([](Scene& s) { s.probes[1].name = "top"; }),
            "probes.top: has the name \"top\", which is empty or another probe's; give each its own");
  EXPECT_EQ(trouble([](Scene& s) { s.probes[0].at.clear(); }), "probes.top.at: is missing; give a point of the body");
  EXPECT_EQ(trouble([](Scene& s) {
              s.world.gravity = {{0, nan, 0}};
            }),
            "world.gravity: has a number that is not finite");
  EXPECT_EQ(trouble([](Scene& s) {
              s.couplings.push_back({.name = "tie", .kind = CouplingKind::weld, .body = "block", .to = "block"});
            }),
            "couplings.tie.to: is the body itself; must be another one");
}

TEST(Specification, PartsThatDoNotFitAreNamed) {
  EXPECT_EQ(trouble([](Scene& s) { s.bodies[0].frames = GridFrames{}; }),
            "bodies.block.frames: is missing; give GridFrames, CountedSamples, SpacedSamples or ListedFrames");
  EXPECT_EQ(trouble([](Scene& s) { s.bodies[0].model = BodyModel::shell; }),
            "bodies.block.domain: is no domain for this model of body");
  EXPECT_EQ(trouble([](Scene& s) {
              s.bodies[0].domain = LineDomain{{}, {{0, 0, 1}}};
              s.bodies[0].frames = GridFrames{{5}};
            }),
            "bodies.block.radius: is missing; a line needs one");
  EXPECT_EQ(trouble([](Scene& s) {
              s.bodies[0].model = BodyModel::rigid;
              s.bodies[0].domain = CylinderDomain{{}, {{0, 0, 1}}, 0.1};
            }),
            "bodies.block.cells: is missing; give MeshCells::count");
  EXPECT_EQ(trouble([](Scene& s) { s.bodies[0].shares = {{.body = "block"}}; }),
            "bodies.block.share.body: is the body itself; must be another one");
  EXPECT_EQ(trouble([](Scene& s) {
              s.bodies.push_back(s.bodies[0]);
              s.bodies[1].name = "other";
              s.bodies[0].shares = {{.body = "other"}};
              s.bodies[1].shares = {{.body = "block"}};
            }),
            "bodies.other.share.body: closes a circle, block → other → block; share and between must not lead back to "
            "a body");
  EXPECT_EQ(trouble([](Scene& s) { s.constraints[0].where.shape = HalfspaceRegion{}; }),
            "constraints[0]: has a half-space without a normal");
  EXPECT_EQ(trouble([](Scene& s) { s.constraints[0].where.shape = AllOfRegion{}; }),
            "constraints[0]: has a region that joins no regions");
  EXPECT_EQ(trouble([](Scene& s) { s.world.schedule.profile = TableProfile{}; }),
            "world.gravity: has a table without rows");
  EXPECT_EQ(trouble([](Scene& s) { s.bodies[0].materials[0].material.law = Law::linear; }),
            "bodies.block.material: has a law that is none of a material; take one of large strain");
  EXPECT_EQ(trouble([](Scene& s) { s.solver.backend = "gpu"; }), "solver: backend = \"gpu\" is none that there is");
}

/// A mesh that a program has in memory.
TEST(Specification, AMeshInMemoryIsABody) {
  Mesh mesh;
  mesh.points = {{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}};
  CellBlock cell;
  cell.type = CellType::tetrahedron;
  cell.nodes = {0, 1, 2, 3};
  mesh.blocks = {cell};
  Scene scene = test::driven_block(SolverKind::statics);
  scene.bodies[0].model = BodyModel::tetrahedra;
  scene.bodies[0].domain = FileDomain{.path = "one tetrahedron", .read = [mesh](MidNodes) { return mesh; }};
  scene.probes.clear();
  Stepper stepper(scene);
  EXPECT_EQ(stepper.node_count(), 4);
  mesh.blocks[0].nodes[3] = 4;
  scene.bodies[0].domain = FileDomain{.path = "one tetrahedron", .read = [mesh](MidNodes) { return mesh; }};
  EXPECT_THROW(Stepper{scene}, SceneError);
  EXPECT_TRUE(stepper.step(1).converged);
  EXPECT_EQ(trouble([](Scene& s) {
              s.bodies[0].model = BodyModel::tetrahedra;
              s.bodies[0].domain = FileDomain{.path = "liver.msh"};
            }),
            "bodies.block.domain.file: nothing reads liver.msh; give the specification a reader");
}

}  // namespace

}  // namespace fascia::specification_test
