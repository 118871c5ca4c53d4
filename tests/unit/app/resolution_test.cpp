#include "app/estimate/resolution.hpp"
#include "tests/unit/app/scene_text.hpp"

#include <gtest/gtest.h>

#include <fmt/format.h>

// What has to be set in a scene for another resolution, and that it is the scene that was meant.
namespace fascia::app::resolution_test {
namespace {

using namespace test;

using Texts = std::vector<std::string>;

std::string material_and(const std::string& bodies) {
  return "[materials.soft]\nyoung = 1000\npoisson = 0.3\n" + bodies;
}

std::string meshless(const std::string& name, const std::string& keys) {
  return "[bodies." + name + "]\nmodel = \"meshless\"\nmaterial = \"soft\"\ndensity = 1000\n" + keys + "\n";
}

std::string elements(const std::string& name, const std::string& model, const std::string& domain,
                     const std::string& more = "") {
  return "[bodies." + name + "]\nmodel = \"" + model + "\"\nmaterial = \"soft\"\ndensity = 1000\ndomain = { " + domain +
         " }\n" + more + "\n";
}

const std::string unit_box = "box = { min = [0, 0, 0], max = [1, 1, 1]";

TEST(Resolution, EveryKindOfBody) {
  const std::string text = material_and(
      meshless("grid", "domain = { " + unit_box + " } }\nframes = { grid = [9, 3, 5] }") +
      meshless("sheet",
               "domain = { rectangle = { origin = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 1, 0] } }\n"
               "thickness = 0.01\nframes = { grid = [5, 3] }") +
      meshless("rod",
               "domain = { line = { from = [0, 0, 0], to = [1, 0, 0] } }\nradius = 0.01\n"
               "frames = { count = 8 }\npoints = { count = 20 }") +
      meshless("cloud", "domain = { " + unit_box +
                            " } }\nframes = { poisson_disk = 0.2 }\n"
                            "points = { poisson_disk = 0.1 }\nweights = { kind = \"mls\", radius = 0.5 }") +
      elements("cubes", "hexahedra", unit_box + ", cells = [4, 2, 6] }") +
      elements("rod2", "tetrahedra", "cylinder = { from = [0, 0, 0], to = [0, 0, 1], radius = 1, cells = [4, 8] }") +
      elements("ball", "tetrahedra", "sphere = { center = [0, 0, 0], radius = 1, cells = [8, 2] }") +
      elements("roof", "shell",
               "rectangle = { origin = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 1, 0], cells = [8, 4] }",
               "thickness = 0.01") +
      elements("skin", "shell", "ellipsoid = { center = [0, 0, 0], radii = [1, 1, 1], cells = [16] }",
               "thickness = 0.01"));
  const Scene scene = parse(text);
  const SceneTwin fine = refined(scene, 2);
  EXPECT_EQ(fine.kept, Texts{});
  EXPECT_EQ(fine.overrides,
            (Texts{"bodies.grid.frames.grid=[17, 5, 9]", "bodies.sheet.frames.grid=[9, 5]",
                   "bodies.rod.frames.count=16", "bodies.rod.points.count=40", "bodies.cloud.frames.poisson_disk=0.1",
                   "bodies.cloud.points.poisson_disk=0.05", "bodies.cloud.weights.radius=0.25",
                   "bodies.cubes.domain.box.cells=[8, 4, 12]", "bodies.rod2.domain.cylinder.cells=[8, 16]",
                   "bodies.ball.domain.sphere.cells=[16, 4]", "bodies.roof.domain.rectangle.cells=[16, 8]",
                   "bodies.skin.domain.ellipsoid.cells=[32]"}));
  EXPECT_EQ(fine.changes[0], "\"grid\" has 17 x 5 x 9 frames in the place of 9 x 3 x 5");
  EXPECT_DOUBLE_EQ(fine.nodes.at("cubes"), 8);
  EXPECT_DOUBLE_EQ(fine.nodes.at("ball"), 8);
  EXPECT_DOUBLE_EQ(fine.nodes.at("skin"), 4);
  EXPECT_DOUBLE_EQ(fine.nodes.at("rod"), 2);
  // The twin is a scene, and its coarser twin is the scene again.
  const Scene twin = parse(text, fine.overrides);
  const SceneTwin back = coarsened(twin, 2);
  EXPECT_EQ(back.kept, Texts{});
  EXPECT_EQ(back.overrides[0], "bodies.grid.frames.grid=[9, 3, 5]");
  EXPECT_EQ(std::get<SpacedSamples>(parse(text, back.overrides).bodies[3].frames).spacing, 0.2);
  EXPECT_EQ(refined(scene, 2, "cubes").overrides, Texts{"bodies.cubes.domain.box.cells=[8, 4, 12]"});
}

TEST(Resolution, WhatCannotBeJoinedStays) {
  const Scene scene = parse(material_and(elements("block", "tetrahedra", unit_box + ", cells = [4, 3, 1] }")));
  const SceneTwin coarse = coarsened(scene, 2);
  EXPECT_EQ(coarse.overrides, Texts{});
  EXPECT_EQ(coarse.kept, Texts{"\"block\" stays: 3 cells cannot be joined by 2"});
  EXPECT_FALSE(coarse.complete());
  EXPECT_EQ(resized(scene, 0.5).overrides, Texts{"bodies.block.domain.box.cells=[2, 2, 1]"});
  EXPECT_EQ(resized(scene, 1.5).overrides, Texts{"bodies.block.domain.box.cells=[6, 5, 2]"});
  EXPECT_EQ(resized(scene, 1e6).kept, Texts{"\"block\" stays: it would have more cells than the program takes"});
  EXPECT_EQ(resized(scene, 1.01).kept, Texts{"\"block\" stays: its 4 x 3 x 1 cells round to the same"});
}

TEST(Resolution, WhatIsSaidByNodeStays) {
  const auto kept = [](const std::string& more) {
    const SceneTwin twin = refined(parse_beam(more), 2);
    return twin.kept.empty() ? "" : twin.kept[0];
  };
  EXPECT_EQ(kept("[[constraints]]\nbody = \"beam\"\nwhere = { any_of = [{ boundary = true }, { ids = [0] }] }\nfix = "
                 "\"all\"\n"),
            "\"beam\" stays: constraints[0].where names its nodes by their numbers");
  EXPECT_EQ(kept("[[loads]]\nbody = \"beam\"\nwhere = \"all\"\nforce_per_node = [0, 1, 0]\n"),
            "\"beam\" stays: loads[0].force_per_node is a force for each node");
  EXPECT_EQ(kept("[probes.held]\nbody = \"beam\"\nquantity = \"force\"\nwhere = { ids = [1, 2] }\n"),
            "\"beam\" stays: probes.held.where names its nodes by their numbers");
  const Scene listed = parse(material_and(meshless(
      "a", "domain = { " + unit_box + " } }\nframes = { positions = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]] }")));
  EXPECT_EQ(refined(listed, 2).kept, Texts{"\"a\" stays: its frames are listed in the scene"});
}

TEST(Resolution, MeshesOfFiles) {
  const auto of_file = [](const std::string& more) {
    return parse(material_and(elements("liver", "tetrahedra", "file = \"liver.msh\"" + more)));
  };
  EXPECT_EQ(refined(of_file(""), 2).overrides, Texts{"bodies.liver.domain.refine=1"});
  EXPECT_EQ(refined(of_file(", refine = 1"), 4).overrides, Texts{"bodies.liver.domain.refine=3"});
  EXPECT_EQ(coarsened(of_file(", refine = 1"), 2).overrides, Texts{"bodies.liver.domain.refine=0"});
  EXPECT_EQ(coarsened(of_file(""), 2).kept, Texts{"\"liver\" stays: liver.msh has no coarser mesh"});
  EXPECT_EQ(refined(of_file(""), 3).kept, Texts{"\"liver\" stays: the cells of its mesh are cut by halves only"});
}

TEST(Resolution, Order) {
  const Scene scene =
      parse(material_and(elements("a", "hexahedra", unit_box + ", cells = [1, 1, 1] }") +
                         elements("b", "tetrahedra", unit_box + ", cells = [1, 1, 1] }", "locking = \"f-bar\"")));
  const SceneTwin twin = raised_order(scene);
  EXPECT_EQ(twin.overrides, Texts{"bodies.a.order=2"});
  EXPECT_EQ(twin.kept, Texts{"\"b\" stays: its remedy against locking needs linear elements"});
}

Scene with_solver(const std::string& keys) { return parse_beam("[solver]\n" + keys + "\n"); }

TEST(Resolution, TimeStep) {
  const Scene scene = with_solver("kind = \"bdf2\"\ntime_step = 0.01\nduration = 1");
  EXPECT_EQ(with_time_step(scene, 0.5).overrides, Texts{"solver.time_step=0.005"});
  EXPECT_EQ(with_time_step(scene, 2).changes, Texts{"the time step is 0.02 s in the place of 0.01 s"});
  // Numbers of steps become times, so that the twin ends and saves where the scene does.
  const std::string text =
      std::string(beam) + "[solver]\nkind = \"newmark\"\ntime_step = 0.01\nsteps = 7\n[output]\nevery_steps = 3\n";
  const Scene twin = parse(text, with_time_step(parse(text), 2).overrides);
  EXPECT_EQ(twin.solver.steps, 4);
  EXPECT_DOUBLE_EQ(*twin.solver.duration, 0.07);
  EXPECT_DOUBLE_EQ(twin.output.every, 0.03);
  EXPECT_EQ(with_time_step(with_solver("kind = \"static\""), 0.5).kept,
            Texts{"the time step stays: there is none without dynamics"});
  const Scene automatic = with_solver("kind = \"explicit\"\ntime_step = \"auto\"\nduration = 1");
  EXPECT_EQ(with_time_step(automatic, 0.5).kept, Texts{"the time step stays: the run finds it"});
  EXPECT_EQ(with_time_step(automatic, 0.5, 1e-3).overrides, Texts{"solver.time_step=0.0005"});
  EXPECT_EQ(with_time_step(automatic, 2, 1e-3).kept, Texts{"the time step stays: a longer one may be unstable"});
}

TEST(Resolution, ToleranceAndPrecision) {
  const std::string rough = "newton = { max_iterations = 3, tolerance = 1e-3, on_limit = \"continue\" }";
  const SceneTwin exact = solved_exactly(with_solver(rough));
  const Scene twin = parse(std::string(beam) + "[solver]\n" + rough + "\n", exact.overrides);
  EXPECT_EQ(twin.solver.newton_tolerance, 1e-10);
  EXPECT_EQ(twin.solver.linear_tolerance, 1e-10);
  EXPECT_EQ(twin.solver.on_limit, OnLimit::stop);
  EXPECT_GE(twin.solver.newton_max_iterations, 200);
  EXPECT_FALSE(solved_exactly(with_solver("kind = \"modes\"")).complete());
  const std::string limited = "kind = \"newmark\"\ntime_step = 0.1\nsteps = 3\nbudget = \"5 ms\"";
  const SceneTwin unlimited = solved_exactly(with_solver(limited));
  EXPECT_EQ(with_solver(limited).solver.budget, 0.005);
  EXPECT_FALSE(parse(std::string(beam) + "[solver]\n" + limited + "\n", unlimited.overrides).solver.budget);
  EXPECT_FALSE(in_double(with_solver("")).complete());
  EXPECT_EQ(in_double(with_solver("precision = \"mixed\"")).overrides, Texts{"solver.precision=\"double\""});
}

}  // namespace
}  // namespace fascia::app::resolution_test
