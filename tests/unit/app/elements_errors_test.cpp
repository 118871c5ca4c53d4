#include "tests/unit/app/scene_text.hpp"

#include <gtest/gtest.h>

// What is wrong with tetrahedra and hexahedra. The domain starts at column 12 of line 6, further keys at line 9.
namespace fascia::app::elements_errors_test {
namespace {

using test::beam_with;
using test::errors_of;
using test::mesh_body;
using test::meshed_box;

std::string errors_of_tetrahedra(const std::string& more) {
  return errors_of(mesh_body("tetrahedra", meshed_box, more));
}
std::string errors_of_hexahedra(const std::string& more) { return errors_of(mesh_body("hexahedra", meshed_box, more)); }
std::string errors_of_domain(const std::string& domain, std::string_view model = "tetrahedra") {
  return errors_of(mesh_body(model, domain));
}
std::string errors_of_box(const std::string& more, std::string_view model = "tetrahedra") {
  return errors_of_domain("box = { min = [0, 0, 0], max = [4, 1, 1]" + more + " }", model);
}

/// A unit cube with one corner elsewhere.
std::string errors_of_block(std::size_t corner, const std::string& by) {
  std::array<std::string, 8> corners{"[0, 0, 0]", "[1, 0, 0]", "[1, 1, 0]", "[0, 1, 0]",
                                     "[0, 0, 1]", "[1, 0, 1]", "[1, 1, 1]", "[0, 1, 1]"};
  corners[corner] = by;
  std::string list;
  for (const std::string& c : corners) list += (list.empty() ? "" : ", ") + c;
  return errors_of_domain("block = { corners = [" + list + "], cells = [1, 1, 1] }");
}

TEST(ElementErrors, KeysOfMeshlessBodies) {
  EXPECT_EQ(errors_of_tetrahedra("frames = { grid = [2, 2, 2] }\npoints = { per_cell = [2, 2, 2] }\n"
                                 "weights = { kind = \"linear\" }\nthickness = 1\nradius = 1\n"),
            "a.toml:9:10: bodies.block.frames: is not used by model = \"tetrahedra\"; remove it\n"
            "a.toml:10:10: bodies.block.points: is not used by model = \"tetrahedra\"; remove it\n"
            "a.toml:11:11: bodies.block.weights: is not used by model = \"tetrahedra\"; remove it\n"
            "a.toml:12:13: bodies.block.thickness: is not used by model = \"tetrahedra\"; remove it\n"
            "a.toml:13:10: bodies.block.radius: is not used by model = \"tetrahedra\"; remove it");
  EXPECT_EQ(errors_of_hexahedra("frames = { count = 9 }\n"),
            "a.toml:9:10: bodies.block.frames: is not used by model = \"hexahedra\"; remove it");
}

TEST(ElementErrors, MeshlessBodiesTakeNoKeysOfElements) {
  EXPECT_EQ(test::errors_of_beam("formulation = \"linear\"\norder = 2\nincompressibility = 1\nlocking = \"none\"\n"),
            "a.toml:10:15: bodies.beam.formulation: is not used by model = \"meshless\"; remove it\n"
            "a.toml:11:9: bodies.beam.order: is not used by model = \"meshless\"; remove it\n"
            "a.toml:12:21: bodies.beam.incompressibility: is not used by model = \"meshless\"; remove it\n"
            "a.toml:13:11: bodies.beam.locking: is not used by model = \"meshless\"; remove it");
  EXPECT_EQ(errors_of(beam_with("max = [4, 1, 1] }", "max = [4, 1, 1], cells = [1, 1, 1], split = 6 }")),
            "a.toml:6:62: bodies.beam.domain.box.cells: is not used by model = \"meshless\"; remove it\n"
            "a.toml:6:81: bodies.beam.domain.box.split: is not used by model = \"meshless\"; remove it");
  EXPECT_EQ(errors_of(beam_with("box = { min = [0, 0, 0], max = [4, 1, 1] }",
                                "ellipsoid = { center = [0, 0, 0], radii = [1, 1, 1], cells = [8, 2] }")),
            "a.toml:6:73: bodies.beam.domain.ellipsoid.cells: is not used by model = \"meshless\"; remove it");
  EXPECT_EQ(errors_of(beam_with("box = { min = [0, 0, 0], max = [4, 1, 1] }",
                                "block = { corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, "
                                "1], [1, 1, 1], [0, 1, 1]], cells = [1, 1, 1] }")),
            "a.toml:6:130: bodies.beam.domain.block.cells: is not used by model = \"meshless\"; remove it");
}

TEST(ElementErrors, Values) {
  EXPECT_EQ(errors_of_tetrahedra("formulation = \"corotation\"\n"),
            "a.toml:9:15: bodies.block.formulation: \"corotation\" is no known value; must be \"st-venant-kirchhoff\", "
            "\"corotational\" or \"linear\" (did you mean \"corotational\"?)");
  EXPECT_EQ(errors_of_tetrahedra("order = 3\n"),
            "a.toml:9:9: bodies.block.order: 3 is out of range; must be from 1 to 2");
  EXPECT_EQ(errors_of_tetrahedra("order = 1.5\n"),
            "a.toml:9:9: bodies.block.order: 1.5 is of the wrong type; must be a whole number from 1 to 2");
  EXPECT_EQ(errors_of_tetrahedra("incompressibility = \"-1 kPa\"\n"),
            "a.toml:9:21: bodies.block.incompressibility: \"-1 kPa\" is out of range; must be at least 0");
  EXPECT_EQ(errors_of_tetrahedra("incompressibility = \"1 m\"\n"),
            "a.toml:9:21: bodies.block.incompressibility: \"1 m\" is a length; must be a pressure in Pa, such as \"40 "
            "kPa\"");
  EXPECT_EQ(errors_of_tetrahedra("incompressibility = nan\n"),
            "a.toml:9:21: bodies.block.incompressibility: nan is not finite; must be a pressure in Pa at least 0");
  EXPECT_EQ(errors_of_tetrahedra("locking = \"fbar\"\n"),
            "a.toml:9:11: bodies.block.locking: \"fbar\" is no known value; must be \"none\" or \"f-bar\" (did you "
            "mean \"f-bar\"?)");
  EXPECT_EQ(errors_of_tetrahedra("lokcing = \"none\"\n"),
            "a.toml:9:1: bodies.block.lokcing: is no known key; did you mean \"locking\"?");
  EXPECT_EQ(errors_of(mesh_body("tetrahedron", meshed_box)),
            "a.toml:5:9: bodies.block.model: \"tetrahedron\" is no known value; must be \"meshless\", \"tetrahedra\", "
            "\"hexahedra\", \"shell\", \"rigid\" or \"surface\" (did you mean \"tetrahedra\"?)");
}

TEST(ElementErrors, RemediesBelongToTetrahedra) {
  EXPECT_EQ(errors_of_hexahedra("incompressibility = 1\nlocking = \"none\"\n"),
            "a.toml:9:21: bodies.block.incompressibility: is not used by model = \"hexahedra\"; remove it\n"
            "a.toml:10:11: bodies.block.locking: is not used by model = \"hexahedra\"; remove it");
  EXPECT_EQ(errors_of_hexahedra("locking = \"f-bar\"\norder = 2\n"),
            "a.toml:9:11: bodies.block.locking: is not used by model = \"hexahedra\"; remove it");
}

TEST(ElementErrors, FBarIsForLinearShapesAndLargeStrain) {
  EXPECT_EQ(errors_of_tetrahedra("locking = \"f-bar\"\norder = 2\n"),
            "a.toml:9:11: bodies.block.locking: \"f-bar\" needs order = 1; must be \"none\" with order = 2");
  for (const std::string formulation : {"corotational", "linear"})
    EXPECT_EQ(errors_of_tetrahedra("locking = \"f-bar\"\nformulation = \"" + formulation + "\"\n"),
              "a.toml:9:11: bodies.block.locking: \"f-bar\" needs large strain; must be \"none\" with formulation = "
              "\"" +
                  formulation + "\"");
}

/// Errors of a body of a material.
std::string errors(std::string text, const std::string& material) {
  return errors_of(text.replace(text.find("\"soft\""), 6, material));
}

TEST(ElementErrors, LawsAndFormulations) {
  const std::string rubber = "{ law = \"neo-hookean\", young = 1, poisson = 0.3 }";
  for (const std::string formulation : {"corotational", "linear"})
    EXPECT_EQ(errors(mesh_body("hexahedra", meshed_box, "formulation = \"" + formulation + "\"\n"), rubber),
              "a.toml:8:12: bodies.block.material: has the law \"neo-hookean\", which formulation = \"" + formulation +
                  "\" does not take; must be of the law \"st-venant-kirchhoff\", or change the formulation");
  EXPECT_EQ(errors(mesh_body("tetrahedra", meshed_box, "formulation = \"linear\"\n"),
                   "[{ where = { ids = [0] }, use = \"soft\" }, { use = " + rubber + " }]"),
            "a.toml:8:62: bodies.block.material[1].use: has the law \"neo-hookean\", which formulation = \"linear\" "
            "does not take; must be of the law \"st-venant-kirchhoff\", or change the formulation");
  EXPECT_EQ(errors(mesh_body("tetrahedra", meshed_box), "{ law = \"neo-hooke\", young = 1, poisson = 0.3 }"),
            "a.toml:8:20: bodies.block.material.law: \"neo-hooke\" is no known value; must be "
            "\"st-venant-kirchhoff\", \"neo-hookean\" or \"mooney-rivlin\" (did you mean \"neo-hookean\"?)");
  EXPECT_EQ(errors(mesh_body("tetrahedra", meshed_box), "{ law = \"neo-hookean\", lame = { lambda = -3, mu = 3 } }"),
            "a.toml:8:53: bodies.block.material.lame.lambda: -3 Pa gives no stable material; must be above -2/3 mu, -2 "
            "Pa");
}

TEST(ElementErrors, LawsTakeTheirOwnConstants) {
  const auto errors_of_material = [](const std::string& material) {
    return errors(mesh_body("tetrahedra", meshed_box), "{ " + material + " }");
  };
  EXPECT_EQ(errors_of_material("law = \"mooney-rivlin\", c10 = 1, c01 = 0, bulk = 9"), "");
  EXPECT_EQ(errors_of_material("law = \"mooney-rivlin\", c10 = 1, bulk = 9"),
            "a.toml:8:12: bodies.block.material.c01: is missing; the law \"mooney-rivlin\" needs it");
  EXPECT_EQ(errors_of_material("law = \"mooney-rivlin\", c10 = 1, c01 = 1"),
            "a.toml:8:12: bodies.block.material.bulk: is missing; the law \"mooney-rivlin\" needs it");
  EXPECT_EQ(errors_of_material("law = \"mooney-rivlin\", c10 = 1, c01 = -2, bulk = 9"),
            "a.toml:8:43: bodies.block.material.c10: makes a shear modulus of -2 Pa at small strain; must make one "
            "above 0");
  EXPECT_EQ(errors_of_material("law = \"mooney-rivlin\", c10 = 1, c01 = 1, bulk = 1e-300"),
            "a.toml:8:62: bodies.block.material.bulk: 1e-300 Pa beside a shear modulus of 4 Pa; must be 1e-09 to 1e+12 "
            "times as much");
  EXPECT_EQ(errors_of_material("law = \"mooney\", c10 = 1, c01 = 1, bulk = 9"),
            "a.toml:8:20: bodies.block.material.law: \"mooney\" is no known value; must be \"st-venant-kirchhoff\", "
            "\"neo-hookean\" or \"mooney-rivlin\"");
  EXPECT_EQ(errors_of_material("c10 = 1"),
            "a.toml:8:20: bodies.block.material.c10: is no constant of the law \"st-venant-kirchhoff\"; remove it, or "
            "add law = \"mooney-rivlin\"");
  EXPECT_EQ(errors_of_material("young = 1, poisson = 0.3, bulk = 9"),
            "a.toml:8:47: bodies.block.material.bulk: is no constant of the law \"st-venant-kirchhoff\"; remove it");
  EXPECT_EQ(errors_of_material("law = \"mooney-rivlin\", c10 = 1, c01 = 1, bulk = 9, poisson = 0.3"),
            "a.toml:8:75: bodies.block.material.poisson: is no constant of the law \"mooney-rivlin\"; remove it");
}

TEST(ElementErrors, WhatFadesLeavesAPart) {
  const auto errors_of_material = [](const std::string& material, std::string_view more = "") {
    return errors(mesh_body("tetrahedra", meshed_box, std::string(more)),
                  "{ young = 1, poisson = 0.3, " + material + " }");
  };
  EXPECT_EQ(errors_of_material("viscosity = [{ share = 0.4, time = \"0.5 s\" }, { share = 0.3, time = 8 }]"), "");
  EXPECT_EQ(errors_of_material("viscosity = []"),
            "a.toml:8:52: bodies.block.material.viscosity: an empty list is of the wrong length; must be a list, each "
            "a table with share, time");
  EXPECT_EQ(errors_of_material("viscosity = [{ share = 0.6, time = 1 }, { share = 0.4, time = 2 }]"),
            "a.toml:8:52: bodies.block.material.viscosity: has shares that sum up to 1; must sum up to less than "
            "0.999999, so that a part of the stiffness lasts");
  EXPECT_EQ(errors_of_material("viscosity = [{ share = 1, time = 0 }]"),
            "a.toml:8:63: bodies.block.material.viscosity[0].share: 1 is out of range; must be above 0 and below 1\n"
            "a.toml:8:73: bodies.block.material.viscosity[0].time: 0 is out of range; must be above 0");
  EXPECT_EQ(errors_of_material("viscosity = [{ share = 0.5 }]"),
            "a.toml:8:53: bodies.block.material.viscosity[0].time: is missing; must be a time in s above 0");
  EXPECT_EQ(errors_of_material("viscosity = [{ share = 0.5, tau = 1 }]"),
            "a.toml:8:53: bodies.block.material.viscosity[0].time: is missing; must be a time in s above 0\n"
            "a.toml:8:68: bodies.block.material.viscosity[0].tau: is no known key; known here: share, time");
  EXPECT_EQ(errors_of_material("relax = \"shear\", statics = \"instantaneous\""),
            "a.toml:8:48: bodies.block.material.relax: is used only beside viscosity; remove it\n"
            "a.toml:8:67: bodies.block.material.statics: is used only beside viscosity; remove it");
  EXPECT_EQ(errors_of_material("viscosity = [{ share = 0.5, time = 1 }], relax = \"sheer\""),
            "a.toml:8:89: bodies.block.material.relax: \"sheer\" is no known value; must be \"all\" or \"shear\" (did "
            "you mean \"shear\"?)");
  EXPECT_EQ(errors_of_material("viscosity = [{ share = 0.5, time = 1 }], damping = { stiffness = 0.1 }"),
            "a.toml:8:105: bodies.block.material.damping.stiffness: is a viscosity of its own; remove it, or the "
            "material's viscosity");
  EXPECT_EQ(errors_of_material("viscosity = [{ share = 0.5, time = 1 }], relax = \"shear\"", "locking = \"f-bar\"\n"),
            "a.toml:8:12: bodies.block.material: relaxes in shear alone, which elements with locking = \"f-bar\" do "
            "not; must have relax = \"all\"");
}

TEST(ElementErrors, ThinMeshlessBodiesTakeOneLaw) {
  const char* message =
      "has the law \"neo-hookean\", which thin bodies do not take; must be of the law \"st-venant-kirchhoff\"";
  const auto errors = [](std::string_view domain, std::string_view more) {
    std::string text = test::thin_body(domain, more);
    return errors_of(text.replace(text.find("young"), 0, "law = \"neo-hookean\"\n"));
  };
  EXPECT_EQ(errors(test::rectangle, "thickness = 1\nframes = { grid = [5, 3] }\n"),
            std::string("a.toml:11:12: bodies.skin.material: ") + message);
  EXPECT_EQ(errors(test::line, "radius = 1\nframes = { grid = [5] }\n"),
            std::string("a.toml:11:12: bodies.skin.material: ") + message);
  EXPECT_EQ(errors(test::mesh, "thickness = 1\nframes = { count = 5 }\n"),
            std::string("a.toml:11:12: bodies.skin.material: ") + message);
  EXPECT_EQ(errors(test::mesh, "frames = { count = 5 }\n"), "");
}

TEST(ElementErrors, CellsAreNeeded) {
  EXPECT_EQ(
      errors_of_box(""),
      "a.toml:6:18: bodies.block.domain.box.cells: is missing for model = \"tetrahedra\"; must be a list of 3, "
      "each a whole number from 1 to 10000; or state what the results must be worth in [need], which then chooses it");
  EXPECT_EQ(errors_of_domain("cylinder = { from = [0, 0, 0], to = [1, 0, 0], radius = 1 }", "hexahedra"),
            "a.toml:6:23: bodies.block.domain.cylinder.cells: is missing for model = \"hexahedra\"; must be a list of "
            "2, each a whole number from 1 to 10000; or state what the results must be worth in [need], which then "
            "chooses it");
  EXPECT_EQ(errors_of_box(", cells = [1, 1]"),
            "a.toml:6:62: bodies.block.domain.box.cells: a list of 2 is of the wrong length; must be a list of 3, each "
            "a whole number from 1 to 10000");
  EXPECT_EQ(errors_of_box(", cells = [1, 0, 1]"),
            "a.toml:6:66: bodies.block.domain.box.cells[1]: 0 is out of range; must be from 1 to 10000");
  EXPECT_EQ(errors_of_box(", cells = 3"),
            "a.toml:6:62: bodies.block.domain.box.cells: 3 is of the wrong type; must be a list of 3, each a whole "
            "number from 1 to 10000");
  EXPECT_EQ(errors_of_box(", cells = [1000, 1000, 1000]"),
            "a.toml:6:62: bodies.block.domain.box.cells: asks for about 1e+09 cells; must be at most 10000000");
  EXPECT_EQ(errors_of_domain("cylinder = { from = [0, 0, 0], to = [1, 0, 0], radius = 1, cells = [100, 1200] }"),
            "a.toml:6:79: bodies.block.domain.cylinder.cells: asks for about 2.1e+07 cells; must be at most 10000000");
  EXPECT_EQ(errors_of_domain("ellipsoid = { center = [0, 0, 0], radii = [1, 1, 1], cells = [400, 200] }"),
            "a.toml:6:73: bodies.block.domain.ellipsoid.cells: asks for about 1.3e+07 cells; must be at most 10000000");
  EXPECT_EQ(errors_of_domain("file = \"a.msh\", cells = [1, 1, 1]"),
            "a.toml:6:28: bodies.block.domain.cells: is no known key; known here: box, block, cylinder, ellipsoid, "
            "sphere, file, unit, refine, rectangle, annulus, line, between, where, as");
}

TEST(ElementErrors, CellsAround) {
  EXPECT_EQ(errors_of_domain("cylinder = { from = [0, 0, 0], to = [1, 0, 0], radius = 1, cells = [10, 10] }"),
            "a.toml:6:84: bodies.block.domain.cylinder.cells[1]: 10 cells around are no multiple of 4; must be 8 or "
            "12");
  EXPECT_EQ(errors_of_domain("ellipsoid = { center = [0, 0, 0], radii = [1, 1, 1], cells = [3, 2] }"),
            "a.toml:6:74: bodies.block.domain.ellipsoid.cells[0]: 3 cells around are no multiple of 4; must be 4");
  EXPECT_EQ(errors_of_domain("cylinder = { from = [0, 0, 0], to = [1, 0, 0], radius = 1, cells = [8, 8], caps = true, "
                             "angle = [0, 1] }"),
            "a.toml:6:94: bodies.block.domain.cylinder.caps: is not used by a solid; remove it\n"
            "a.toml:6:108: bodies.block.domain.cylinder.angle: is not used by a solid; remove it");
}

TEST(ElementErrors, SplitBelongsToTetrahedra) {
  EXPECT_EQ(errors_of_box(", cells = [1, 1, 1], split = 5", "hexahedra"),
            "a.toml:6:81: bodies.block.domain.box.split: is not used by model = \"hexahedra\"; remove it");
  EXPECT_EQ(errors_of_box(", cells = [1, 1, 1], split = 4"),
            "a.toml:6:81: bodies.block.domain.box.split: 4 is out of range; must be from 5 to 6");
  EXPECT_EQ(errors_of_domain("ellipsoid = { center = [0, 0, 0], radii = [1, 1, 1], cells = [8, 2], split = 5 }"),
            "a.toml:6:81: bodies.block.domain.ellipsoid.split: is no known key; known here: center, radii, cells");
}

TEST(ElementErrors, SurfacesAndLinesAreNoSolids) {
  EXPECT_EQ(errors_of_domain(std::string(test::rectangle)),
            "a.toml:6:24: bodies.block.domain.rectangle: is no solid, which model = \"tetrahedra\" needs; must be box, "
            "block, cylinder, ellipsoid, sphere or file");
  EXPECT_EQ(errors_of_domain(std::string(test::line), "hexahedra"),
            "a.toml:6:19: bodies.block.domain.line: is no solid, which model = \"hexahedra\" needs; must be box, "
            "block, cylinder, ellipsoid, sphere or file");
}

TEST(ElementErrors, BlocksAreNeitherInvertedNorFlat) {
  const char* place = "a.toml:6:32: bodies.block.domain.block.corners: ";
  const char* order =
      "; must be four corners of the lower face, counter-clockwise seen from above, then the four above them";
  EXPECT_EQ(errors_of_block(0, "[0.2, 0.1, 0.3]"), "");
  EXPECT_EQ(errors_of_block(6, "[1, 1, -1]"), std::string(place) + "the block is inverted at corner 2" + order);
  EXPECT_EQ(errors_of_block(7, "[0, 1, -1]"), std::string(place) + "the block is inverted at corner 3" + order);
  EXPECT_EQ(errors_of_block(4, "[0, 0, 0]"), std::string(place) + "the block is flat at corner 0" + order);
  EXPECT_EQ(errors_of_block(2, "[0, 0, 0]"), std::string(place) + "the block is flat at corner 1" + order);
  EXPECT_EQ(errors_of_domain("block = { corners = [[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0], [0, 0, 1], [0, 1, 1], "
                             "[1, 1, 1], [1, 0, 1]], cells = [1, 1, 1] }"),
            std::string(place) + "the block is inverted at corner 0" + order);
  EXPECT_EQ(errors_of_block(3, "[0, 1]"),
            "a.toml:6:66: bodies.block.domain.block.corners[3]: a list of 2 is of the wrong length; must be a list of "
            "3, each a length in m");
  EXPECT_EQ(errors_of_domain("block = { corners = [[0, 0, 0]], cells = [1, 1, 1] }"),
            std::string(place) +
                "a list of 1 is of the wrong length; must be a list of 8, each a list of 3, each a "
                "length in m");
  EXPECT_EQ(errors_of_domain("block = { cells = [1, 1, 1] }"),
            "a.toml:6:20: bodies.block.domain.block.corners: is missing; must be a list of 8, each a list of 3, each a "
            "length in m");
}

}  // namespace
}  // namespace fascia::app::elements_errors_test
