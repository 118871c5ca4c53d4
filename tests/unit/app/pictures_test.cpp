#include "assembly/specification/scene.hpp"
#include "tests/unit/app/scene_text.hpp"

#include <gtest/gtest.h>

namespace fascia::app::pictures_test {
namespace {

using test::errors_of_beam;
using test::parse_beam;

TEST(Pictures, UpIsADirection) {
  EXPECT_FALSE(parse_beam("").world.up);
  EXPECT_EQ(parse_beam("[world]\nup = [0, 0, 2]\n").world.up, (Vec3d{{0, 0, 2}}));
  EXPECT_EQ(errors_of_beam("[world]\nup = [0, 0, 0]\n"),
            "a.toml:11:6: world.up: has no direction; must be a vector of a length other than 0");
}

TEST(Pictures, RangeIsInTheUnitOfTheField) {
  const auto range = [](const std::string& keys) {
    return parse_beam("[output]\npicture = { " + keys + " }\n").output.picture->range;
  };
  EXPECT_FALSE(range("field = \"stress\""));
  EXPECT_EQ(range("range = [0, \"2 kPa\"]"), (std::array{0.0, 2000.0}));
  EXPECT_EQ(range("range = [-1, 2.5], field = \"strain\""), (std::array{-1.0, 2.5}));
  EXPECT_EQ(range("range = [\"-5 mm\", 1], field = \"displacement\""), (std::array{-0.005, 1.0}));
}

TEST(Pictures, WrongRangesAreRefused) {
  EXPECT_EQ(errors_of_beam("[output]\npicture = { range = [0, \"2 mm\"] }\n"),
            "a.toml:11:21: output.picture.range: \"2 mm\" is a length; must be a pressure in Pa, such as \"40 kPa\"");
  EXPECT_EQ(errors_of_beam("[output]\npicture = { range = [2, 2] }\n"),
            "a.toml:11:21: output.picture.range: 2 is not below 2; must be the lower value, then the higher");
  EXPECT_EQ(
      errors_of_beam("[output]\npicture = { range = [1] }\n"),
      "a.toml:11:21: output.picture.range: a list of 1 is of the wrong length; must be a list of 2, each a quantity "
      "with a unit or a number");
  EXPECT_EQ(errors_of_beam("[solver]\nkind = \"modes\"\n[output]\npicture = { range = [0, 1] }\n"),
            "a.toml:13:21: output.picture.range: does not go with modes, which have no amplitude; remove it");
}

TEST(Pictures, OfModesShowDisplacement) {
  EXPECT_EQ(parse_beam("[output]\npicture = { }\n").output.picture->field, "von_mises");
  EXPECT_EQ(parse_beam("[solver]\nkind = \"modes\"\n[output]\npicture = { }\n").output.picture->field, "displacement");
}

}  // namespace
}  // namespace fascia::app::pictures_test
