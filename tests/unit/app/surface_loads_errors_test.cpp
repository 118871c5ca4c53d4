#include "app/reader/parse.hpp"
#include "tests/unit/app/scene_text.hpp"

#include <gtest/gtest.h>

// Pressure, line forces and fluids in scene files.
namespace fascia::app::surface_loads_errors_test {
namespace {

using test::errors_of_beam;

std::string errors_of_load(const std::string& keys) {
  return errors_of_beam("[[loads]]\nbody = \"beam\"\nwhere = \"all\"\n" + keys);
}

TEST(SurfaceLoadErrors, Loads) {
  EXPECT_EQ(errors_of_load("pressure = [1, 0, 0]\n"),
            "a.toml:13:12: loads[0].pressure: a list of 3 is of the wrong type; must be a pressure in Pa");
  EXPECT_EQ(errors_of_load("pressure = \"1 N\"\n"),
            "a.toml:13:12: loads[0].pressure: \"1 N\" is a force; must be a pressure in Pa, such as \"40 kPa\"");
  EXPECT_EQ(errors_of_load("line_force = [0, 0, nan]\n"),
            "a.toml:13:21: loads[0].line_force[2]: nan is not finite; must be a force per length in N/m");
  EXPECT_EQ(errors_of_beam("[[loads]]\nbody = \"beam\"\nat = [0, 0, 0]\npressure = 1\n"),
            "a.toml:13:12: loads[0].pressure: goes with where, not with at; remove it");
  EXPECT_EQ(errors_of_beam("[[loads]]\nbody = \"beam\"\nat = [0, 0, 0]\nline_force = [1, 0, 0]\n"),
            "a.toml:13:14: loads[0].line_force: goes with where, not with at; remove it");
}

TEST(SurfaceLoadErrors, Fluids) {
  EXPECT_EQ(errors_of_beam("fluid = {}\n"),
            "a.toml:10:9: bodies.beam.fluid: pressure or bulk_modulus is missing; give exactly one");
  EXPECT_EQ(errors_of_beam("fluid = { pressure = 1, bulk_modulus = 2 }\n"),
            "a.toml:10:40: bodies.beam.fluid.bulk_modulus: cannot stand beside pressure; give only one of them");
  EXPECT_EQ(errors_of_beam("fluid = { pressure = 1, volume = 2 }\n"),
            "a.toml:10:34: bodies.beam.fluid.volume: is used only beside bulk_modulus; remove it");
  EXPECT_EQ(errors_of_beam("fluid = { bulk_modulus = 0 }\n"),
            "a.toml:10:26: bodies.beam.fluid.bulk_modulus: 0 is out of range; must be above 0");
  EXPECT_EQ(errors_of_beam("fluid = { bulk_modulus = 1, volume = -1, density = -1 }\n"),
            "a.toml:10:38: bodies.beam.fluid.volume: -1 is out of range; must be above 0\n"
            "a.toml:10:52: bodies.beam.fluid.density: -1 is out of range; must be at least 0");
}

TEST(SurfaceLoads, PressureFollowsUnlessItIsToldNotTo) {
  const auto follows = [](const std::string& more) {
    return parse_scene_text(test::beam_with("", "") + "[[loads]]\nbody = \"beam\"\nwhere = \"all\"\n" + more, "a.toml",
                            {})
        .loads.at(0);
  };
  EXPECT_TRUE(follows("pressure = 1\n").pressure_follows);
  EXPECT_FALSE(follows("pressure = 1\nfollower = false\n").pressure_follows);
  EXPECT_FALSE(follows("pressure = 1\ntotal_force = [1, 0, 0]\n").follower);
}

}  // namespace
}  // namespace fascia::app::surface_loads_errors_test
