#include "tests/robustness/element_scenes.hpp"
#include "tests/support/paths.hpp"

#include <array>
#include <cmath>
#include <regex>
#include <set>
#include <sstream>

namespace fascia::similarity_test {

// The same body elsewhere, in another unit of length, or held by a more generous region: the same answer.
namespace {

using namespace fascia::test;

std::string number(double v) {
  std::ostringstream out;
  out.precision(17);
  out << v;
  return out.str();
}

std::string vector(double x, double y, double z) { return "[" + number(x) + ", " + number(y) + ", " + number(z) + "]"; }

/// Powers of the unit of length in the unit of a key, where mass and time keep theirs.
int power_of(const std::string& key) {
  static const std::map<std::string, int> powers{
      {"min", 1},       {"max", 1},       {"from", 1},         {"to", 1},          {"radius", 1}, {"center", 1},
      {"radii", 1},     {"origin", 1},    {"edge_u", 1},       {"edge_v", 1},      {"at", 1},     {"poisson_disk", 1},
      {"thickness", 1}, {"gravity", 1},   {"translate", 1},    {"total_force", 1}, {"young", -1}, {"density", -3},
      {"nearest", 1},   {"traction", -1}, {"total_torque", 2}, {"pressure", -1},   {"point", 1}};
  const auto found = powers.find(key);
  return found == powers.end() ? 0 : found->second;
}

/// A scene with every number of an entry `key = value` replaced by change(key, index in the value, number).
template <class Change>
std::string changed(const std::string& scene, const Change& change) {
  static const std::regex entry(R"((\w+)( *= *)(\[[-+\d.eE, \[\]\n]*\]|"[-+\d.eE]+ [^"]*"|[-+]?\d[-+\d.eE]*))");
  static const std::regex value(R"([-+]?\d+\.?\d*([eE][-+]?\d+)?)");
  std::string result;
  auto end = scene.cbegin();
  for (std::sregex_iterator m(scene.begin(), scene.end(), entry), none; m != none; ++m) {
    result.append(end, (*m)[3].first);
    end = (*m)[3].second;
    const std::string text = (*m)[3];
    auto rest = text.cbegin();
    int index = 0;
    for (std::sregex_iterator v(text.begin(), text.end(), value); v != none; ++v) {
      result.append(rest, (*v)[0].first);
      rest = (*v)[0].second;
      const double old = std::stod(v->str()), now = change((*m)[1].str(), index++, old);
      result += now == old ? v->str() : number(now);
    }
    result.append(rest, text.cend());
  }
  return result.append(end, scene.cend());
}

/// All lengths `factor` times as large, mass and time as they are.
std::string in_unit(const std::string& scene, double factor) {
  return changed(scene, [&](const std::string& key, int, double v) { return v * std::pow(factor, power_of(key)); });
}

/// All places elsewhere.
std::string moved(const std::string& scene, const std::array<double, 3>& by) {
  static const std::set<std::string> places{"min", "max", "from", "to", "origin", "center", "at", "point", "nearest"};
  return changed(scene, [&](const std::string& key, int i, double v) {
    return places.contains(key) ? v + by[static_cast<std::size_t>(i % 3)] : v;
  });
}

class Similarity : public SceneRuns {
 protected:
  /// Values of all probes by name, in a unit of length.
  std::map<std::string, std::vector<double>> values(const std::string& scene, double unit = 1) const {
    static const std::map<std::string, int> powers{{"m", 1}, {"N", 1}, {"N m", 2}, {"m3", 3}, {"Pa", -1}};
    write("scene.toml", scene);
    const ProgramResult r = fascia({"run", "scene.toml", "--output", "out", "--threads", "1"});
    EXPECT_EQ(r.status, 0) << r.err;
    std::map<std::string, std::vector<double>> result;
    if (r.status != 0) return result;
    const nlohmann::json written = summary("out");
    for (const auto& [name, probe] : written["probes"].items()) {
      const auto power = powers.find(probe["unit"]);
      const double factor = power == powers.end() ? 1 : std::pow(unit, -power->second);
      const nlohmann::json flat = probe["value"].flatten();
      for (const nlohmann::json& v : flat)
        if (v.is_number()) result[name].push_back(v.get<double>() * factor);
    }
    std::filesystem::remove_all(folder_ / "out");
    return result;
  }

  void expect_same(const std::map<std::string, std::vector<double>>& a,
                   const std::map<std::string, std::vector<double>>& b, double tolerance) const {
    ASSERT_FALSE(a.empty());
    ASSERT_EQ(a.size(), b.size());
    for (const auto& [name, values] : a) {
      const std::vector<double>& others = b.at(name);
      ASSERT_EQ(values.size(), others.size()) << name;
      double largest = 0;
      for (const double v : values) largest = std::max(largest, std::abs(v));
      ASSERT_GT(largest, 0) << name;
      for (std::size_t i = 0; i < values.size(); ++i)
        EXPECT_NEAR(values[i], others[i], tolerance * largest) << name << " " << i;
    }
  }
};

struct BodyKind {
  const char* name;
  const char* text;  ///< of a bar of 1 × 0.2 × 0.2 m
};
void PrintTo(const BodyKind& kind, std::ostream* out) { *out << kind.name; }
const BodyKind kBodies[] = {
    {"grid",
     "model = \"meshless\"\ndomain = { box = { min = [0, 0, 0], max = [1, 0.2, 0.2] } }\nframes = { grid = [5, "
     "2, 2] }\n"},
    {"scattered",
     "model = \"meshless\"\ndomain = { box = { min = [0, 0, 0], max = [1, 0.2, 0.2] } }\nframes = { "
     "poisson_disk = 0.15 }\n"},
    {"cylinder",
     "model = \"meshless\"\ndomain = { cylinder = { from = [0, 0.1, 0.1], to = [1, 0.1, 0.1], radius = 0.1 "
     "} }\nframes = { poisson_disk = 0.15 }\n"},
    {"tetrahedra",
     "model = \"tetrahedra\"\ndomain = { box = { min = [0, 0, 0], max = [1, 0.2, 0.2], cells = [6, 2, 2] "
     "} }\n"},
    {"hexahedra",
     "model = \"hexahedra\"\norder = 2\ndomain = { box = { min = [0, 0, 0], max = [1, 0.2, 0.2], cells = [4, 1, 1] "
     "} }\n"},
    {"sheet",
     "model = \"meshless\"\ndomain = { rectangle = { origin = [0, 0, 0.1], edge_u = [1, 0, 0], edge_v = [0, "
     "0.2, 0] } }\nthickness = 0.1\nframes = { poisson_disk = 0.1 }\n"},
    {"line",
     "model = \"meshless\"\ndomain = { line = { from = [0, 0.1, 0.1], to = [1, 0.1, 0.1] } }\nradius = "
     "0.1\nframes = { poisson_disk = 0.1 }\n"},
    {"shell",
     "model = \"shell\"\ndomain = { rectangle = { origin = [0, 0, 0.1], edge_u = [1, 0, 0], edge_v = [0, 0.2, "
     "0], cells = [6, 2] } }\nthickness = 0.1\n"}};

/// Pulled and bent at its other end.
/// @param region  what is held
std::string bar(const std::string& body, const std::string& region) {
  return "[bodies.bar]\n" + body +
         "density = 1000\nmaterial = { young = 1e5, poisson = 0.3 }\n[[constraints]]\nbody = \"bar\"\nwhere = { " +
         region +
         " }\nfix = \"all\"\n[[loads]]\nbody = \"bar\"\nwhere = { box = { min = [0.99, -1, -1], max = [1.01, 1, 1] } "
         "}\ntotal_force = [20, 4, -2]\n[solver]\nkind = \"static\"\n[probes.end]\nbody = \"bar\"\nat = [1, 0.1, "
         "0.1]\nquantity = \"displacement\"\n[probes.held]\nbody = \"bar\"\nwhere = { " +
         region + " }\nquantity = \"force\"\n";
}

const char* const kFace = "box = { min = [-0.01, -1, -1], max = [0.01, 1, 1] }";

class SimilarBodies : public Similarity, public ::testing::WithParamInterface<BodyKind> {};

/// Its own numbers must not decide what a region selects.
TEST_P(SimilarBodies, HeldByGenerousRegions) {
  const auto narrow = values(bar(GetParam().text, kFace));
  for (const double far : {3e6, 1e9, 1e15}) {
    SCOPED_TRACE(far);
    const std::string box = "box = { min = " + vector(-far, -far, -far) + ", max = " + vector(0.01, far, far) + " }";
    const std::string half = "halfspace = { point = " + vector(0.01, far, -far) + ", normal = [1, 0, 0] }";
    const std::string ball = "sphere = { center = " + vector(-far, 0.1, 0.1) + ", radius = " + number(far) + " }";
    const std::string tube = "cylinder = { from = " + vector(-far, 0, 0) + ", to = [0.01, 0, 0], radius = 1 }";
    for (const std::string& region : {box, half, tube}) expect_same(narrow, values(bar(GetParam().text, region)), 1e-9);
    if (far >= 1e9) expect_same(narrow, values(bar(GetParam().text, ball)), 1e-9);
  }
}

/// A body far from the origin, where its coordinates keep 9 digits of its size.
TEST_P(SimilarBodies, FarFromTheOrigin) {
  const std::string near = bar(GetParam().text, kFace);
  expect_same(values(near), values(moved(near, {4e6, -3e6, 1e6})), 1e-6);
}

TEST_F(Similarity, AMeshFileFarFromTheOrigin) {
  const auto at = [&](const std::array<double, 3>& by) {
    FileMesh mesh = hexahedra_beam(4);
    for (auto& node : mesh.nodes)
      for (std::size_t a = 0; a < 3; ++a) node[a] += by[a];
    write("beam.msh", mesh.text());
    return values(moved(bar("model = \"hexahedra\"\ndomain = { file = \"beam.msh\" }\n", kFace), by));
  };
  expect_same(at({0, 0, 0}), at({4e6, -3e6, 1e6}), 1e-6);
}

/// A bar that ends in a rigid block on which the load acts: arms and moments are differences of coordinates.
TEST_F(Similarity, ARigidEndFarFromTheOrigin) {
  const std::string scene = with(bar(kBodies[3].text, kFace), "body = \"bar\"\nwhere = { box = { min = [0.99",
                                 "body = \"block\"\nwhere = { box = { min = [1.19");
  const std::string ended = with(scene, "max = [1.01, 1, 1]", "max = [1.21, 1, 1]") +
                            "[bodies.block]\nmodel = \"rigid\"\ndomain = { box = { min = [1, 0, 0], max = [1.2, 0.2, "
                            "0.2] } }\ndensity = 1000\n[couplings.end]\nkind = \"weld\"\nbody = \"bar\"\nwhere = { "
                            "box = { min = [0.999, -1, -1], max = [1.001, 1, 1] } }\nto = \"block\"\n";
  expect_same(values(ended), values(moved(ended, {4e6, -3e6, 1e6})), 1e-6);
}

/// Distances to a far point differ by less than they are rounded to.
TEST_F(Similarity, TheNodeNearestToAFarPoint) {
  const auto pulled = [&](const std::string& point) {
    return values(bar(kBodies[3].text, kFace) + "[[loads]]\nbody = \"bar\"\nwhere = { nearest = " + point +
                  " }\ntotal_force = [1, 2, 3]\n");
  };
  const auto corner = pulled("[1, 0.2, 0]");
  for (const double far : {10.0, 1e6, 1e9, 1e15}) {
    SCOPED_TRACE(far);
    expect_same(corner, pulled(vector(far, 0.3 * far, -0.5 * far)), 1e-12);
  }
}

TEST_P(SimilarBodies, InOtherUnits) {
  const std::string scene = bar(GetParam().text, kFace);
  const auto metres = values(scene);
  for (const double unit : {1e-6, 1e-3, 1e3, 1e6}) {
    SCOPED_TRACE(unit);
    expect_same(metres, values(in_unit(scene, unit), unit), 1e-6);
  }
}

/// A block whose frames have many neighbours at equal distances: which of them owned the pieces between was decided by
/// rounding, and the strains by 7e-4 of their size.
TEST_F(Similarity, ScatteredStretchInOtherUnits) {
  const std::string scene =
      with(read_text(fascia::test::source_dir().string() + "/scenes/scattered_stretch.toml"), "\"20 mm\"", "0.02");
  const auto metres = values(scene);
  for (const double unit : {1e-6, 1e-3, 1e3}) {
    SCOPED_TRACE(unit);
    expect_same(metres, values(in_unit(scene, unit), unit), 1e-6);
  }
}

/// What double numbers cannot hold is said; a translation to the origin, as is advised, mends it.
TEST_F(Similarity, FarBodiesWarnOfLostDigits) {
  const std::string far = moved(bar(kBodies[0].text, kFace), {4e9, 0, 0});
  write("far.toml", far);
  const ProgramResult r = fascia({"check", "far.toml"});
  EXPECT_EQ(r.status, 0) << r.err;
  EXPECT_NE((r.out + r.err).find("keep 6 digits of its size"), std::string::npos) << r.out << r.err;
  write("near.toml", moved(bar(kBodies[0].text, kFace), {4e6, 0, 0}));
  const ProgramResult near = fascia({"check", "near.toml"});
  EXPECT_EQ((near.out + near.err).find("digits of its size"), std::string::npos) << near.out << near.err;
}

/// Weights that reach over far too many frames make a stiffness that is as good as singular: check says so.
TEST_F(Similarity, FramesThatReachFarAreWarnedOf) {
  const auto said = [&](const char* neighbours) {
    write("line.toml",
          "[bodies.l]\nmodel = \"meshless\"\ndomain = { line = { from = [0, 0, 0], to = [0.5, 0, 0] } }\nradius = "
          "0.007\nframes = { count = 54 }\nweights = { neighbours = " +
              std::string(neighbours) +
              " }\ndensity = 1000\nmaterial = { young = 1e6, poisson = 0.3 }\n[solver]\nkind = \"modes\"\n");
    return fascia({"check", "line.toml"}).err;
  };
  EXPECT_NE(said("33").find("bodies.l: points follow 33 frames"), std::string::npos);
  EXPECT_EQ(said("8").find("points follow"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Bodies, SimilarBodies, ::testing::ValuesIn(kBodies),
                         [](const auto& kind) { return std::string(kind.param.name); });

}  // namespace

}  // namespace fascia::similarity_test
