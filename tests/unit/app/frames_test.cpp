#include "tests/unit/app/scene_text.hpp"

#include <gtest/gtest.h>

// Keys of domains, frames, points and weights, as they are read.
namespace fascia::app::frames_test {
namespace {

using test::beam_with;
using test::thin_body;

constexpr const char* sheet_grid = "thickness = \"2 mm\"\nframes = { grid = [5, 3] }\n";
constexpr const char* line_grid = "radius = \"1 cm\"\nframes = { grid = [5] }\n";

Body beam_with_frames(const std::string& frames, const std::string& more = "") {
  return test::parse(beam_with("{ grid = [5, 2, 2] }", frames) + more).bodies[0];
}

Body body_of(std::string_view domain, std::string_view more) { return test::parse(thin_body(domain, more)).bodies[0]; }

TEST(ThinBodies, ReadsARectangle) {
  const Body body = body_of(test::rectangle, sheet_grid);
  const auto& domain = std::get<RectangleDomain>(body.domain);
  EXPECT_EQ(domain.origin, Vec3d{});
  EXPECT_EQ(domain.edge_u, (Vec3d{{2, 0, 0}}));
  EXPECT_EQ(domain.edge_v, (Vec3d{{0, 1, 0}}));
  ASSERT_EQ(body.thickness.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<AllRegion>(body.thickness[0].where.shape));
  EXPECT_DOUBLE_EQ(body.thickness[0].value, 2e-3);
  EXPECT_EQ(body.thickness_place.line, 7);
  EXPECT_EQ(body.thickness_place.key, "bodies.skin.thickness");
  EXPECT_FALSE(body.radius);
  EXPECT_EQ(std::get<GridFrames>(body.frames).count, (std::vector{5, 3}));
  EXPECT_FALSE(body.through);
}

TEST(ThinBodies, ReadsALine) {
  const Body body = body_of(test::line, line_grid);
  EXPECT_EQ(std::get<LineDomain>(body.domain).to, (Vec3d{{0, 0, 3}}));
  ASSERT_TRUE(body.radius);
  EXPECT_DOUBLE_EQ(*body.radius, 0.01);
  EXPECT_EQ(body.radius_place.line, 7);
  EXPECT_TRUE(body.thickness.empty());
  EXPECT_EQ(std::get<GridFrames>(body.frames).count, std::vector{5});
}

TEST(ThinBodies, ReadsThicknessByRegion) {
  const Body body = body_of(test::rectangle,
                            "thickness = [{ where = { halfspace = { point = [1, 0, 0], normal = [1, 0, 0] } }, value = "
                            "\"1 mm\" }, { value = 0.5 }]\nframes = { grid = [5, 3] }\n");
  ASSERT_EQ(body.thickness.size(), 2u);
  EXPECT_TRUE(std::holds_alternative<HalfspaceRegion>(body.thickness[0].where.shape));
  EXPECT_EQ(body.thickness[0].where.place.key, "bodies.skin.thickness[0].where");
  EXPECT_DOUBLE_EQ(body.thickness[0].value, 1e-3);
  EXPECT_TRUE(std::holds_alternative<AllRegion>(body.thickness[1].where.shape));
  EXPECT_EQ(body.thickness[1].value, 0.5);
}

TEST(ThinBodies, AFileTakesThicknessAndRadius) {
  const Body body =
      body_of(test::mesh, "thickness = 1\nradius = 2\nframes = { count = 50 }\npoints = { through = 3 }\n");
  EXPECT_EQ(body.thickness[0].value, 1);
  EXPECT_EQ(body.radius, 2.0);
  EXPECT_EQ(body.through, 3);
}

TEST(ThinBodies, ReadsPointsOfThinGrids) {
  const Body sheet =
      body_of(test::rectangle, std::string(sheet_grid) + "points = { per_cell = [1, 3], through = 10 }\n");
  EXPECT_EQ(std::get<PerCell>(sheet.points).count, (std::vector{1, 3}));
  EXPECT_EQ(sheet.through, 10);
  const Body line = body_of(test::line, std::string(line_grid) + "points = { per_cell = [1], through = 1 }\n");
  EXPECT_EQ(std::get<PerCell>(line.points).count, std::vector{1});
  EXPECT_EQ(line.through, 1);
}

TEST(Frames, ReadsScatteredFrames) {
  const Body spaced = beam_with_frames("{ poisson_disk = \"5 mm\" }");
  EXPECT_DOUBLE_EQ(std::get<SpacedSamples>(spaced.frames).spacing, 5e-3);
  EXPECT_EQ(std::get<SpacedSamples>(spaced.frames).seed, 1);
  EXPECT_EQ(spaced.frames_place.key, "bodies.beam.frames.poisson_disk");
  EXPECT_EQ(spaced.frames_place.line, 9);
  EXPECT_FALSE(spaced.affine);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(spaced.points));
  const Body counted = beam_with_frames("{ seed = 7, count = 300, kind = \"affine\" }");
  EXPECT_EQ(std::get<CountedSamples>(counted.frames).count, 300);
  EXPECT_EQ(std::get<CountedSamples>(counted.frames).seed, 7);
  EXPECT_EQ(counted.frames_place.key, "bodies.beam.frames.count");
  EXPECT_TRUE(counted.affine);
}

TEST(Frames, ReadsListedFrames) {
  const Body bare = beam_with_frames("{ positions = [[0, 0, 0], [\"1 cm\", 0, 1]] }");
  const auto& list = std::get<ListedFrames>(bare.frames);
  ASSERT_EQ(list.positions.size(), 2u);
  EXPECT_DOUBLE_EQ(list.positions[1][0], 0.01);
  EXPECT_TRUE(list.rotations.empty());
  const Body turned = beam_with_frames("{ positions = [[0, 0, 0]], rotations = [[0, 0, \"180 degree\"]] }");
  EXPECT_NEAR(std::get<ListedFrames>(turned.frames).rotations.at(0)[2], 3.14159265358979, 1e-14);
}

TEST(Frames, FilesAreRelativeToTheScene) {
  const std::string text =
      beam_with("{ grid = [5, 2, 2] }", "{ file = \"data/frames.csv\" }") + "points = { file = \"/abs/points.csv\" }\n";
  const Body body = parse_scene_text(text, "scenes/a.toml", {}).bodies[0];
  EXPECT_EQ(std::get<SampleFile>(body.frames).path, "scenes/data/frames.csv");
  EXPECT_EQ(std::get<SampleFile>(body.points).path, "/abs/points.csv");
  EXPECT_EQ(body.points_place.key, "bodies.beam.points.file");
}

TEST(Frames, ReadsScatteredPoints) {
  const Body spaced = beam_with_frames("{ count = 9 }", "points = { poisson_disk = 0.5 }\n");
  EXPECT_EQ(std::get<SpacedSamples>(spaced.points).spacing, 0.5);
  EXPECT_EQ(std::get<SpacedSamples>(spaced.points).seed, 2) << "points do not follow the frames' samples";
  const Body counted = beam_with_frames("{ count = 9 }", "points = { count = 2000, seed = 0 }\n");
  EXPECT_EQ(std::get<CountedSamples>(counted.points).count, 2000);
  EXPECT_EQ(std::get<CountedSamples>(counted.points).seed, 0);
  EXPECT_EQ(counted.points_place.line, 10);
}

TEST(Frames, ReadsEveryKindOfWeights) {
  const auto kind = [](const std::string& frames, const std::string& word) {
    return beam_with_frames(frames, "weights = { kind = \"" + word + "\" }\n").weights;
  };
  EXPECT_EQ(kind("{ grid = [5, 2, 2] }", "trilinear"), WeightKind::trilinear);
  EXPECT_EQ(kind("{ grid = [5, 2, 2] }", "linear"), WeightKind::linear);
  EXPECT_EQ(kind("{ count = 9 }", "mls"), WeightKind::mls);
  EXPECT_EQ(kind("{ count = 9 }", "shepard"), WeightKind::shepard);
  EXPECT_EQ(kind("{ count = 9 }", "wendland"), WeightKind::wendland);
  EXPECT_EQ(kind("{ count = 9 }", "cubic-spline"), WeightKind::cubic_spline);
  EXPECT_EQ(body_of(test::line, std::string(line_grid) + "weights = { kind = \"trilinear\" }\n").weights,
            WeightKind::trilinear);
}

TEST(Frames, ReadsReachBlendAndDrilling) {
  const Body by_count = beam_with_frames("{ count = 9 }", "weights = { neighbours = 12, blend = \"half\" }\n");
  EXPECT_EQ(by_count.neighbours, 12);
  EXPECT_FALSE(by_count.support);
  EXPECT_EQ(by_count.weights, WeightKind::automatic);
  EXPECT_EQ(by_count.blend, Blend::half);
  EXPECT_EQ(by_count.weights_place.key, "bodies.beam.weights");
  EXPECT_EQ(by_count.weights_place.line, 10);
  const Body by_radius = beam_with_frames(
      "{ count = 9 }", "weights = { kind = \"shepard\", radius = \"3 cm\", blend = \"full\", drilling = 0 }\n");
  EXPECT_DOUBLE_EQ(by_radius.support.value(), 0.03);
  EXPECT_EQ(by_radius.drilling, 0.0);
  EXPECT_EQ(by_radius.weights_place.key, "bodies.beam.weights.kind");
}

TEST(Frames, PlacesOfWhatIsLeftOutAreThoseOfTheBody) {
  const Body body = beam_with_frames("{ count = 9 }");
  EXPECT_EQ(body.weights_place.key, "bodies.beam");
  EXPECT_EQ(body.points_place.key, "bodies.beam");
  EXPECT_EQ(body.thickness_place.key, "bodies.beam.thickness");
  EXPECT_EQ(body.thickness_place.line, body.place.line);
}

}  // namespace
}  // namespace fascia::app::frames_test
