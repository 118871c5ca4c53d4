#include "tests/unit/app/scene_text.hpp"

#include <gtest/gtest.h>

// What is wrong with domains, frames, points and weights. The beam's frames stand at column 12 of line 9.
namespace fascia::app::frames_errors_test {
namespace {

using test::beam_with;
using test::errors_of;
using test::errors_of_beam;

constexpr const char* sheet_grid = "thickness = 1\nframes = { grid = [5, 3] }\n";
constexpr const char* line_grid = "radius = 1\nframes = { grid = [5] }\n";

std::string errors_of_frames(const std::string& frames, const std::string& more = "") {
  return errors_of(beam_with("{ grid = [5, 2, 2] }", frames) + more);
}
std::string errors_of_domain(std::string_view domain) { return errors_of(test::thin_body(domain, sheet_grid)); }
std::string errors_of_sheet(const std::string& more) { return errors_of(test::thin_body(test::rectangle, more)); }
std::string errors_of_line(const std::string& more) { return errors_of(test::thin_body(test::line, more)); }
std::string errors_of_mesh(const std::string& more) { return errors_of(test::thin_body(test::mesh, more)); }

TEST(ThinBodyErrors, Shapes) {
  EXPECT_EQ(errors_of_domain("rectangle = { origin = [0, 0, 0], edge_u = [2, 0, 0], edge_v = [-4, 1e-9, 0] }"),
            "a.toml:6:75: bodies.skin.domain.rectangle.edge_v: is parallel to edge_u; must have another direction");
  EXPECT_EQ(errors_of_domain("rectangle = { origin = [0, 0, 0], edge_u = [0, 0, 0], edge_v = [0, 1, 0] }"),
            "a.toml:6:55: bodies.skin.domain.rectangle.edge_u: has no direction; must be a vector of a length other "
            "than 0");
  EXPECT_EQ(errors_of_domain("rectangle = { origin = [0, 0, 0], edge_u = [1, 0, 0] }"),
            "a.toml:6:24: bodies.skin.domain.rectangle.edge_v: is missing; must be a list of 3, each a length in m");
  EXPECT_EQ(errors_of_domain(
                "rectangle = { origin = [0, 0, 0], edge_u = [1e-120, 0, 0], edge_v = [0, 1e-120, 0], cells = [1, 1] }"),
            "a.toml:6:104: bodies.skin.domain.rectangle.cells: is not used by model = \"meshless\"; remove it");
  EXPECT_EQ(errors_of(test::thin_body("line = { from = [1, 0, 0], to = [\"1 m\", 0, 0] }", line_grid)),
            "a.toml:6:44: bodies.skin.domain.line.to: is the same point as from; must be another point");
}

TEST(ThinBodyErrors, ThicknessAndRadius) {
  EXPECT_EQ(
      errors_of_sheet("frames = { grid = [5, 3] }\n"),
      "a.toml:4:1: bodies.skin.thickness: is missing for a rectangle; must be a length in m above 0, or a list by "
      "region");
  EXPECT_EQ(errors_of_line("frames = { grid = [5] }\n"),
            "a.toml:4:1: bodies.skin.radius: is missing for a line; must be a length in m above 0");
  EXPECT_EQ(errors_of_sheet(std::string(sheet_grid) + "radius = 1\n"),
            "a.toml:9:10: bodies.skin.radius: is not used by a rectangle, which has thickness; remove it");
  EXPECT_EQ(errors_of_line(std::string(line_grid) + "thickness = 1\n"),
            "a.toml:9:13: bodies.skin.thickness: is not used by a line, which has radius; remove it");
  EXPECT_EQ(errors_of_beam("thickness = 1\nradius = 1\n"),
            "a.toml:10:13: bodies.beam.thickness: is not used by a solid; remove it\n"
            "a.toml:11:10: bodies.beam.radius: is not used by a solid; remove it");
}

TEST(ThinBodyErrors, ValuesOfThickness) {
  const auto errors = [](const std::string& thickness) {
    return errors_of_sheet("thickness = " + thickness + "\nframes = { grid = [5, 3] }\n");
  };
  EXPECT_EQ(errors("0"), "a.toml:7:13: bodies.skin.thickness: 0 is out of range; must be above 0");
  EXPECT_EQ(errors("true"),
            "a.toml:7:13: bodies.skin.thickness: true is of the wrong type; must be a length in m above 0 or a list, "
            "each a table with value");
  EXPECT_EQ(errors("[]"),
            "a.toml:7:13: bodies.skin.thickness: an empty list is of the wrong length; must be a list, each a table "
            "with value");
  EXPECT_EQ(errors("[{ where = \"all\" }]"),
            "a.toml:7:14: bodies.skin.thickness[0].value: is missing; must be a length in m above 0");
  EXPECT_EQ(errors("[{ value = 1 }, { value = \"-2 mm\" }]"),
            "a.toml:7:14: bodies.skin.thickness[0]: has no where, so that no later entry can match; must be the last "
            "one\n"
            "a.toml:7:39: bodies.skin.thickness[1].value: \"-2 mm\" is out of range; must be above 0");
  EXPECT_EQ(errors_of_line("radius = \"-1 mm\"\nframes = { grid = [5] }\n"),
            "a.toml:7:10: bodies.skin.radius: \"-1 mm\" is out of range; must be above 0");
}

TEST(ThinBodyErrors, AWrongDomainIsTheOnlyError) {
  EXPECT_EQ(
      errors_of_domain("between = [\"a\"]"),
      "a.toml:6:22: bodies.skin.domain.between: a list of 1 is of the wrong length; must be a list of 2, each the name "
      "of a body");
}

TEST(FrameErrors, GridsHaveANumberForEachDirection) {
  EXPECT_EQ(errors_of_frames("{ grid = [5, 2] }"),
            "a.toml:9:19: bodies.beam.frames.grid: a list of 2 is of the wrong length; a solid takes 3, along x, y and "
            "z");
  EXPECT_EQ(errors_of_sheet("thickness = 1\nframes = { grid = [5, 2, 2] }\n"),
            "a.toml:8:19: bodies.skin.frames.grid: a list of 3 is of the wrong length; a rectangle takes 2, along "
            "edge_u and edge_v");
  EXPECT_EQ(errors_of_line("radius = 1\nframes = { grid = [5, 2] }\n"),
            "a.toml:8:19: bodies.skin.frames.grid: a list of 2 is of the wrong length; a line takes 1, along the line");
  EXPECT_EQ(errors_of_mesh("frames = { grid = [5] }\n"),
            "a.toml:7:19: bodies.skin.frames.grid: a list of 1 is of the wrong length; a solid takes 3, along x, y and "
            "z");
  EXPECT_EQ(
      errors_of_frames("{ grid = [] }"),
      "a.toml:9:19: bodies.beam.frames.grid: an empty list is of the wrong length; must be a list of 1 to 3, each "
      "a whole number from 2 to 1000");
  EXPECT_EQ(errors_of_line("radius = 1\nframes = { grid = [1] }\n"),
            "a.toml:8:20: bodies.skin.frames.grid[0]: 1 is out of range; must be from 2 to 1000");
}

TEST(FrameErrors, MeshesOfSheetsAndLinesTakeNoGrid) {
  const char* message =
      "cannot fill an annulus, or sheets and lines of a mesh (thickness or radius is given); use poisson_disk or "
      "count";
  EXPECT_EQ(errors_of_mesh("thickness = 1\nframes = { grid = [5, 3] }\n"),
            std::string("a.toml:8:19: bodies.skin.frames.grid: ") + message);
  EXPECT_EQ(errors_of_mesh("radius = 1\nframes = { grid = [5, 3, 3] }\npoints = { per_cell = [2, 2, 2] }\n"),
            std::string("a.toml:8:19: bodies.skin.frames.grid: ") + message);
}

TEST(FrameErrors, ScatteredFrames) {
  EXPECT_EQ(errors_of_frames("{ poisson_disk = 0 }"),
            "a.toml:9:27: bodies.beam.frames.poisson_disk: 0 is out of range; must be above 0");
  EXPECT_EQ(errors_of_frames("{ count = 0 }"),
            "a.toml:9:20: bodies.beam.frames.count: 0 is out of range; must be from 1 to 10000000");
  EXPECT_EQ(errors_of_frames("{ count = 10000001 }"),
            "a.toml:9:20: bodies.beam.frames.count: 10000001 is out of range; must be from 1 to 10000000");
  EXPECT_EQ(errors_of_frames("{ poisson_disk = 1, count = 5 }"),
            "a.toml:9:38: bodies.beam.frames.count: cannot stand beside poisson_disk; give only one of them");
  EXPECT_EQ(errors_of_frames("{ kind = \"rigid\" }"),
            "a.toml:9:10: bodies.beam.frames: grid, poisson_disk, count, positions or file is missing; give exactly "
            "one");
  EXPECT_EQ(errors_of_frames("{ count = 5, kind = \"afine\" }"),
            "a.toml:9:30: bodies.beam.frames.kind: \"afine\" is no known value; must be \"rigid\" or \"affine\" (did "
            "you mean \"affine\"?)");
  EXPECT_EQ(errors_of_frames("{ file = \"\" }"),
            "a.toml:9:19: bodies.beam.frames.file: is empty; must be the path of a CSV file");
}

TEST(FrameErrors, ListedFrames) {
  EXPECT_EQ(errors_of_frames("{ positions = [] }"),
            "a.toml:9:24: bodies.beam.frames.positions: an empty list is of the wrong length; must be a list, each a "
            "list of 3, each a length in m");
  EXPECT_EQ(errors_of_frames("{ positions = [[0, 0, 0], [1, 0]] }"),
            "a.toml:9:36: bodies.beam.frames.positions[1]: a list of 2 is of the wrong length; must be a list of 3, "
            "each a length in m");
  EXPECT_EQ(errors_of_frames("{ positions = [[0, 0, 0], [1, 0, 0]], rotations = [[0, 0, 0]] }"),
            "a.toml:9:60: bodies.beam.frames.rotations: a list of 1 does not fit positions, a list of 2; must be as "
            "long");
  EXPECT_EQ(errors_of_frames("{ count = 5, rotations = [[0, 0, 0]] }"),
            "a.toml:9:35: bodies.beam.frames.rotations: is used only with positions; remove it");
}

TEST(FrameErrors, SeedsBelongToRandomSamples) {
  const char* message = "is used only with poisson_disk or count; remove it";
  EXPECT_EQ(errors_of_frames("{ grid = [5, 2, 2], seed = 3 }"),
            std::string("a.toml:9:37: bodies.beam.frames.seed: ") + message);
  EXPECT_EQ(errors_of_frames("{ positions = [[0, 0, 0]], seed = 3 }"),
            std::string("a.toml:9:44: bodies.beam.frames.seed: ") + message);
  EXPECT_EQ(errors_of_frames("{ file = \"f.csv\", seed = 3 }"),
            std::string("a.toml:9:35: bodies.beam.frames.seed: ") + message);
  EXPECT_EQ(errors_of_beam("points = { seed = 3 }\n"),
            std::string("a.toml:10:19: bodies.beam.points.seed: ") + message);
  EXPECT_EQ(errors_of_frames("{ count = 3, seed = -1 }"),
            "a.toml:9:30: bodies.beam.frames.seed: -1 is out of range; must be from 0 to 2147483647");
}

TEST(PointErrors, PerCellFollowsTheGrid) {
  EXPECT_EQ(
      errors_of_beam("points = { per_cell = [2, 2] }\n"),
      "a.toml:10:23: bodies.beam.points.per_cell: a list of 2 is of the wrong length; a solid takes 3, along x, y "
      "and z");
  EXPECT_EQ(errors_of_sheet(std::string(sheet_grid) + "points = { per_cell = [2, 2, 2] }\n"),
            "a.toml:9:23: bodies.skin.points.per_cell: a list of 3 is of the wrong length; a rectangle takes 2, along "
            "edge_u and edge_v");
  EXPECT_EQ(
      errors_of_frames("{ count = 5 }", "points = { per_cell = [2, 2, 2] }\n"),
      "a.toml:10:23: bodies.beam.points.per_cell: needs the cells of grid frames; use poisson_disk, count or file "
      "for scattered frames");
}

TEST(PointErrors, GridsOfSolidsTakeNoScatteredPoints) {
  EXPECT_EQ(errors_of_beam("points = { poisson_disk = 1 }\n"),
            "a.toml:10:27: bodies.beam.points.poisson_disk: grid frames of a solid take per_cell; use it, or scattered "
            "frames");
  EXPECT_EQ(errors_of_sheet(std::string(sheet_grid) + "points = { count = 9 }\n"), "");
  EXPECT_EQ(errors_of_line(std::string(line_grid) + "points = { file = \"p.csv\" }\n"), "");
  EXPECT_EQ(errors_of_frames("{ count = 5 }", "points = { count = 100000001 }\n"),
            "a.toml:10:20: bodies.beam.points.count: 100000001 is out of range; must be from 1 to 100000000");
}

TEST(PointErrors, ThroughBelongsToSheets) {
  EXPECT_EQ(errors_of_beam("points = { through = 2 }\n"),
            "a.toml:10:22: bodies.beam.points.through: is used only by sheets, not by a solid; remove it");
  EXPECT_EQ(errors_of_mesh("frames = { count = 9 }\npoints = { through = 1 }\n"),
            "a.toml:8:22: bodies.skin.points.through: is used only by sheets, not by a solid; remove it");
  const char* line = "2 is not used by a line, whose section has 4 points; must be 1 (the 2014 paper's rule)";
  EXPECT_EQ(errors_of_line(std::string(line_grid) + "points = { through = 2 }\n"),
            std::string("a.toml:9:22: bodies.skin.points.through: ") + line);
  EXPECT_EQ(errors_of_mesh("radius = 1\nframes = { count = 9 }\npoints = { through = 2 }\n"),
            std::string("a.toml:9:22: bodies.skin.points.through: ") + line);
  EXPECT_EQ(errors_of_mesh("thickness = 0\nframes = { count = 9 }\npoints = { through = 2 }\n"),
            "a.toml:7:13: bodies.skin.thickness: 0 is out of range; must be above 0");
  EXPECT_EQ(errors_of_sheet(std::string(sheet_grid) + "points = { through = 11 }\n"),
            "a.toml:9:22: bodies.skin.points.through: 11 is out of range; must be from 1 to 10");
}

TEST(WeightErrors, KindsGoWithTheFrames) {
  const char* for_scattered =
      " needs grid frames; must be \"mls\", \"shepard\", \"wendland\" or \"cubic-spline\" for scattered frames";
  for (const std::string kind : {"\"trilinear\"", "\"linear\""})
    EXPECT_EQ(errors_of_frames("{ count = 5 }", "weights = { kind = " + kind + " }\n"),
              "a.toml:10:20: bodies.beam.weights.kind: " + kind + for_scattered);
  for (const std::string kind : {"\"mls\"", "\"shepard\"", "\"wendland\"", "\"cubic-spline\""})
    EXPECT_EQ(errors_of_beam("weights = { kind = " + kind + " }\n"),
              "a.toml:10:20: bodies.beam.weights.kind: " + kind +
                  " needs scattered frames; must be \"trilinear\" or \"linear\" on a grid");
  EXPECT_EQ(errors_of_sheet(std::string(sheet_grid) + "weights = { kind = \"mls\" }\n"),
            "a.toml:9:20: bodies.skin.weights.kind: \"mls\" needs scattered frames; must be \"trilinear\" on a grid");
  EXPECT_EQ(errors_of_sheet(std::string(sheet_grid) + "weights = { kind = \"linear\" }\n"),
            "a.toml:9:20: bodies.skin.weights.kind: \"linear\" needs the grid of a solid; must be \"trilinear\" for a "
            "rectangle");
}

TEST(WeightErrors, ReachBelongsToScatteredFrames) {
  EXPECT_EQ(errors_of_beam("weights = { neighbours = 8 }\n"),
            "a.toml:10:26: bodies.beam.weights.neighbours: is used only by the weights of scattered frames; remove it");
  EXPECT_EQ(errors_of_line(std::string(line_grid) + "weights = { radius = 8 }\n"),
            "a.toml:9:22: bodies.skin.weights.radius: is used only by the weights of scattered frames; remove it");
  EXPECT_EQ(errors_of_frames("{ count = 5 }", "weights = { neighbours = 8, radius = 1 }\n"),
            "a.toml:10:38: bodies.beam.weights.radius: cannot stand beside neighbours; give only one of them");
  EXPECT_EQ(errors_of_frames("{ count = 5 }", "weights = { neighbours = 0 }\n"),
            "a.toml:10:26: bodies.beam.weights.neighbours: 0 is out of range; must be from 1 to 1000");
  EXPECT_EQ(errors_of_frames("{ count = 5 }", "weights = { radius = \"0 mm\" }\n"),
            "a.toml:10:22: bodies.beam.weights.radius: \"0 mm\" is out of range; must be above 0");
}

TEST(WeightErrors, HalfBlendNeedsLinearConsistency) {
  for (const std::string kind : {"shepard", "wendland", "cubic-spline"})
    EXPECT_EQ(errors_of_frames("{ count = 5 }", "weights = { blend = \"half\", kind = \"" + kind + "\" }\n"),
              "a.toml:10:21: bodies.beam.weights.blend: \"half\" is not sound for weights of kind \"" + kind +
                  "\", which do not reproduce linear fields; must be \"full\"");
}

}  // namespace
}  // namespace fascia::app::frames_errors_test
