#include "tests/unit/app/scene_text.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace fascia::app::scene_test {
namespace {

using test::parse_beam;

constexpr std::string_view cantilever = R"(title = "Soft cantilever under its own weight"

[world]
gravity = [0, -9.81, 0]                 # m/s2; default [0, 0, 0]

[materials.silicone]
law     = "st-venant-kirchhoff"         # default; "neo-hookean" later more
young   = "40 kPa"                      # or lame = { lambda = ..., mu = ... }
poisson = 0.3
damping = { mass = 0.0, stiffness = 0.0 }   # 1/s on velocities; s on the strain rate (beta C : dE/dt, objective)

[bodies.beam]
model    = "meshless"
domain   = { box = { min = [0, -0.5, -0.5], max = [16, 0.5, 0.5] } }
mass     = "5 kg"                       # or density = ...
material = "silicone"                   # or an inline table
frames   = { grid = [21, 3, 3] }        # frames along x, y, z, domain faces included
points   = { per_cell = [2, 2, 2] }     # Gauss points in each cell of the frame grid
weights  = { kind = "trilinear" }

[[constraints]]
body  = "beam"
where = { box = { min = [-0.01, -1, -1], max = [0.01, 1, 1] } }
fix   = "all"

[solver]
kind = "static"

[probes.tip]
body = "beam"
at = [16, 0, 0]                         # material point (rest position)
quantity = "displacement"

[output]
directory = "results/soft_cantilever"
)";

TEST(Scene, ReadsTheExample) {
  const Scene scene = parse_scene_text(cantilever, "scenes/cantilever.toml", {});
  EXPECT_EQ(scene.title, "Soft cantilever under its own weight");
  EXPECT_EQ(scene.world.gravity, (Vec3d{{0, -9.81, 0}}));
  ASSERT_EQ(scene.bodies.size(), 1u);
  const Body& body = scene.bodies[0];
  EXPECT_EQ(body.name, "beam");
  EXPECT_EQ(std::get<BoxDomain>(body.domain).max, (Vec3d{{16, 0.5, 0.5}}));
  EXPECT_EQ(body.mass, 5.0);
  EXPECT_FALSE(body.density);
  EXPECT_EQ(std::get<GridFrames>(body.frames).count, (std::vector{21, 3, 3}));
  EXPECT_EQ(std::get<PerCell>(body.points).count, (std::vector{2, 2, 2}));
  ASSERT_EQ(body.materials.size(), 1u);
  EXPECT_EQ(body.materials[0].material.name, "silicone");
  EXPECT_NEAR(body.materials[0].material.young(), 4e4, 1e-9);
  EXPECT_NEAR(body.materials[0].material.poisson(), 0.3, 1e-14);
  ASSERT_EQ(scene.constraints.size(), 1u);
  EXPECT_EQ(scene.constraints[0].fixed, (std::array{true, true, true, true, true, true}));
  EXPECT_FALSE(scene.constraints[0].motion);
  ASSERT_EQ(scene.probes.size(), 1u);
  EXPECT_EQ(scene.probes[0].at, (std::vector<Vec3d>{{{16, 0, 0}}}));
  EXPECT_FALSE(scene.probes[0].at_is_list);
  EXPECT_EQ(scene.output.directory, "results/soft_cantilever");
}

TEST(Scene, PlacesPointAtTheText) {
  const Scene scene = parse_scene_text(cantilever, "scenes/cantilever.toml", {});
  const Place& where = scene.constraints[0].where.place;
  EXPECT_EQ(where.file, "scenes/cantilever.toml");
  EXPECT_EQ(where.key, "constraints[0].where");
  EXPECT_EQ(where.line, 23);
  EXPECT_EQ(where.column, 9);
  EXPECT_EQ(scene.bodies[0].frames_place.key, "bodies.beam.frames.grid");
  EXPECT_EQ(scene.bodies[0].frames_place.line, 17);
  EXPECT_EQ(scene.bodies[0].domain_place.line, 14);
  EXPECT_EQ(scene.bodies[0].points_place.key, "bodies.beam.points.per_cell");
  EXPECT_EQ(scene.bodies[0].materials[0].material.place.line, 6);
  EXPECT_EQ(scene.probes[0].at_place.line, 31);
  EXPECT_EQ(scene.solver.place.line, 26);
}

TEST(Scene, DefaultsAreThoseOfTheManual) {
  const Scene scene = parse_scene_text(test::beam, "folder/beam.toml", {});
  const Body& body = scene.bodies[0];
  EXPECT_TRUE(std::holds_alternative<std::monostate>(body.points));
  EXPECT_EQ(body.weights, WeightKind::automatic);
  EXPECT_EQ(body.blend, Blend::automatic);
  EXPECT_FALSE(body.drilling);
  EXPECT_EQ(body.transform.scale, 1);
  EXPECT_EQ(scene.world.gravity, Vec3d{});
  EXPECT_EQ(scene.solver.kind, SolverKind::statics);
  EXPECT_EQ(scene.solver.load_steps, 0);
  EXPECT_EQ(scene.solver.newton_max_iterations, 50);
  EXPECT_EQ(scene.solver.newton_tolerance, 1e-8);
  EXPECT_EQ(scene.solver.linear_max_iterations, 1000);
  EXPECT_EQ(scene.solver.linear_tolerance, 1e-6);
  EXPECT_EQ(scene.solver.backend, "auto");
  EXPECT_EQ(scene.output.directory, "results/beam");
  EXPECT_EQ(scene.output.fields.size(), 6u);
  EXPECT_FALSE(scene.output.picture);
}

TEST(Scene, BodiesKeepTheOrderOfTheFile) {
  const std::string body =
      "model = \"meshless\"\ndomain = { box = { min = [0, 0, 0], max = [1, 1, 1] } }\nmass = 1\n"
      "material = { young = 1, poisson = 0 }\nframes = { grid = [2, 2, 2] }\n";
  const Scene scene = test::parse("[bodies.z]\n" + body + "[bodies.a]\n" + body);
  ASSERT_EQ(scene.bodies.size(), 2u);
  EXPECT_EQ(scene.bodies[0].name, "z");
  EXPECT_EQ(scene.bodies[1].name, "a");
}

TEST(Scene, ReadsDomainsAndTransform) {
  const std::string cylinder = test::beam_with(
      "{ box = { min = [0, 0, 0], max = [4, 1, 1] } }",
      "{ cylinder = { from = [0, 0, 0], to = [\"10 cm\", 0, 0], radius = \"5 mm\" } }\n"
      "transform = { translate = [1, 2, 3], rotate = { axis = [0, 0, 2], angle = \"90 degree\" }, scale = 2 }");
  const Scene scene = test::parse(cylinder);
  EXPECT_DOUBLE_EQ(std::get<CylinderDomain>(scene.bodies[0].domain).radius, 5e-3);
  EXPECT_DOUBLE_EQ(std::get<CylinderDomain>(scene.bodies[0].domain).to[0], 0.1);
  EXPECT_DOUBLE_EQ(scene.bodies[0].transform.angle, std::numbers::pi / 2);
  EXPECT_EQ(scene.bodies[0].transform.scale, 2);
}

TEST(Scene, MeshPathsAreRelativeToTheScene) {
  const std::string text = test::beam_with("box = { min = [0, 0, 0], max = [4, 1, 1] }", "file = \"meshes/liver.msh\"");
  EXPECT_EQ(std::get<FileDomain>(parse_scene_text(text, "scenes/a.toml", {}).bodies[0].domain).path,
            "scenes/meshes/liver.msh");
  const std::string absolute =
      test::beam_with("box = { min = [0, 0, 0], max = [4, 1, 1] }", "file = \"/data/liver.msh\"");
  EXPECT_EQ(std::get<FileDomain>(parse_scene_text(absolute, "scenes/a.toml", {}).bodies[0].domain).path,
            "/data/liver.msh");
}

TEST(Scene, ReadsMaterialsByRegion) {
  const std::string text =
      test::beam_with("material = \"soft\"",
                      "material = [{ where = { sphere = { center = [0, 0, 0], radius = 1 } }, use = \"soft\" }, "
                      "{ use = { lame = { lambda = \"1 kPa\", mu = 500 } } }]");
  const std::vector<MaterialUse> uses = test::parse(text).bodies[0].materials;
  ASSERT_EQ(uses.size(), 2u);
  EXPECT_TRUE(std::holds_alternative<SphereRegion>(uses[0].where.shape));
  EXPECT_TRUE(std::holds_alternative<AllRegion>(uses[1].where.shape));
  EXPECT_EQ(uses[1].material.lambda, 1000);
  EXPECT_EQ(uses[1].material.name, "");
}

TEST(Scene, ReadsRegions) {
  const Scene scene = parse_beam(R"([[constraints]]
body = "beam"
where = { all_of = ["all", { any_of = [{ ids = [0, 5] }, { nearest = [1, 2, 3] }, { group = 7 }] }, { not = { boundary = true } }] }
fix = ["x", "ry"]
)");
  const auto& all = std::get<AllOfRegion>(scene.constraints[0].where.shape).parts;
  ASSERT_EQ(all.size(), 3u);
  const auto& any = std::get<AnyOfRegion>(all[1].shape).parts;
  EXPECT_EQ(std::get<IdsRegion>(any[0].shape).ids, (std::vector{0, 5}));
  EXPECT_EQ(std::get<GroupRegion>(any[2].shape).name, "7");
  EXPECT_EQ(any[2].place.key, "constraints[0].where.all_of[1].any_of[2]");
  EXPECT_TRUE(std::holds_alternative<BoundaryRegion>(std::get<NotRegion>(all[2].shape).part->shape));
  EXPECT_EQ(scene.constraints[0].fixed, (std::array{true, false, false, false, true, false}));
}

TEST(Scene, SymmetryAndHingeChooseTheirAxes) {
  const Scene scene = parse_beam(R"([[constraints]]
body = "beam"
where = "all"
fix = "symmetry"
normal = [0, 3, 0]
[[constraints]]
body = "beam"
where = "all"
fix = "hinge"
axis = [1, 1, 0]
)");
  const Constraint &plane = scene.constraints[0], &hinge = scene.constraints[1];
  EXPECT_EQ(plane.fixed, (std::array{true, false, false, false, true, true}));
  EXPECT_EQ(plane.axes.row(0), (Vec3d{{0, 1, 0}}));
  EXPECT_EQ(hinge.fixed, (std::array{true, true, true, false, true, true}));
  EXPECT_NEAR(hinge.axes.row(0)[0], std::sqrt(0.5), 1e-15);
  for (const Constraint* c : {&plane, &hinge}) {
    const Mat3d gram = times_transpose(c->axes, c->axes) - Mat3d::identity();
    EXPECT_LT(contract(gram, gram), 1e-28);
  }
}

TEST(Scene, ReadsMotionsAndSchedules) {
  const Scene scene = parse_beam(R"([[constraints]]
body = "beam"
where = "all"
move = { rotate = { axis = [1, 0, 0], angle = "720 degree" }, axes = ["x", "rx"] }
over = "500 ms"
profile = "smooth"
[[loads]]
body = "beam"
at = [1, 0, 0]
force = ["5 mN", 0, 0]
follower = true
profile = [[0, 0], ["100 ms", 1]]
[[loads]]
body = "beam"
where = "all"
total_force = [0, 0, 1]
profile = { sine = { period = "4 s" } }
)");
  const Constraint& c = scene.constraints[0];
  ASSERT_TRUE(c.motion);
  EXPECT_DOUBLE_EQ(c.motion->angle, 4 * std::numbers::pi);
  EXPECT_EQ(c.fixed, (std::array{true, false, false, true, false, false}));
  EXPECT_EQ(c.schedule.over, 0.5);
  EXPECT_TRUE(c.schedule.has_over);
  EXPECT_TRUE(std::holds_alternative<SmoothProfile>(c.schedule.profile));
  EXPECT_TRUE(scene.loads[0].follower);
  EXPECT_DOUBLE_EQ((*scene.loads[0].force)[0], 5e-3);
  EXPECT_DOUBLE_EQ(std::get<TableProfile>(scene.loads[0].schedule.profile).points[1][0], 0.1);
  EXPECT_EQ(std::get<SineProfile>(scene.loads[1].schedule.profile).period, 4);
}

TEST(Scene, StepsComeFromTheDurationRoundedUp) {
  const auto steps = [](const std::string& duration) {
    return parse_beam("[solver]\nkind = \"implicit-euler\"\ntime_step = 0.1\nduration = " + duration + "\n")
        .solver.steps;
  };
  EXPECT_EQ(steps("0.3"), 3);
  EXPECT_EQ(steps("0.31"), 4);
  EXPECT_EQ(steps("0.01"), 1);
}

TEST(Scene, ReadsTheSolver) {
  const Solver solver = parse_beam(R"([solver]
kind = "implicit-euler"
time_step = "10 ms"
steps = 100
newton = { max_iterations = 1, tolerance = 1e-4, on_limit = "continue" }
linear = { kind = "cg", preconditioner = "block-jacobi", max_iterations = 10, tolerance = 1e-3 }
tangent = "material"
backend = "cuda"
threads = 2
)")
                            .solver;
  EXPECT_EQ(solver.kind, SolverKind::implicit_euler);
  EXPECT_EQ(solver.steps, 100);
  EXPECT_EQ(solver.on_limit, OnLimit::proceed);
  EXPECT_EQ(solver.linear, LinearMethod::cg);
  EXPECT_EQ(solver.preconditioner, PreconditionerKind::block_jacobi);
  EXPECT_FALSE(solver.full_tangent);
  EXPECT_EQ(solver.backend, "cuda");
  EXPECT_EQ(solver.threads, 2);
}

TEST(Scene, ReadsProbesAndOutput) {
  const Scene scene = parse_beam(R"([probes.line]
body = "beam"
quantity = "stress"
at = [[0, 0, 0], ["1 cm", 0, 0]]
[probes.energy]
quantity = "total_energy"
[output]
every_steps = 3
fields = ["stress"]
picture = { view = [0, 0, 1], size = [640, 480], field = "displacement" }
)");
  EXPECT_TRUE(scene.probes[0].at_is_list);
  EXPECT_EQ(scene.probes[0].at.size(), 2u);
  EXPECT_FALSE(scene.probes[1].body);
  EXPECT_EQ(scene.output.every_steps, 3);
  EXPECT_EQ(scene.output.fields, std::vector<std::string>{"stress"});
  EXPECT_EQ(scene.output.picture->size, (std::array{640, 480}));
}

}  // namespace
}  // namespace fascia::app::scene_test
