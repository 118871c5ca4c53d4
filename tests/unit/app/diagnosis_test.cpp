#include "app/diagnosis/condition.hpp"
#include "app/diagnosis/thickness.hpp"
#include "app/reader/parse.hpp"
#include "app/run/temporary_folder.hpp"
#include "assembly/build/build_simulation.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "assembly/simulation/step_limit.hpp"
#include "core/math/dense.hpp"
#include "core/run/explicit_dynamics.hpp"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>

// Diagnosis of a scene before its run, against dense eigenvalues and the power method.
namespace fascia::app::diagnosis_test {
namespace {

constexpr const char* kStatic = "kind = \"static\"";
constexpr const char* kExplicit = "kind = \"explicit\"\ntime_step = \"auto\"\nduration = 0.1";

/// A body with its end at x = 0 held.
std::string scene(const std::string& body, const std::string& solver, const std::string& materials = "") {
  return fmt::format(
      "[materials.soft]\nyoung = \"20 kPa\"\npoisson = 0.3\n{}[bodies.b]\ndensity = 1000\n{}\n[[constraints]]\nbody = "
      "\"b\"\nwhere = {{ box = {{ min = [-0.001, -9, -9], max = [0.001, 9, 9] }} }}\nfix = \"all\"\n[solver]\n{}\n",
      materials, body, solver);
}

std::string box(const std::string& model, const char* max, const std::string& cells,
                const std::string& more = "material = \"soft\"") {
  const bool frames = model == "meshless";
  return fmt::format("model = \"{}\"\ndomain = {{ box = {{ min = [0, 0, 0], max = {}{} }} }}\n{}{}\n", model, max,
                     frames ? "" : ", cells = " + cells, frames ? "frames = { grid = " + cells + " }\n" : "", more);
}

Simulation build(const std::string& text) { return build_simulation(parse_scene_text(text, "a.toml", {})); }

/// λmax/λmin of K x = λ M x, M the diagonal blocks of K by node, on the free degrees of freedom; by K's columns.
double dense_condition(const Model& model, MechanicalSystem& system) {
  const DofFilter& filter = system.filter();
  const DofLayout& dofs = model.points.dofs;
  std::vector<std::size_t> free;
  std::vector<int> node_of;
  for (int node = 0; node < model.node_count(); ++node)
    for (int k = dofs.begin(node); k < dofs.begin(node) + dofs.size(node); ++k)
      if (!filter.is_fixed(at(k))) {
        free.push_back(at(k));
        node_of.push_back(node);
      }
  const auto n = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd K(n, n), M = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    std::vector<double> e(at(model.dof_count()), 0.0);
    e[free[static_cast<std::size_t>(j)]] = 1;
    const std::vector<double> column = system.product(e);
    for (Eigen::Index i = 0; i < n; ++i) {
      K(i, j) = column[free[static_cast<std::size_t>(i)]];
      if (node_of[static_cast<std::size_t>(i)] == node_of[static_cast<std::size_t>(j)]) M(i, j) = K(i, j);
    }
  }
  const Eigenpairs pairs = symmetric_eigen(K, M);
  return pairs.values[n - 1] / pairs.values[0];
}

TEST(Condition, AgreesWithDenseEigenvalues) {
  std::printf("%-34s %10s %10s %6s %6s\n", "model", "dense", "estimate", "CG", "digits");
  const std::pair<const char*, std::string> models[] = {
      {"tetrahedra", box("tetrahedra", "[0.4, 0.1, 0.1]", "[6, 2, 2]")},
      {"hexahedra, thin", box("hexahedra", "[1, 0.1, 0.01]", "[8, 2, 1]")},
      {"rigid frames", box("meshless", "[0.4, 0.1, 0.1]", "[5, 3, 3]")},
      {"affine frames",
       "model = \"meshless\"\ndomain = { box = { min = [0, 0, 0], max = [0.4, 0.1, 0.1] } }\n"
       "frames = { grid = [3, 2, 2], kind = \"affine\" }\nmaterial = \"soft\"\n"},
      {"shell",
       "model = \"shell\"\ndomain = { rectangle = { origin = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 0.2, 0], "
       "cells = [8, 2] } }\nthickness = 0.01\nmaterial = \"soft\"\n"}};
  for (const auto& [name, body] : models) {
    const Simulation s = build(scene(body, kStatic));
    ThreadPool pool(1);
    SolverSettings settings = settings_of(s.scene.solver);
    settings.cg.max_iterations = 10000;
    MechanicalSystem system(s.model, pool, settings);
    system.begin_step(s.initial, 0);
    system.evaluate();
    const double dense = dense_condition(s.model, system);
    const TangentCondition c = system.condition(1e12);
    std::printf("%-34s %10.3e %10.3e %6d %6.1f\n", name, dense, c.ratio(), c.cg_iterations, c.digits());
    ASSERT_EQ(c.kind, TangentCondition::Kind::known) << name;
    EXPECT_NEAR(c.ratio() / dense, 1, 0.02) << name;
    EXPECT_TRUE(c.cg_converged);
    EXPECT_LT(c.cg_iterations, 0.5 * std::sqrt(dense) * std::log(2 / settings.cg.tolerance) + 2) << name;
    EXPECT_EQ(system.condition(1).kind, TangentCondition::Kind::left_out);
  }
}

TEST(Condition, IsToldInOneLine) {
  const std::string sound = condition_line(build(scene(box("tetrahedra", "[0.4, 0.2, 0.2]", "[4, 2, 2]"), kStatic)));
  EXPECT_NE(sound.find("conjugate gradients take about"), std::string::npos) << sound;
  EXPECT_EQ(sound.find("so few"), std::string::npos) << sound;
  // A thread of 1/2000 of its length, of a stiffness that a softer end hangs on.
  const std::string thin = condition_line(build(scene(box("hexahedra", "[10, 0.001, 0.001]", "[40, 1, 1]"), kStatic)));
  EXPECT_NE(thin.find("so few"), std::string::npos) << thin;
  EXPECT_EQ(condition_line(build(scene(box("hexahedra", "[1, 1, 1]", "[1, 1, 1]"), kExplicit))), "");
}

/// 2/ω by power iterations with M⁻¹ K; vertices.
double limit_by_powers(const Model& model, MechanicalSystem& system) {
  std::mt19937 random(7);
  std::vector<double> x(at(model.dof_count()));
  for (double& v : x) v = static_cast<double>(random()) / 4294967295.0 - 0.5;
  double squared = 0;
  system.begin_step(State::at_rest(model), 0);
  system.evaluate();
  for (int round = 0; round < 400; ++round) {
    system.filter().clear_fixed(x);
    std::vector<double> y = system.product(x);
    double xy = 0, xx = 0, size = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double m = model.inertia[i / 3].mass;
      xy += x[i] * y[i];
      xx += x[i] * m * x[i];
      y[i] /= m;
      size = std::max(size, std::abs(y[i]));
    }
    squared = xy / xx;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = y[i] / size;
  }
  return 2 / std::sqrt(squared);
}

struct Limit {
  Simulation simulation;
  StepLimit found;
};

Limit limit_of(const std::string& text) {
  Limit out{build(text), {}};
  ThreadPool pool(1);
  MechanicalSystem system(out.simulation.model, pool, settings_of(out.simulation.scene.solver));
  out.found = step_limit(out.simulation, system);
  const double step = stable_time_step(system, out.simulation.initial) / kStableMargin;
  if (!out.simulation.model.has_frames()) {
    const double powers = limit_by_powers(out.simulation.model, system);
    std::printf("limit %.5e s, by powers %.5e s: %s\n", step, powers, out.found.text.c_str());
    EXPECT_NEAR(step / powers, 1, 0.01);
  }
  return out;
}

/// A block, and beside it a tetrahedron that is all but flat: element 7.
std::string mesh_with_a_sliver(double height) {
  return fmt::format(
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n9\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 1 1 0\n5 0 0 1\n6 1 0 1\n7 0 1 "
      "1\n8 "
      "1 1 1\n9 0.7 0.6 {}\n$EndNodes\n$Elements\n7\n1 4 2 0 1 1 2 4 8\n2 4 2 0 1 1 4 3 8\n3 4 2 0 1 1 3 7 8\n4 4 2 0 "
      "1 "
      "1 7 5 8\n5 4 2 0 1 1 5 6 8\n6 4 2 0 1 1 6 2 8\n7 4 2 0 1 5 6 8 9\n$EndElements\n",
      1 + height);
}

std::string mesh_body(const std::filesystem::path& file, double height) {
  std::ofstream(file) << mesh_with_a_sliver(height);
  return fmt::format("model = \"tetrahedra\"\ndomain = {{ file = \"{}\" }}\nmaterial = \"soft\"\n", file.string());
}

TEST(StepLimit, IsThePlantedElement) {
  const Limit even = limit_of(scene(box("hexahedra", "[0.4, 0.2, 0.2]", "[4, 2, 2]"), kExplicit));
  EXPECT_EQ(even.found.text.find(";"), std::string::npos) << even.found.text;
  EXPECT_NEAR(even.found.speed, std::sqrt(20e3 * 0.7 / (1.3 * 0.4) / 1000), 1e-9);
  const std::string stiff = "[materials.stiff]\nyoung = \"500 kPa\"\npoisson = 0.3\n";
  const Limit hard = limit_of(scene(box("hexahedra", "[0.8, 0.1, 0.1]", "[8, 1, 1]",
                                        "material = [{ where = { box = { min = [0.51, -1, -1], max = [0.59, 1, 1] } }, "
                                        "use = \"stiff\" }, { use = \"soft\" }]"),
                                    kExplicit, stiff));
  EXPECT_NE(hard.found.text.find("at (0.55"), std::string::npos) << hard.found.text;
  EXPECT_NE(hard.found.text.find("times the mean stiffness"), std::string::npos) << hard.found.text;
  const TemporaryFolder folder("sliver");
  const std::filesystem::path file = folder.path() / "sliver.msh";
  const Limit flat = limit_of(scene(mesh_body(file, 0.05), kExplicit));
  EXPECT_NE(flat.found.text.find("element 7 at"), std::string::npos) << flat.found.text;
  EXPECT_NE(flat.found.text.find("of the mean size"), std::string::npos) << flat.found.text;
  const std::string quality = flat.simulation.bodies[0].body->quality();
  EXPECT_NE(quality.find("(element 7 at"), std::string::npos) << quality;
  const Limit frames = limit_of(scene(box("meshless", "[0.4, 0.2, 0.2]", "[4, 3, 3]"), kExplicit));
  EXPECT_NE(frames.found.text.find("integration point at"), std::string::npos) << frames.found.text;
}

TEST(Thickness, OneLinearElementIsTold) {
  const auto line = [](const std::string& body) { return thickness_line(build(scene(body, kStatic)), 0); };
  const std::string thin = line(box("hexahedra", "[1, 0.3, 0.02]", "[10, 3, 1]"));
  EXPECT_NE(thin.find("one hexahedron of about"), std::string::npos) << thin;
  EXPECT_NE(thin.find("about 20 mm"), std::string::npos) << thin;
  EXPECT_EQ(line(box("hexahedra", "[1, 0.3, 0.02]", "[10, 3, 2]")), "");
  EXPECT_EQ(line(box("hexahedra", "[1, 0.3, 0.02]", "[10, 3, 1]", "order = 2\nmaterial = \"soft\"")), "");
  EXPECT_EQ(line(box("hexahedra", "[1, 1, 1]", "[1, 1, 1]")), "");
}

TEST(Support, ScatteredFramesTellTheirNarrowestSpread) {
  const Simulation s =
      build(scene("model = \"meshless\"\ndomain = { box = { min = [0, 0, 0], max = [1, 0.5, 0.5] } }\n"
                  "frames = { poisson_disk = 0.2 }\nmaterial = \"soft\"\n",
                  kStatic));
  const std::string quality = s.bodies[0].body->quality();
  EXPECT_NE(quality.find("frames are spread least about ("), std::string::npos) << quality;
}

}  // namespace
}  // namespace fascia::app::diagnosis_test
