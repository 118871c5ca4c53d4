#include "io/picture/values.hpp"
#include "io/picture/wrapping.hpp"
#include "tests/unit/io/mesh_samples.hpp"
#include "tests/unit/io/volume_samples.hpp"

#include <array>
#include <cmath>
#include <string>
#include <vector>

// What the legend of a picture says of its values; no display is needed for it.
namespace fascia::io::picture_values_test {
namespace {

using samples::row_of_cubes;
using samples::TemporaryDirectory;

/// A cube whose heights reach from `lowest` to one more.
PictureState cube_from(double lowest, const std::string& field) {
  VisualMesh mesh = row_of_cubes(1, CellType::hexahedron, false);
  for (double& height : mesh.point_fields[0].values) height += lowest;
  const TemporaryDirectory directory;
  write_vtu(directory.path() / "a.vtu", mesh);
  PictureState state;
  state.bodies.push_back(read_picture_body(directory.path() / "a.vtu", field));
  return state;
}

TEST(PictureScale, ReachesOverTheValuesOfAllStates) {
  PictureStyle style;
  style.field = "height";
  const ColorScale scale = scale_of({cube_from(5, "height"), cube_from(7, "height"), cube_from(0, "depth")}, style);
  EXPECT_DOUBLE_EQ(scale.low, 5) << "a state without the field has no value";
  EXPECT_DOUBLE_EQ(scale.high, 8);
  EXPECT_FALSE(scale.below);
  EXPECT_FALSE(scale.above);
}

TEST(PictureScale, IsTheRangeAskedForHoweverNarrow) {
  PictureStyle style;
  style.field = "height";
  const std::vector<PictureState> states{cube_from(0, "height")};
  for (const std::array<double, 2>& range : {std::array{0.4, 0.4 + 1e-8}, std::array{1e-30, 2e-30}}) {
    style.range = range;
    const ColorScale scale = scale_of(states, style);
    EXPECT_EQ(scale.low, range[0]);
    EXPECT_EQ(scale.high, range[1]);
    EXPECT_TRUE(scale.below);
    EXPECT_TRUE(scale.above);
  }
  style.range = std::array{0.0, 1 - 1e-9};
  EXPECT_FALSE(scale_of(states, style).below);
  EXPECT_FALSE(scale_of(states, style).above);
  style.range = std::array{1e6, std::nextafter(1e6, 2e6)};  // no number lies between
  EXPECT_EQ(scale_of(states, style).high, 1e6);
}

TEST(PictureLegend, UnitIsNeverCutOff) {
  const TextWidth width_of = [](const std::string& text) { return 10.0 * static_cast<double>(text.size()); };
  const auto title = [&](double width) { return wrapped_with_unit("von Mises stress", "[kPa]", width_of, width, 3); };
  using Rows = std::vector<std::string>;
  EXPECT_EQ(title(400), (Rows{"von Mises stress [kPa]"}));
  EXPECT_EQ(title(160), (Rows{"von Mises stress", "[kPa]"}));
  EXPECT_EQ(title(100), (Rows{"von Mises", "stress", "[kPa]"}));
  EXPECT_EQ(title(60), (Rows{"von", "Mis...", "[kPa]"}));
  EXPECT_EQ(title(20).back(), "[kPa]");
  EXPECT_EQ(wrapped_with_unit("my field", "", width_of, 50, 3), (Rows{"my", "field"}));
}

}  // namespace
}  // namespace fascia::io::picture_values_test
