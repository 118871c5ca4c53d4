#include "tests/unit/app/scene_text.hpp"

#include <gtest/gtest.h>

// What is wrong with shells. The domain starts at column 12 of line 6, further keys at line 7.
namespace fascia::app::shells_errors_test {
namespace {

using test::errors_of;
using test::shell_body;

std::string errors_of_domain(const std::string& domain) { return errors_of(shell_body(domain, "thickness = 1\n")); }
std::string errors_of_cylinder(const std::string& more) {
  return errors_of_domain("cylinder = { from = [0, 0, 0], to = [0, 0, 1], radius = 1, " + more + " }");
}
std::string errors_of_annulus(const std::string& keys) {
  return errors_of_domain("annulus = { center = [0, 0, 0], " + keys + " }");
}

TEST(ShellErrors, KeysOfOtherModels) {
  EXPECT_EQ(errors_of(shell_body("file = \"a.stl\"",
                                 "thickness = 1\nframes = { count = 9 }\npoints = { count = 9 }\n"
                                 "weights = { kind = \"mls\" }\nradius = 1\nformulation = \"linear\"\norder = 2\n"
                                 "incompressibility = 1\nlocking = \"none\"\n")),
            "a.toml:8:10: bodies.skin.frames: is not used by model = \"shell\"; remove it\n"
            "a.toml:9:10: bodies.skin.points: is not used by model = \"shell\"; remove it\n"
            "a.toml:10:11: bodies.skin.weights: is not used by model = \"shell\"; remove it\n"
            "a.toml:11:10: bodies.skin.radius: is not used by model = \"shell\"; remove it\n"
            "a.toml:12:15: bodies.skin.formulation: is not used by model = \"shell\"; remove it\n"
            "a.toml:13:9: bodies.skin.order: is not used by model = \"shell\"; remove it\n"
            "a.toml:14:21: bodies.skin.incompressibility: is not used by model = \"shell\"; remove it\n"
            "a.toml:15:11: bodies.skin.locking: is not used by model = \"shell\"; remove it");
}

TEST(ShellErrors, ThicknessAndMaterial) {
  EXPECT_EQ(errors_of(shell_body("file = \"a.stl\"", "")),
            "a.toml:4:1: bodies.skin.thickness: is missing for model = \"shell\"; must be a length in m above 0, or a "
            "list by region");
  EXPECT_EQ(errors_of(shell_body("file = \"a.stl\"", "thickness = 0\n")),
            "a.toml:7:13: bodies.skin.thickness: 0 is out of range; must be above 0");
  EXPECT_EQ(errors_of(shell_body("file = \"a.stl\"", "thickness = [{ value = \"-1 mm\" }]\n")),
            "a.toml:7:24: bodies.skin.thickness[0].value: \"-1 mm\" is out of range; must be above 0");
  std::string text = shell_body("file = \"a.stl\"", "thickness = 1\n");
  EXPECT_EQ(errors_of(text.replace(text.find("young"), 0, "law = \"neo-hookean\"\n")),
            "a.toml:10:12: bodies.skin.material: has the law \"neo-hookean\", which shells do not take; must be of the "
            "law \"st-venant-kirchhoff\"");
}

TEST(ShellErrors, SolidsAndLinesAreNoSurfaces) {
  const char* message =
      ": is no surface, which model = \"shell\" needs; must be rectangle, annulus, cylinder, ellipsoid, sphere or file";
  EXPECT_EQ(errors_of_domain("box = { min = [0, 0, 0], max = [4, 1, 1] }"),
            std::string("a.toml:6:18: bodies.skin.domain.box") + message);
  EXPECT_EQ(errors_of_domain("line = { from = [0, 0, 0], to = [0, 0, 3] }"),
            std::string("a.toml:6:19: bodies.skin.domain.line") + message);
}

TEST(ShellErrors, Cells) {
  const char* two =
      "is missing for model = \"shell\"; must be a list of 2, each a whole number from 1 to 10000; or "
      "state what the results must be worth in [need], which then chooses it";
  EXPECT_EQ(errors_of_domain(std::string(test::rectangle)),
            std::string("a.toml:6:24: bodies.skin.domain.rectangle.cells: ") + two);
  EXPECT_EQ(errors_of_cylinder("caps = false"), std::string("a.toml:6:23: bodies.skin.domain.cylinder.cells: ") + two);
  EXPECT_EQ(errors_of_domain("sphere = { center = [0, 0, 0], radius = 1 }"),
            "a.toml:6:21: bodies.skin.domain.sphere.cells: is missing for model = \"shell\"; must be a list of 1, each "
            "a whole number from 1 to 10000; or state what the results must be worth in [need], which then chooses it");
  EXPECT_EQ(errors_of_domain("sphere = { center = [0, 0, 0], radius = 1, cells = [8, 2] }"),
            "a.toml:6:63: bodies.skin.domain.sphere.cells: has two numbers, as of a solid; must be one for model = "
            "\"shell\", the cells around");
  EXPECT_EQ(errors_of_domain("ellipsoid = { center = [0, 0, 0], radii = [1, 1, 1], cells = [6] }"),
            "a.toml:6:74: bodies.skin.domain.ellipsoid.cells[0]: 6 cells around are no multiple of 4; must be 4 or 8");
  EXPECT_EQ(errors_of_cylinder("cells = [1, 2]"),
            "a.toml:6:79: bodies.skin.domain.cylinder.cells: 2 cells around enclose nothing; must be at least 3 where "
            "closed");
  EXPECT_EQ(errors_of_cylinder("cells = [10000, 10000]"),
            "a.toml:6:79: bodies.skin.domain.cylinder.cells: asks for about 1e+08 cells; must be at most 10000000");
  EXPECT_EQ(errors_of_cylinder("cells = [1, 8], diagonal = \"rigth\""),
            "a.toml:6:98: bodies.skin.domain.cylinder.diagonal: \"rigth\" is no known value; must be \"right\", "
            "\"left\" or \"alternating\" (did you mean \"right\"?)");
  EXPECT_EQ(errors_of_domain("sphere = { center = [0, 0, 0], radius = 1, cells = [8], diagonal = \"left\" }"),
            "a.toml:6:68: bodies.skin.domain.sphere.diagonal: is no known key; known here: center, radius, cells");
}

TEST(ShellErrors, Turns) {
  const char* turn = "; must be ascending, by a whole turn at most, degrees with their unit (\"360 degree\")";
  EXPECT_EQ(errors_of_cylinder("cells = [1, 8], angle = [1, 1]"),
            std::string("a.toml:6:95: bodies.skin.domain.cylinder.angle: goes from 1 to 1 rad") + turn);
  EXPECT_EQ(errors_of_cylinder("cells = [1, 8], angle = [0, 7]"),
            std::string("a.toml:6:95: bodies.skin.domain.cylinder.angle: goes from 0 to 7 rad") + turn);
  EXPECT_EQ(errors_of_cylinder("cells = [1, 8], angle = [0, 1], caps = true, closed = true"),
            "a.toml:6:110: bodies.skin.domain.cylinder.caps: a skin that does not close around the axis has no caps; "
            "must be false\n"
            "a.toml:6:125: bodies.skin.domain.cylinder.closed: a sector has two edges apart; must be false, or angle a "
            "whole turn");
  EXPECT_EQ(errors_of_cylinder("cells = [1, 8], angle = [\"1 m\", 1]"),
            "a.toml:6:96: bodies.skin.domain.cylinder.angle[0]: \"1 m\" is a length; must be an angle in rad, "
            "such as \"90 degree\"");
}

TEST(ShellErrors, Annulus) {
  EXPECT_EQ(errors_of_annulus("normal = [0, 0, 0], inner = 2, outer = 1, cells = [1, 8]"),
            "a.toml:6:53: bodies.skin.domain.annulus.normal: has no direction; must be a vector of a length other than "
            "0\n"
            "a.toml:6:83: bodies.skin.domain.annulus.outer: 1 m is not above inner, 2 m; must be above it");
  EXPECT_EQ(errors_of_annulus("normal = [0, 0, 1], inner = 0, outer = 1, cells = [1, 8]"),
            "a.toml:6:72: bodies.skin.domain.annulus.inner: 0 is out of range; must be above 0");
}

TEST(ShellErrors, OthersHaveNoFieldsOfShells) {
  EXPECT_EQ(test::errors_of_beam("[output]\nfields = [\"stress\", \"director\"]\n"),
            "a.toml:11:10: output.fields: \"director\" is a field of shells, and no body is one; remove it");
  EXPECT_EQ(test::errors_of_beam("[output]\npicture = { field = \"thickness\" }\n"),
            "a.toml:11:21: output.picture.field: \"thickness\" is a field of shells, and no body is one; remove it");
}

TEST(ShellErrors, OthersTakeNoKeysOfSurfaces) {
  const std::string skin =
      "cylinder = { from = [0, 0, 0], to = [1, 0, 0], radius = 1, diagonal = \"left\", closed = true, caps = true }";
  EXPECT_EQ(errors_of(test::beam_with("box = { min = [0, 0, 0], max = [4, 1, 1] }", skin)),
            "a.toml:6:82: bodies.beam.domain.cylinder.diagonal: is not used by a solid; remove it\n"
            "a.toml:6:99: bodies.beam.domain.cylinder.closed: is not used by a solid; remove it\n"
            "a.toml:6:112: bodies.beam.domain.cylinder.caps: is not used by a solid; remove it");
  const std::string ring = "annulus = { center = [0, 0, 0], normal = [0, 0, 1], inner = 1, outer = 2, cells = [1, 8] }";
  EXPECT_EQ(errors_of(test::beam_with("box = { min = [0, 0, 0], max = [4, 1, 1] }", ring)),
            "a.toml:4:1: bodies.beam.thickness: is missing for an annulus; must be a length in m above 0, or a list by "
            "region\n"
            "a.toml:6:94: bodies.beam.domain.annulus.cells: is not used by model = \"meshless\"; remove it\n"
            "a.toml:9:19: bodies.beam.frames.grid: cannot fill an annulus, or sheets and lines of a mesh (thickness or "
            "radius is given); use poisson_disk or count");
  EXPECT_EQ(errors_of(test::mesh_body("tetrahedra", ring)),
            "a.toml:6:22: bodies.block.domain.annulus: is no solid, which model = \"tetrahedra\" needs; must be box, "
            "block, cylinder, ellipsoid, sphere or file");
  EXPECT_EQ(errors_of(test::mesh_body("hexahedra", "sphere = { center = [0, 0, 0], radius = 1, cells = [8] }")),
            "a.toml:6:63: bodies.block.domain.sphere.cells: has one number, as of a shell; must be a list of 2, each a "
            "whole number from 1 to 10000 for model = \"hexahedra\"");
}

}  // namespace
}  // namespace fascia::app::shells_errors_test
