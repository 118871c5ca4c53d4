#include "tests/robustness/element_scenes.hpp"

#include <cmath>

namespace fascia::element_inputs_test {

// Finite elements from unusual but sound input: the answer must be right, or the input refused; never silently wrong.
namespace {

using namespace fascia::test;

using Vector = std::array<double, 3>;
using Matrix = std::array<Vector, 3>;

std::string text_of(const Vector& v) {
  std::array<char, 90> text{};
  std::snprintf(text.data(), text.size(), "[%.17g, %.17g, %.17g]", v[0], v[1], v[2]);
  return text.data();
}

Vector operator*(const Matrix& R, const Vector& v) {
  Vector result{};
  for (std::size_t i = 0; i < 3; ++i) result[i] = R[i][0] * v[0] + R[i][1] * v[1] + R[i][2] * v[2];
  return result;
}

Vector operator+(const Vector& a, const Vector& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

double difference(const Vector& a, const Vector& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

/// Rotation about an axis of length 1 (Rodrigues).
Matrix rotation(const Vector& a, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  Matrix R{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t k = 3 - i - j;
      R[i][j] = (i == j ? c : ((j + 3 - i) % 3 == 1 ? -s : s) * a[k]) + (1 - c) * a[i] * a[j];
    }
  return R;
}

class ElementInputs : public SceneRuns {
 protected:
  struct Outcome {
    int status = -1;
    std::string err;
    nlohmann::json summary;

    /// NaN, which no comparison accepts, where there is no such value.
    Vector vector(const std::string& probe) const {
      if (status != 0 || summary.is_discarded()) return {NAN, NAN, NAN};
      const nlohmann::json value = summary.at("probes").at(probe).at("value");
      return {value.at(0), value.at(1), value.at(2)};
    }
  };

  Outcome run(const std::string& scene) const {
    write("scene.toml", scene);
    const ProgramResult result = fascia({"run", "scene.toml", "--json", "--threads", "1", "--output", "out"});
    Outcome outcome{result.status, result.err, nlohmann::json::parse(result.out, nullptr, false)};
    EXPECT_TRUE(result.status == 2 || !outcome.summary.is_discarded()) << result.err;
    return outcome;
  }
  Outcome run_well(const std::string& scene) const {
    Outcome outcome = run(scene);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome;
  }
};

std::string tight(const std::string& scene) {
  return with(scene, "kind = \"static\"\n", "kind = \"static\"\nnewton = { tolerance = 1e-12 }\n");
}

std::string as(const std::string& scene, const std::string& model, int order, const std::string& more) {
  return with(with(scene, "\"tetrahedra\"", "\"" + model + "\""),
              "density  =", "order = " + std::to_string(order) + "\n" + more + "\ndensity  =");
}

/// The support's force and moment on the body, the moment about the origin.
std::string with_reactions(const std::string& scene, const std::string& load) {
  std::string text = with(scene, "gravity = [0, -1, 0]", "gravity = [0, 0, 0]");
  text += "[[loads]]\nbody = \"beam\"\n" + load + "\n";
  for (const char* quantity : {"force", "moment"})
    text += "[probes." + std::string(quantity) + "]\nbody = \"beam\"\nquantity = \"" + quantity +
            "\"\nwhere = " + kClamp + "\n";
  return text;
}

constexpr const char* kEnd = "{ box = { min = [0.99, -1, -1], max = [1.01, 1, 1] } }";

TEST_F(ElementInputs, ResultsTurnWithTheBody) {
  const Vector axis{0.6, 0, 0.8}, shift{0.3, 0.7, -0.2}, gravity{0, -1, 0.3};
  const double angle = 1.1;
  const Matrix R = rotation(axis, angle);
  std::printf("model        order  formulation          largest u [m]  difference in turned axes / u\n");
  for (const char* model : {"tetrahedra", "hexahedra"})
    for (const int order : {1, 2})
      for (const char* formulation : {"st-venant-kirchhoff", "corotational", "linear"}) {
        const std::string more = std::string("formulation = \"") + formulation + "\"\n";
        const auto scene = [&](const Matrix& Q, const Vector& t, const std::string& transform) {
          std::string keys = more;
          keys += transform;
          std::string text = as(tight(kElements), model, order, keys);
          text = with(text, "gravity = [0, -1, 0]", "gravity = " + text_of(Q * gravity));
          text = with(text, "at = [1, 0.1, 0.1]", "at = " + text_of(Q * Vector{1, 0.1, 0.1} + t));
          return with(text, kClamp,
                      "{ halfspace = { point = " + text_of(t) + ", normal = " + text_of(Q * Vector{1, 0, 0}) + " } }");
        };
        const Vector u = run_well(scene(rotation(axis, 0), {}, "")).vector("tip");
        const Vector turned = run_well(scene(R, shift,
                                             "transform = { translate = " + text_of(shift) +
                                                 ", rotate = { axis = " + text_of(axis) + ", angle = 1.1 } }"))
                                  .vector("tip");
        const double error = difference(R * u, turned) / difference(u, {});
        std::printf("%-12s %d      %-20s %.6g        %.1e\n", model, order, formulation, difference(u, {}), error);
        EXPECT_LT(error, 1e-9) << "rounding of rotated coordinates only";
      }
}

TEST_F(ElementInputs, MillimetresGiveTheSameAnswerAsMetres) {
  const char* big = "{ box = { min = [0, 0, 0], max = [1000, 200, 200], cells = [5, 1, 1] } }";
  for (const char* model : {"tetrahedra", "hexahedra"}) {
    const Vector u = run_well(as(tight(kElements), model, 2, "")).vector("tip");
    const std::string scaled = with(as(tight(kElements), model, 2, "transform = { scale = 0.001 }"), kElementBox, big);
    std::string units = with(as(tight(kElements), model, 2, ""), kElementBox, big);  // mm, N, tonnes, MPa
    units = with(units, kClamp, "{ halfspace = { point = [0, 0, 0], normal = [1, 0, 0] } }");
    units = with(with(units, "\"100 kPa\"", "0.1"), "= 1000\n", "= 1e-9\n");
    units = with(with(units, "gravity = [0, -1, 0]", "gravity = [0, -1000, 0]"), "[1, 0.1, 0.1]", "[1000, 100, 100]");
    const Vector in_mm = run_well(units).vector("tip");
    const double by_scale = difference(u, run_well(scaled).vector("tip")) / difference(u, {});
    const double by_units = difference(u, {in_mm[0] / 1000, in_mm[1] / 1000, in_mm[2] / 1000}) / difference(u, {});
    std::printf("%-12s scaled %.1e, in mm, N and tonnes %.1e\n", model, by_scale, by_units);
    EXPECT_LT(by_scale, 1e-9);
    EXPECT_LT(by_units, 1e-9);
  }
}

TEST_F(ElementInputs, GroupsSelectTheirNodesAndElements) {
  write("beam.msh", tetrahedra_beam().text());
  const std::string scene = scene_of_file("beam.msh");
  const Vector u = run_well(scene).vector("tip");
  for (const char* region : {"{ group = \"hilum\" }", "{ group = 5 }", "{ ids = [0, 3, 6, 9] }",
                             "{ all_of = [{ group = \"hilum\" }, { boundary = true }] }",
                             "{ any_of = [{ group = 5 }, { ids = [0] }] }", "{ not = { group = \"stiff\" } }"})
    EXPECT_LT(difference(run_well(with(scene, kClamp, region)).vector("tip"), u), 1e-15) << region;
  const std::string by_group = "material = [{ where = { group = \"stiff\" }, use = { young = 1e6, poisson = 0.3 } }, ";
  const std::string by_box =
      "material = [{ where = { box = { min = [0.5, 0, 0], max = [1, 1, 1] } }, "
      "use = { young = 1e6, poisson = 0.3 } }, ";
  const Vector stiff = run_well(with(scene, "material = \"soft\"", by_group + "{ use = \"soft\" }]")).vector("tip");
  EXPECT_LT(
      difference(run_well(with(scene, "material = \"soft\"", by_box + "{ use = \"soft\" }]")).vector("tip"), stiff),
      1e-15);
  EXPECT_LT(stiff[1], 0);
  EXPECT_GT(stiff[1], 0.95 * u[1]);
  const Outcome loaded =
      run_well(with_reactions(scene, "where = { group = \"organ\" }\ntotal_force = [1e-3, -2e-3, 0]"));
  EXPECT_LT(difference(loaded.vector("force"), {-1e-3, 2e-3, 0}), 1e-12);
}

TEST_F(ElementInputs, TorqueArrivesAtTheSupport) {
  const Vector torque{1e-3, 2e-3, 5e-4};
  for (const char* model : {"tetrahedra", "hexahedra"})
    for (const int order : {1, 2})
      for (const std::string& where : {std::string("where = ") + kEnd, std::string("at = [0.9, 0.1, 0.1]")}) {
        const std::string key = where[0] == 'w' ? "\ntotal_torque = " : "\ntorque = ";
        const Outcome outcome = run_well(
            with_reactions(as(kElements, model, order, "formulation = \"linear\""), where + key + text_of(torque)));
        EXPECT_LT(difference(outcome.vector("moment"), {-1e-3, -2e-3, -5e-4}), 1e-9 * 2e-3) << model << order << where;
        EXPECT_LT(difference(outcome.vector("force"), {}), 1e-9 * 2e-3) << model << order << where;
      }
}

TEST_F(ElementInputs, TorqueOnNodesThatCannotCarryItIsNotLost) {
  for (const char* ids : {"[5]", "[5, 23]"}) {
    const Outcome outcome =
        run(with_reactions(as(kElements, "tetrahedra", 1, "formulation = \"linear\""),
                           "where = { ids = " + std::string(ids) + " }\ntotal_torque = [1e-3, 2e-3, 5e-4]"));
    if (outcome.status == 2) continue;
    EXPECT_LT(difference(outcome.vector("moment"), {-1e-3, -2e-3, -5e-4}), 1e-9) << ids;
  }
}

TEST_F(ElementInputs, FollowersTurnWithTheMaterial) {
  const std::string scene = as(kElements, "hexahedra", 1, "");
  const Outcome dead = run_well(with_reactions(scene, "at = [1, 0.1, 0.1]\nforce = [0, -5, 0]"));
  EXPECT_NEAR(dead.vector("force")[0], 0, 1e-6);
  const Outcome force = run(with_reactions(scene, "at = [1, 0.1, 0.1]\nforce = [0, -5, 0]\nfollower = true"));
  if (force.status == 0) {
    EXPECT_GT(std::abs(force.vector("force")[0]), 0.3) << "the tip turns by 0.1 rad";
  }
  const Outcome torque = run(with_reactions(scene, "at = [0.9, 0.1, 0.1]\ntorque = [0, 0, 0.5]\nfollower = true"));
  if (torque.status == 0) {
    EXPECT_NEAR(torque.vector("moment")[2], -0.5, 0.01);
  }
}

TEST_F(ElementInputs, RotationOfTheMaterialIsNotZero) {
  std::string scene =
      with(with(kElements, kClamp, "\"all\""), "quantity = \"displacement\"", "quantity = \"rotation\"");
  scene = with(scene, kAllFixed, "move = { rotate = { axis = [0, 0, 1], angle = 0.5 } }");
  const Outcome outcome = run(scene);
  if (outcome.status == 2) return;
  EXPECT_LT(difference(outcome.vector("tip"), {0, 0, 0.5}), 1e-9);
}

TEST_F(ElementInputs, FreeBodyHasSixZeroFrequencies) {
  std::string text = kElements;
  text = with(text, "gravity = [0, -1, 0]", "gravity = [0, 0, 0]");
  text = with(text, std::string("[[constraints]]\nbody  = \"beam\"\nwhere = ") + kClamp + "\nfix   = \"all\"\n", "");
  text = with(text, "kind = \"static\"", "kind = \"modes\"\ncount = 7");
  text = with(text, "body = \"beam\"\nat = [1, 0.1, 0.1]\nquantity = \"displacement\"", "quantity = \"frequency\"");
  for (const char* model : {"tetrahedra", "hexahedra"}) {
    const Outcome outcome = run(with(text, "\"tetrahedra\"", "\"" + std::string(model) + "\""));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const nlohmann::json f = outcome.summary.at("probes").at("tip").at("value");
    for (std::size_t k = 0; k < 6; ++k) EXPECT_LT(f.at(k).get<double>(), 1e-4 * f.at(6).get<double>()) << k;
  }
}

TEST_F(ElementInputs, SlantedAxesHoldVertices) {
  const char* axes = "axes = [[0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, 1]]\n";
  const std::string slide = std::string("[[constraints]]\nbody = \"beam\"\nwhere = ") + kEnd + "\n" + axes;
  const std::string load = std::string("where = ") + kEnd + "\ntotal_force = [0, -0.1, 0]\n";
  const Vector held = run_well(with_reactions(kElements, load + slide + "fix = [\"x\"]")).vector("tip");
  EXPECT_LT(held[1], -1e-7);
  EXPECT_LT(std::abs(0.8 * held[0] + 0.6 * held[1]), 1e-12);
  const std::string move = "move = { translate = [0.008, 0.006, 0], axes = [\"x\"] }";
  const Vector moved = run_well(with_reactions(kElements, load + slide + move)).vector("tip");
  EXPECT_NEAR(0.8 * moved[0] + 0.6 * moved[1], 0.01, 1e-12);
}

TEST_F(ElementInputs, PartsThatMeetInANodeAreAWarning) {
  FileMesh mesh = hexahedra_beam(), other = mesh;
  const int last = static_cast<int>(mesh.nodes.size()) - 1;  // corner (1, 0.2, 0.2), node 0 of the other beam
  for (std::size_t i = 1; i < other.nodes.size(); ++i) mesh.nodes.push_back(other.nodes[i] + Vector{1, 0.2, 0.2});
  for (FileCell cell : other.cells) {
    for (int& node : cell.nodes) node += last;
    mesh.cells.push_back(cell);
  }
  write("beam.msh", mesh.text());
  write("scene.toml", scene_of_file("beam.msh", "hexahedra"));
  const ProgramResult result = fascia({"check", "scene.toml"});
  EXPECT_NE(result.err.find("turn as on a hinge"), std::string::npos) << result.err;
}

}  // namespace

}  // namespace fascia::element_inputs_test
