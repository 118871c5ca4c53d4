// A block cut in two whose halves share, embed or weld nodes, beside the block in one piece.
#include "tests/support/cases.hpp"
#include "tests/support/coupled_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <vector>

namespace fascia::test::coupling_block_test {
namespace {

constexpr double kTiny = 1e-3;

std::string plane(double x) { return box({x - kTiny, -kTiny, -kTiny}, {x + kTiny, 1 + kTiny, 1 + kTiny}); }

const std::string kTop =
    "[world]\ngravity=[0,0,-10]\n[materials.soft]\nyoung=1e4\npoisson=0.3\n[solver.newton]\ntolerance=1e-11\n";

/// Clamped at x = 0, pulled by 600 Pa at x = 2 and bent by the weight.
std::string ends(const std::string& left, const std::string& right) {
  return fix(left, plane(0)) + fmt::format("[[loads]]\nbody=\"{}\"\nwhere={}\ntraction=[600,0,0]\n", right, plane(2)) +
         probe_at("tip", right, {2, 0.5, 0.5});
}

Vector whole(Kind kind, int n) {
  return TextRun(kTop + box_body("a", kind, {0, 0, 0}, {2, 1, 1}, n) + ends("a", "a")).vector("tip");
}

struct Cut {
  const char* name;
  Kind left, right;
  std::string share;     ///< of the right half
  std::string coupling;  ///< further text
  bool always = true;    ///< not in full size alone
};

Vector cut(const Cut& c, int n) {
  const TextRun run(kTop + box_body("a", c.left, {0, 0, 0}, {1, 1, 1}, n) +
                    box_body("b", c.right, {1, 0, 0}, {2, 1, 1}, n, c.share) + c.coupling + ends("a", "b"));
  return run.vector("tip");
}

/// How far a value is outside the interval between two others, relative to it.
double outside(double u, double a, double b) {
  return std::max({0.0, std::min(a, b) - u, u - std::max(a, b)}) / std::abs(u);
}

TEST(CouplingBlock, CutInTwo) {
  const std::string face = fmt::format("{{body=\"a\",where={}}}", plane(1));
  const std::string still = fmt::format("{{body=\"a\",where={},rotations=false}}", plane(1));
  const std::string a_in_b = coupling("join", "embed", "a", plane(1), "to=\"b\"");
  const std::string b_in_a = coupling("join", "embed", "b", plane(1), "to=\"a\"");
  const Cut cuts[] = {
      {"grid shares grid", Kind::grid, Kind::grid, face, "", false},
      {"hexahedra embedded in hexahedra", Kind::hexahedra, Kind::hexahedra, "", b_in_a},
      {"scattered shares grid", Kind::grid, Kind::scattered, face, ""},
      {"scattered shares scattered", Kind::scattered, Kind::scattered, face, ""},
      {"grid shares tetrahedra", Kind::tetrahedra, Kind::grid, face, ""},
      {"grid shares tetrahedra, still", Kind::tetrahedra, Kind::grid, still, "", false},
      {"scattered shares tetrahedra", Kind::tetrahedra, Kind::scattered, face, "", false},
      {"scattered shares tetrahedra, still", Kind::tetrahedra, Kind::scattered, still, ""},
      {"tetrahedra embedded in grid", Kind::tetrahedra, Kind::grid, "", a_in_b, false},
      {"tetrahedra embedded in scattered", Kind::tetrahedra, Kind::scattered, "", a_in_b},
      {"grid embedded in tetrahedra", Kind::tetrahedra, Kind::grid, "", b_in_a},
      {"scattered embedded in tetrahedra", Kind::tetrahedra, Kind::scattered, "", b_in_a, false},
      {"tetrahedra embedded in hexahedra", Kind::tetrahedra, Kind::hexahedra, "", a_in_b, false},
      {"hexahedra embedded in tetrahedra", Kind::tetrahedra, Kind::hexahedra, "", b_in_a, false},
  };
  const std::vector<int> cells = full_size() ? std::vector{2, 3, 4} : std::vector{2, 3};
  std::map<std::pair<Kind, int>, Vector> known;
  const auto of = [&](Kind kind, int n) {
    const auto found = known.find({kind, n});
    return found != known.end() ? found->second : known[{kind, n}] = whole(kind, n);
  };
  for (const Kind kind : {Kind::grid, Kind::scattered, Kind::tetrahedra, Kind::hexahedra}) {
    std::printf("%-12s in one piece:", name_of(kind));
    for (const int n : cells) std::printf("   %.5f %.5f", of(kind, n)[0], of(kind, n)[2]);
    std::printf("\n");
  }
  std::printf("%-36s deflection at 2, 3, 4 cells a metre, outside of the two blocks in one piece\n", "");
  for (const Cut& c : cuts) {
    if (!c.always && !full_size()) continue;
    std::printf("%-36s", c.name);
    double off = 0;
    for (const int n : cells) {
      const Vector u = cut(c, n), l = of(c.left, n), r = of(c.right, n);
      off = outside(u[2], l[2], r[2]);
      std::printf("   %.5f %6.3f %%", u[2], 100 * off);
      if (c.left == c.right && c.left != Kind::scattered) {
        EXPECT_LT(relative(u, l), 1e-9) << c.name;
      }
    }
    std::printf("\n");
    EXPECT_LT(off, 0.02) << c.name;
  }
}

TEST(CouplingBlock, HalvesWeldedToAPlate) {
  const std::string wafer =
      "[bodies.plate]\nmodel=\"rigid\"\nmass=0.001\n"
      "domain={box={min=[0.999,0,0],max=[1.001,1,1]}}\n";
  const auto weld = [](const std::string& body) {
    return coupling("weld_" + body, "weld", body, plane(1), "to=\"plate\"");
  };
  for (const Kind kind : {Kind::grid, Kind::hexahedra}) {
    const Vector u =
        TextRun(kTop + box_body("a", kind, {0, 0, 0}, {1, 1, 1}, 3) + box_body("b", kind, {1, 0, 0}, {2, 1, 1}, 3) +
                wafer + weld("a") + weld("b") + ends("a", "b"))
            .vector("tip");
    const Vector one =
        TextRun(kTop + box_body("a", kind, {0, 0, 0}, {2, 1, 1}, 3) + wafer + weld("a") + ends("a", "a")).vector("tip");
    std::printf("welded, %-10s (%.5f %.5f), in one piece to %.1e, without plate (%.5f %.5f)\n", name_of(kind), u[0],
                u[2], relative(u, one), whole(kind, 3)[0], whole(kind, 3)[2]);
    EXPECT_LT(relative(u, one), 1e-9);
  }
}

/// A stiff wall of shells on a soft block, that share the nodes of its upper face, bends with it; against 20-node
/// hexahedra with a layer of the wall's thickness embedded in them. The layer lies on the block, the wall's middle in
/// its face: 0.4 % of the lever.
TEST(CouplingBlock, AWallOnACore) {
  const std::string top =
      "[materials.core]\nyoung=1e4\npoisson=0.3\n[materials.skin]\nyoung=1e7\npoisson=0.3\n[solver]\nkind=\"static\"\n"
      "[[loads]]\nbody=\"core\"\nwhere={box={min=[1.99,-1,-1],max=[2.01,2,2]}}\ntraction=[0,0,-100]\n" +
      fix("core", plane(0)) + probe_at("tip", "core", {2, 0.5, 0.5});
  const auto solids = [&](int n) {
    return TextRun(
               top + fix("skin", plane(0)) +
               fmt::format("[bodies.core]\nmodel=\"hexahedra\"\norder=2\ndomain={{box={{min=[0,0,0],max=[2,1,1],"
                           "cells=[{0},{1},{1}]}}}}\ndensity=1\nmaterial=\"core\"\n"
                           "[bodies.skin]\nmodel=\"hexahedra\"\norder=2\ndomain={{box={{min=[0,0,1],max=[2,1,1.004],"
                           "cells=[{0},{1},1]}}}}\ndensity=1\nmaterial=\"skin\"\n"
                           "[couplings.glue]\nkind=\"embed\"\nbody=\"skin\"\nto=\"core\"\n"
                           "where={{box={{min=[0.01,-1,0.9999],max=[3,2,1.0001]}}}}\n",
                           2 * n, n))
        .vector("tip")[2];
  };
  const auto coupled = [&](const std::string& frames, int n) {
    return TextRun(top +
                   fmt::format("[bodies.skin]\nmodel=\"shell\"\ndomain={{rectangle={{origin=[0,0,1],edge_u=[2,0,0],"
                               "edge_v=[0,1,0],cells=[{},{}],diagonal=\"alternating\"}}}}\nthickness=0.004\n"
                               "density=1\nmaterial=\"skin\"\n[bodies.core]\nmodel=\"meshless\"\ndomain={{box={{min="
                               "[0,0,0],max=[2,1,1]}}}}\nframes={{{},share=[{{body=\"skin\"}}]}}\ndensity=1\n"
                               "material=\"core\"\n",
                               2 * n, n, frames))
        .vector("tip")[2];
  };
  const double reference = solids(full_size() ? 6 : 4);
  std::printf("a wall on a core: %.5f m\n", reference);
  const auto expect = [&](const char* name, double u, double bound) {
    std::printf("  %-22s %.5f, %+.2f %%\n", name, u, 100 * (u / reference - 1));
    EXPECT_NEAR(u, reference, bound * std::abs(reference)) << name;
  };
  expect("grid 9 x 5 x 5", coupled("grid=[9,5,5]", 4), 0.02);
  expect("scattered, 0.2", coupled("poisson_disk=0.2", 4), 0.02);
  if (!full_size()) return;
  expect("grid 17 x 9 x 9", coupled("grid=[17,9,9]", 8), 0.005);
  expect("scattered, 0.125", coupled("poisson_disk=0.125", 8), 0.01);
}

}  // namespace
}  // namespace fascia::test::coupling_block_test
