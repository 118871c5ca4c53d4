// The same coupled bodies in another order, another unit, turned as a whole.
#include "tests/support/cases.hpp"
#include "tests/support/coupled_scene.hpp"

#include <gtest/gtest.h>

#include <cstdio>

namespace fascia::test::coupling_invariance_test {
namespace {

/// Turn about (1, 2, 3) by 0.7.
Vector turned(const Vector& x) {
  const double n = std::sqrt(14.0), c = std::cos(0.7), s = std::sin(0.7);
  const Vector a{1 / n, 2 / n, 3 / n};
  const Vector across{a[1] * x[2] - a[2] * x[1], a[2] * x[0] - a[0] * x[2], a[0] * x[1] - a[1] * x[0]};
  return x * c + across * s + a * ((a[0] * x[0] + a[1] * x[1] + a[2] * x[2]) * (1 - c));
}

struct Setting {
  bool turn = false;
  double unit = 1;     ///< of length, in metres
  bool mixed = false;  ///< bodies and shares in another order
  Kind tissue = Kind::grid;

  Vector place(const Vector& x) const { return (turn ? turned(x) : x) * (1 / unit); }
  Vector way(const Vector& x) const { return turn ? turned(x) : x; }
};

/// What lies at x along the first axis of the scene.
std::string slab(const Setting& s, double x) {
  const auto half = [&](double at, double sign) {
    return fmt::format("{{halfspace={{point={},normal={}}}}}", list(s.place({at, 0, 0})), list(s.way({sign, 0, 0})));
  };
  return fmt::format("{{all_of=[{},{}]}}", half(x - 1e-3, -1), half(x + 1e-3, 1));
}

std::string matter(const Setting& s, double young) {
  return fmt::format("density={:.17g}\nmaterial={{young={:.17g},poisson=0.3}}\n", 12 * std::pow(s.unit, 3),
                     young * s.unit);
}

/// The box is scaled and turned by the body's transform.
std::string moved(const Setting& s) {
  std::string text = fmt::format("scale={:.17g}", 1 / s.unit);
  if (s.turn) text += ",rotate={axis=[1,2,3],angle=0.7}";
  return "transform={" + text + "}\n";
}

/// Tetrahedra, tissue and a bone in a row; a shell on the tissue's top. Masses in kg, forces in N, lengths in a unit:
/// with the seconds, kg and N m/s² of a unit forces are kg unit/s².
Vector end_of(const Setting& s) {
  const std::string organ = "[bodies.organ]\nmodel=\"tetrahedra\"\n" + matter(s, 1e4) + moved(s) +
                            "domain={box={min=[0,0,0],max=[1,1,1],cells=[2,2,2]}}\n";
  const std::string bone = fmt::format(
      "[bodies.bone]\nmodel=\"rigid\"\nmass=20\n{}"
      "domain={{box={{min=[2,0,0],max=[3,1,1],cells=[1,2,2]}}}}\n",
      moved(s));
  const std::string skin = "[bodies.skin]\nmodel=\"shell\"\n" + matter(s, 1e5) +
                           fmt::format("thickness={:.17g}\n", 0.05 / s.unit) + moved(s) +
                           "domain={rectangle={origin=[1.25,0,1],edge_u=[0.5,0,0],edge_v=[0,1,0],cells=[2,2]}}\n";
  const std::string from_organ = "{body=\"organ\",where=" + slab(s, 1) + "}",
                    from_bone = "{body=\"bone\",where=" + slab(s, 2) + "}", from_skin = "{body=\"skin\"}";
  const std::string shares =
      s.mixed ? from_skin + "," + from_bone + "," + from_organ : from_organ + "," + from_bone + "," + from_skin;
  const std::string frames =
      s.tissue == Kind::grid ? "grid=[5,3,3]" : fmt::format("poisson_disk={:.17g}", 0.3 / s.unit);
  const std::string tissue = "[bodies.tissue]\nmodel=\"meshless\"\n" + matter(s, 1e4) + moved(s) +
                             "domain={box={min=[1,0,0],max=[2,1,1]}}\nframes={" + frames + ",share=[" + shares + "]}\n";
  const std::string paint = "[bodies.paint]\nmodel=\"surface\"\n" + moved(s) +
                            "domain={rectangle={origin=[0,0,1],edge_u=[1,0,0],edge_v=[0,1,0],cells=[3,3]}}\n";
  const std::string ride = coupling("ride", "embed", "paint", "\"all\"", "to=\"organ\"");
  const std::string all = s.mixed ? paint + tissue + skin + bone + organ : organ + bone + skin + tissue + paint;
  const TextRun run(
      fmt::format("[world]\ngravity={}\n[solver.newton]\ntolerance=1e-12\n", list(s.way({2, 1, -3}) * (1 / s.unit))) +
      all + ride + fix("organ", slab(s, 0)) +
      fmt::format("[[loads]]\nbody=\"paint\"\nwhere=\"all\"\ntraction={}\n", list(s.way({0, 0, -100}) * s.unit)) +
      probe_at("tip", "bone", s.place({3, 1, 1})));
  return run.vector("tip") * s.unit;
}

TEST(CouplingInvariance, OrderUnitsAndTurns) {
  for (const Kind kind : {Kind::grid, Kind::scattered}) {
    Setting plain;
    plain.tissue = kind;
    const Vector u = end_of(plain);
    Setting mixed = plain, turn = plain, mm = plain, km = plain, both = plain;
    mixed.mixed = turn.turn = true;
    mm.unit = 1e-3;
    km.unit = 1e3;
    both.mixed = both.turn = true;
    both.unit = 1e-3;
    const double large = relative(end_of(km), u), all = relative(end_of(both), turned(u));
    std::printf("%-10s tip (%.4f %.4f %.4f) m: km %.1e, order and turn and mm %.1e", name_of(kind), u[0], u[1], u[2],
                large, all);
    EXPECT_LT(large, 1e-9);
    EXPECT_LT(all, 1e-9);
    if (full_size()) {  // which of them it was
      const double order = relative(end_of(mixed), u), rotation = relative(end_of(turn), turned(u)),
                   small = relative(end_of(mm), u);
      std::printf(", order %.1e, turn %.1e, mm %.1e", order, rotation, small);
      for (const double off : {order, rotation, small}) {
        EXPECT_LT(off, 1e-9);
      }
    }
    std::printf("\n");
  }
}

}  // namespace
}  // namespace fascia::test::coupling_invariance_test
