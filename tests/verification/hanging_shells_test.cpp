// scenes/hanging_shells.toml (2014 paper, figure 11) against the same scene as one mesh of solid elements.
#include "tests/verification/hanging_shells.hpp"
#include "tests/support/cases.hpp"

#include <cstdio>

namespace fascia::test::hanging_shells_test {
namespace {

/// What the solid meshes of hanging_shells_fine_test.cpp settle at, within 1 % [m].
constexpr double kSettledCentre = 0.2727, kSettledMean = 0.2793;

TEST(HangingShells, LowerWallSagsAsInOneMeshOfSolids) {
  const Sag coupled = sag_of_coupled(), hexahedra = sag_of_solid({});
  std::vector<Sag> solids{hexahedra};
  std::printf("sag of the lower wall [m]   centre     mean of the tied square\n");
  std::printf("20 x 20 shell cells         %.5f    %.5f\n", coupled.centre, coupled.mean);
  std::printf("20-node hexahedra           %.5f    %.5f\n", hexahedra.centre, hexahedra.mean);
  if (full_size()) {
    const Sag tetrahedra = sag_of_solid({true, 3, 5, 3});
    std::printf("10-node tetrahedra          %.5f    %.5f\n", tetrahedra.centre, tetrahedra.mean);
    solids.push_back(tetrahedra);
  }
  for (const Sag& solid : solids) {
    EXPECT_NEAR(coupled.centre / solid.centre, 1, 0.05);
    EXPECT_NEAR(coupled.mean / solid.mean, 1, 0.05);
    EXPECT_NEAR(solid.centre / kSettledCentre, 1, 0.02);  // 930 tetrahedra or 155 hexahedra
    EXPECT_NEAR(solid.mean / kSettledMean, 1, 0.02);
  }
}

}  // namespace
}  // namespace fascia::test::hanging_shells_test
