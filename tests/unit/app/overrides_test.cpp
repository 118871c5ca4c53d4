#include "tests/unit/app/scene_text.hpp"

#include <gtest/gtest.h>

namespace fascia::app::overrides_test {
namespace {

using test::parse_beam;

constexpr const char* two_constraints = R"([[constraints]]
body = "beam"
where = "all"
fix = "all"
[[constraints]]
body = "beam"
where = "all"
fix = "all"
)";

std::string errors_of_override(const std::string& text) { return test::errors_of_beam(two_constraints, {text}); }

TEST(Overrides, TakeTomlValues) {
  EXPECT_DOUBLE_EQ(parse_beam("", {"materials.soft.poisson=0.4"}).bodies[0].materials[0].material.poisson(), 0.4);
  EXPECT_EQ(parse_beam("", {"world.gravity=[0, 0, -9.81]"}).world.gravity[2], -9.81);
  EXPECT_EQ(parse_beam("", {"solver.newton={ max_iterations = 3 }"}).solver.newton_max_iterations, 3);
  EXPECT_EQ(parse_beam("", {"title = \"a = b\""}).title, "a = b");
}

TEST(Overrides, TakeBareTexts) {
  EXPECT_NEAR(parse_beam("", {"materials.soft.young=50 kPa"}).bodies[0].materials[0].material.young(), 5e4, 1e-9);
  EXPECT_EQ(parse_beam("", {"solver.backend=cpu"}).solver.backend, "cpu");
  EXPECT_EQ(parse_beam("", {"title=a = b"}).title, "a = b");
}

TEST(Overrides, LaterOnesWin) { EXPECT_EQ(parse_beam("", {"title=a", "title=b"}).title, "b"); }

TEST(Overrides, AddressElements) {
  EXPECT_EQ(parse_beam(two_constraints, {"constraints[1].fix=position"}).constraints[1].fixed,
            (std::array{true, true, true, false, false, false}));
  EXPECT_EQ(parse_beam(two_constraints, {"constraints.0.fix=rotation"}).constraints[0].fixed,
            (std::array{false, false, false, true, true, true}));
  EXPECT_EQ(std::get<BoxDomain>(parse_beam("", {"bodies.beam.domain.box.max[0]=7"}).bodies[0].domain).max[0], 7);
}

TEST(Overrides, WithoutAValueRemove) {
  EXPECT_EQ(parse_beam("[world]\ngravity = [0, 0, -1]\n", {"world.gravity="}).world.gravity[2], 0);
  EXPECT_EQ(parse_beam("title = 3\n", {"bodies.beam.title = "}).title, "");
  EXPECT_EQ(parse_beam(two_constraints, {"constraints[1]="}).constraints.size(), 1u);
  EXPECT_EQ(parse_beam(two_constraints, {"constraints[0]=", "constraints[0]="}).constraints.size(), 0u);
  EXPECT_EQ(parse_beam(two_constraints, {"constraints="}).constraints.size(), 0u);
  EXPECT_EQ(parse_beam("", {"probes.p.quantity=volume", "probes.p="}).probes.size(), 0u);
  EXPECT_EQ(parse_beam("", {"title=\"\""}).title, "");
}

TEST(Overrides, RemoveOnlyWhatIsThere) {
  EXPECT_EQ(errors_of_override("materials.soft.yuong="),
            "--set:1:16: materials.soft.yuong: is not there, so that it cannot be removed; did you mean \"young\"?");
  EXPECT_EQ(errors_of_override("world.gravity="),
            "--set:1:1: world: is not there, so that it cannot be removed; leave this --set out");
  EXPECT_EQ(errors_of_override("constraints[2]="),
            "--set:1:13: constraints[2]: \"2\" is no index of this list; must be from 0 to 1");
  EXPECT_EQ(errors_of_override("materials.soft.young.x="),
            "--set:1:22: materials.soft.young.x: \"40 kPa\" has no key \"x\"; set the whole value");
  EXPECT_EQ(errors_of_override("bodies.beam.material="),
            "a.toml:4:1: bodies.beam.material: is missing; must be the name of a material, a table with young, lame or "
            "c10 or "
            "a list, each a table with use");
}

TEST(Overrides, MakeMissingTables) {
  const Scene scene = parse_beam("", {"solver.linear.tolerance=1e-3", "probes.p.quantity=volume"});
  EXPECT_EQ(scene.solver.linear_tolerance, 1e-3);
  EXPECT_EQ(scene.probes[0].name, "p");
  EXPECT_EQ(scene.probes[0].place.file, "--set");
}

TEST(Overrides, NameWhatAMistypedBodyMayMean) {
  const std::string errors = errors_of_override("bodies.baem.frames.grid=[3, 3, 3]");
  EXPECT_NE(errors.find("bodies.baem.model: is missing; must be "), std::string::npos) << errors;
  EXPECT_NE(errors.find("; or did you mean \"beam\"?"), std::string::npos) << errors;
}

TEST(Overrides, AreCheckedLikeTheFile) {
  EXPECT_EQ(errors_of_override("materials.soft.poisson=0.6"),
            "--set:1:24: materials.soft.poisson: 0.6 is out of range; must be above -1 and below 0.5");
  EXPECT_EQ(errors_of_override("materials.soft.young = 50 m"),
            "--set:1:24: materials.soft.young: \"50 m\" is a length; must be a pressure in Pa, such as \"40 kPa\"");
  EXPECT_EQ(errors_of_override("world.gravity=[0, nan, 0]"),
            "--set:1:19: world.gravity[1]: nan is not finite; must be an acceleration in m/s2");
  EXPECT_EQ(errors_of_override("solver.newton.tolerence=1"),
            "--set:1:15: solver.newton.tolerence: is no known key; did you mean \"tolerance\"?");
  EXPECT_EQ(
      errors_of_override("bodies.beam.domain.torus.radius=1"),
      "--set:1:20: bodies.beam.domain.torus: is no known key; known here: box, block, cylinder, ellipsoid, sphere, "
      "file, unit, refine, rectangle, annulus, line, between, where, as");
}

TEST(Overrides, WrongPaths) {
  EXPECT_EQ(errors_of_override("title"), "--set:1:1: \"title\" has no =; must be key.path=value");
  EXPECT_EQ(errors_of_override("=3"), "--set:1:1: a part of the key is empty; must be key.path=value");
  EXPECT_EQ(errors_of_override("world..gravity=3"), "--set:1:7: a part of the key is empty; must be key.path=value");
  EXPECT_EQ(errors_of_override("constraints[2].fix=all"),
            "--set:1:13: constraints[2]: \"2\" is no index of this list; must be from 0 to 1");
  EXPECT_EQ(errors_of_override("constraints.fix=all"),
            "--set:1:13: constraints: \"fix\" is no index of this list; must be from 0 to 1");
  EXPECT_EQ(errors_of_override("materials.soft.young.x=1"),
            "--set:1:22: materials.soft.young.x: \"40 kPa\" has no key \"x\"; set the whole value");
}

TEST(Overrides, ErrorsOfTheFileComeFirst) {
  EXPECT_EQ(
      test::errors_of_beam("titel = 1\n", {"foo=1"}),
      "a.toml:10:1: bodies.beam.titel: is no known key; known here: model, domain, mass, density, material, "
      "frames, points, weights, initial, transform, thickness, radius, inertia, fluid, need, formulation, order, "
      "incompressibility, locking\n"
      "--set:1:1: foo: is no known key; known here: title, silence, world, materials, bodies, constraints, loads, "
      "couplings, solver, "
      "probes, output, need");
}

}  // namespace
}  // namespace fascia::app::overrides_test
