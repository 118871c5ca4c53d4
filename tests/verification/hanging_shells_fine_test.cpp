// Convergence of both sides of hanging_shells_test.cpp; takes minutes.
#include "tests/verification/hanging_shells.hpp"

#include <cstdio>
#include <string>
#include <vector>

namespace fascia::test::hanging_shells_fine_test {
namespace {

/// @param tissue  frames along a side of the tied square
Settings cells(int n, int tissue, int layers) {
  const std::string square = "[" + std::to_string(n) + "," + std::to_string(n) + "]";
  return {"bodies.upper.domain.rectangle.cells=" + square, "bodies.lower.domain.rectangle.cells=" + square,
          grid_setting("tissue", {tissue, tissue, layers})};
}

void print(const std::string& name, const Sag& sag) {
  std::printf("%-44s %.5f    %.5f\n", name.c_str(), sag.centre, sag.mean);
}

TEST(HangingShellsFine, SagConverges) {
  std::printf("sag of the lower wall [m]                    centre     mean of the tied square\n");
  std::vector<Sag> solid, coupled;
  for (const SolidMesh& m : {SolidMesh{true, 5, 7, 4}, SolidMesh{false, 5, 7, 5}, SolidMesh{false, 6, 8, 5}}) {
    solid.push_back(sag_of_solid(m));
    print((m.tetrahedra ? "10-node tetrahedra " : "20-node hexahedra ") + std::to_string(m.tied) + " + " +
              std::to_string(m.overhang) + ", " + std::to_string(m.height) + " high",
          solid.back());
  }
  for (const int layers : {2, 3, 5}) {
    coupled.push_back(sag_of_coupled(cells(30, 13, layers)));
    print("30 x 30 shell cells, layers of frames: " + std::to_string(layers), coupled.back());
  }
  const Sag& best = solid.back();
  for (const Sag& s : solid) EXPECT_NEAR(s.centre / best.centre, 1, 0.01);
  // Two layers of frames make the tissue's strain uniform over its height: too stiff, by 2 %.
  for (const Sag& c : coupled) {
    EXPECT_NEAR(c.centre / best.centre, 1, 0.03);
    EXPECT_NEAR(c.mean / best.mean, 1, 0.03);
  }
  // With five, what is left of the discretisation errors of both, each below 1 %.
  EXPECT_NEAR(coupled.back().centre / best.centre, 1, 0.015);
  EXPECT_NEAR(coupled.back().mean / best.mean, 1, 0.015);
}

}  // namespace
}  // namespace fascia::test::hanging_shells_fine_test
