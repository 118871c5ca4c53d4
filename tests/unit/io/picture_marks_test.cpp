#include "io/picture/layout.hpp"
#include "io/picture/marks.hpp"
#include "io/picture/outline.hpp"
#include "io/picture/view.hpp"
#include "io/picture_description.hpp"
#include "tests/unit/io/mesh_samples.hpp"
#include "tests/unit/io/volume_samples.hpp"

#include <fstream>

// The things around the bodies of a picture, as far as no display is needed for them.
namespace fascia::io::picture_marks_test {
namespace {

using samples::row_of_cubes;
using samples::TemporaryDirectory;

/// A row of cubes that has moved by (0, 0, 1).
PictureBody moved_row(int cubes) {
  VisualMesh mesh = row_of_cubes(cubes, CellType::hexahedron, false);
  FieldArray rest{"rest_position", 3, {}};
  for (Vec3d& x : mesh.points) {
    rest.values.insert(rest.values.end(), x.v, x.v + 3);
    x += Vec3d{{0, 0, 1}};
  }
  mesh.point_fields.push_back(rest);
  const TemporaryDirectory directory;
  write_vtu(directory.path() / "row_00000.vtu", mesh);
  return read_picture_body(directory.path() / "row_00000.vtu", "");
}

TEST(PictureMarks, DescriptionIsReadAsItWasWritten) {
  const TemporaryDirectory directory;
  EXPECT_TRUE(read_description(directory.path()).states.empty());
  PictureDescription written;
  written.title = "Über \"sides\"";
  written.up = Vec3d{{0, 0.1, 1}};
  written.kind = StateKind::frequency;
  written.states = {12.4, 1500};
  written.end = "not-converged";
  written.supports = {{"row", {{0, 1, 0}}, false}};
  written.springs = {{"row", {{3, 1, 0}}, {{4, 0, 1e-12}}}};
  write_description(directory.path(), written);
  const PictureDescription read = read_description(directory.path());
  EXPECT_EQ(read.title, written.title);
  EXPECT_EQ(read.up, written.up);
  EXPECT_EQ(read.states, written.states);
  EXPECT_EQ(read.supports.at(0).X, written.supports[0].X);
  EXPECT_FALSE(read.supports.at(0).whole);
  EXPECT_EQ(read.springs.at(0).point, written.springs[0].point);
  EXPECT_EQ(state_label(read, 0), "mode 1: 12.4 Hz");
  EXPECT_EQ(state_label(read, 1), "mode 2: 1.5 kHz, not-converged");
  EXPECT_EQ(state_label(read, 2), "");
}

TEST(PictureMarks, LabelsTellStatesFromTheirNeighbours) {
  PictureDescription description;
  description.states = {10, 10.001, 10.002, 10.0021, 12345.6};
  EXPECT_EQ(state_label(description, 0), "t = 10 s");
  EXPECT_EQ(state_label(description, 1), "t = 10.001 s");
  EXPECT_EQ(state_label(description, 2), "t = 10.002 s");
  EXPECT_EQ(state_label(description, 3), "t = 10.0021 s");
  EXPECT_EQ(state_label(description, 4), "t = 12346 s");
  description.kind = StateKind::load_factor;
  description.states = {1, 1, 1.00001};
  EXPECT_EQ(state_label(description, 0), "load factor 1");
  EXPECT_EQ(state_label(description, 2), "load factor 1.00001");
}

TEST(PictureMarks, ForeignDescriptionIsNamed) {
  const TemporaryDirectory directory;
  for (const char* text : {"{}", "no JSON", "[1]", "{\"title\": 3}"}) {
    std::ofstream(directory.path() / "picture.json") << text;
    const std::string e = samples::input_error([&] { read_description(directory.path()); });
    EXPECT_NE(e.find("picture.json: is no description of pictures"), std::string::npos) << e;
  }
}

TEST(PictureMarks, GoWithTheirMaterial) {
  PictureDescription description;
  description.supports = {{"row", {{2, 1, 0}}, true}, {"row", {{2.25, 1, 0}}, false}, {"other", {{0, 0, 0}}, true}};
  description.springs = {{"row", {{3, 0, 0}}, {{5, 0, 0}}}};
  const Marks marks = find_marks(description, {moved_row(3)});
  ASSERT_EQ(marks.held.size(), 1u);
  EXPECT_LT(norm(marks.held[0] - Vec3d{{2, 1, 1}}), 1e-12);
  ASSERT_EQ(marks.held_in_part.size(), 1u);
  EXPECT_LT(norm(marks.held_in_part[0] - Vec3d{{2.25, 1, 1}}), 1e-12);
  ASSERT_EQ(marks.springs.size(), 1u);
  EXPECT_LT(norm(marks.springs[0][0] - Vec3d{{3, 0, 1}}), 1e-12);
  EXPECT_EQ(marks.springs[0][1], (Vec3d{{5, 0, 0}}));
}

TEST(PictureMarks, AreThinnedOut) {
  std::vector<Vec3d> places;
  for (int i = 0; i < 1000; ++i) places.push_back({{0.001 * i, 0, 0}});
  EXPECT_EQ(thinned(places, 0.1).size(), 10u);
  EXPECT_EQ(thinned(places, 1e-4).size(), 1000u);
}

TEST(PictureOutline, OfABoxHasTheEdgesOfItsNearSide) {
  const PictureBody body = moved_row(3);
  EXPECT_EQ(outline_of(*body.surface, {{1, 1, 1}})->GetNumberOfCells(), 3 + 3 * (2 + 2 * 1));
  EXPECT_EQ(outline_of(*body.surface, {{0, 0, 1}})->GetNumberOfCells(), 2 + 2 * 3);
}

TEST(PictureView, UpIsAsAskedOrFollowsTheView) {
  EXPECT_LT(norm(view_along({{1, 1, 1}}, Vec3d{{0, 2, 0}}).of({{0, 1, 0}}) -
                 Vec3d{{0, std::sqrt(2. / 3), std::sqrt(1. / 3)}}),
            1e-12);
  EXPECT_GT(view_along({{1, 1, 1}}, std::nullopt).up[2], 0.8);       // z
  EXPECT_GT(view_along({{0.3, 0.3, 1}}, std::nullopt).up[1], 0.9);   // a drawing in the plane of x and y
  EXPECT_GT(view_along({{0, 0, 1}}, Vec3d{{0, 0, 1}}).up[1], 0.99);  // one looks along it
  EXPECT_GT(view_along({{0, -1, 0}}, Vec3d{{0, 1, 0}}).up[2], 0.99);
}

TEST(PictureView, DirectionsMayBeOfAnyLength) {
  for (const double size : {1e-320, 1e-200, 1e200, 1e308}) {
    const View view = view_along({{size, 0, 0}}, Vec3d{{0, size, 0}});
    EXPECT_LT(norm(view.toward - Vec3d{{1, 0, 0}}), 1e-12) << size;
    EXPECT_LT(norm(view.up - Vec3d{{0, 1, 0}}), 1e-12) << size;
    EXPECT_LT(norm(view.right - Vec3d{{0, 0, -1}}), 1e-12) << size;
  }
}

TEST(PictureView, PlacesBodiesOfEverySizeNearZero) {
  for (const double size : {1e-30, 1e-3, 1e3, 1e30}) {
    Extent extent;
    const View view = view_along({{1, 2, 3}}, std::nullopt);
    const Vec3d far{{size * 1e5, 0, 0}};
    extent.add(view.of(far));
    extent.add(view.of(far + Vec3d{{size, size, size}}));
    const Placing placing{view, (extent.low + extent.high) * 0.5, norm(extent.size())};
    EXPECT_NEAR(norm(placing.of(far)), 0.5, 1e-9);
  }
}

TEST(PictureLayout, TilesFillTheAreaWithoutOverlap) {
  const Area area{{10, 20}, {910, 620}};
  for (const std::size_t count : {1, 2, 5, 12, 20}) {
    const std::vector<Area> tiles = tiles_of(area, count, 3, 1, 20);
    ASSERT_EQ(tiles.size(), count);
    for (const Area& tile : tiles) {
      EXPECT_GE(tile.low.x, area.low.x - 1e-9);
      EXPECT_LE(tile.high.x, area.high.x + 1e-9);
      EXPECT_GE(tile.low.y, area.low.y - 1e-9);
      EXPECT_LE(tile.high.y, area.high.y + 1e-9);
    }
  }
  EXPECT_EQ(tiles_of(area, 12, 3, 1, 20)[0].width(), 300);  // wide bodies: three columns
}

}  // namespace
}  // namespace fascia::io::picture_marks_test
