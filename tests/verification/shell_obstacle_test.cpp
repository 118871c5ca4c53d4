// The linear obstacle course of shells (Belytschko et al. 1985, MacNeal and Harder 1985), by mesh and by formulation.
#include "tests/support/shell_models.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace fascia::shell_obstacle_test {
namespace {

using namespace test;

constexpr double kPi = std::numbers::pi, kNear = 1e-6;

using Stiffness = decltype(ShellBodySpec::stiffness);

ShellModel build(const SurfaceMap& map, const PatchOptions& o, const ShellMatter& matter, const Stiffness& stiffness) {
  ShellBodySpec spec = shell_spec(patch_mesh(map, o), matter);
  if (stiffness) spec.stiffness = stiffness;
  return shell_model(std::move(spec));
}

bool is_zero(double x) { return std::abs(x) < kNear; }

/// Scordelis-Lo roof: a quarter, x along the roof from its middle, angle from the crown; downward deflection of the
/// middle of the free edge.
double roof(const PatchOptions& o, const Stiffness& stiffness) {
  const auto map = [](double u, double v) {
    const double a = 40 * v * kPi / 180;
    return Vec3d{{25 * u, 25 * std::sin(a), 25 * std::cos(a)}};
  };
  ShellModel b = build(map, o, {4.32e8, 0, 0.25}, stiffness);
  hold(
      b.model, [](const Vec3d& X) { return is_zero(X[0] - 25); }, "yz");
  hold(
      b.model, [](const Vec3d& X) { return is_zero(X[0]); }, "xYZ");
  hold(
      b.model, [](const Vec3d& X) { return is_zero(X[1]); }, "yXZ");
  add_area_load(b, {{0, 0, -90}});
  return -small_response(b.model).u[at(node_at(b.model, map(0, 1)))][2];
}

/// Pinched cylinder with diaphragms: an octant; deflection under the load.
double cylinder(const PatchOptions& o, const Stiffness& stiffness) {
  const auto map = [](double u, double v) {
    return Vec3d{{300 * u, 300 * std::sin(v * kPi / 2), 300 * std::cos(v * kPi / 2)}};
  };
  ShellModel b = build(map, o, {3e6, 0.3, 3}, stiffness);
  hold(
      b.model, [](const Vec3d& X) { return is_zero(X[0] - 300); }, "yz");
  hold(
      b.model, [](const Vec3d& X) { return is_zero(X[0]); }, "xYZ");
  hold(
      b.model, [](const Vec3d& X) { return is_zero(X[1]); }, "yXZ");
  hold(
      b.model, [](const Vec3d& X) { return is_zero(X[2]); }, "zXY");
  const int loaded = node_at(b.model, {{0, 0, 300}});
  add_node_load(b.model, loaded, {{0, 0, -0.25}});
  return -small_response(b.model, 1).u[at(loaded)][2];
}

/// Hemisphere with an 18° hole: a quarter; deflection under one of the opposite loads.
double hemisphere(const PatchOptions& o, const Stiffness& stiffness) {
  const auto map = [](double u, double v) {
    const double a = u * kPi / 2, p = 72 * v * kPi / 180;
    return Vec3d{{10 * std::cos(p) * std::cos(a), 10 * std::cos(p) * std::sin(a), 10 * std::sin(p)}};
  };
  ShellModel b = build(map, o, {6.825e7, 0.3, 0.04}, stiffness);
  hold(
      b.model, [](const Vec3d& X) { return is_zero(X[1]); }, "yXZ");
  hold(
      b.model, [](const Vec3d& X) { return is_zero(X[0]); }, "xYZ");
  const int in_x = node_at(b.model, {{10, 0, 0}}), in_y = node_at(b.model, {{0, 10, 0}});
  hold(
      b.model,
      [](const Vec3d& X) {
        return is_zero(norm(X - Vec3d{{10, 0, 0}}));
      },
      "z");
  add_node_load(b.model, in_x, {{1, 0, 0}});
  add_node_load(b.model, in_y, {{0, -1, 0}});
  return small_response(b.model, 1e-4).u[at(in_x)][0];
}

struct Case {
  const char* name;
  double (*deflection)(const PatchOptions&, const Stiffness&);
  double reference, at_16, at_32;
};

/// Sources and settled values: shared/references.md, section 6.
const Case kCases[] = {{"Scordelis-Lo roof", roof, 0.3024, 0.02, 0.01},
                       {"pinched cylinder", cylinder, 1.8248e-5, 0.05, 0.02},
                       {"hemisphere, 18 deg hole", hemisphere, 0.0937, 0.02, 0.01}};

TEST(ShellObstacles, ConvergeOnEveryMesh) {
  std::printf("deflection / reference    n   right   left    both    irregular diagonals\n");
  for (const Case& c : kCases)
    for (const int n : {4, 8, 16, 32}) {
      std::printf("%-24s %3d", c.name, n);
      for (const PatchOptions& o : {PatchOptions{n, n, Diagonals::right},
                                    {n, n, Diagonals::left},
                                    {n, n, Diagonals::alternating},
                                    {n, n, Diagonals::alternating, 0.25}}) {
        const double ratio = c.deflection(o, {}) / c.reference;
        std::printf("  %.4f", ratio);
        if (n >= 16) {
          EXPECT_NEAR(ratio, 1, n == 16 ? c.at_16 : c.at_32) << c.name << ' ' << n;
        }
      }
      std::printf("\n");
    }
}

// ------------------------------------------------------------------------------------------- other formulations
double& entry(double* packed, int i, int j) { return packed[i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i]; }

/// Constant strain, and rotations about the normal tied by a spring.
ShellConstants<double> constant_strain(const PlaneTriangle& p, const ShellSection& s) {
  ShellConstants<double> c = shell_stiffness(p, s);
  std::fill(std::begin(c.membrane), std::end(c.membrane), 0.0);
  const double volume = linear_gradients(p).area * s.thickness;
  const auto C = plane_stress(s);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) entry(c.membrane, i, j) = volume * C[at(i)][at(j)];
    entry(c.membrane, 3 + i, 3 + i) = 1e-3 * volume * s.young;
  }
  return c;
}

/// Linear rotations of a director with the discrete shear gap of Bletzinger, Bischoff and Ramm (2000).
void use_shear_gap(const PlaneTriangle& p, const ShellSection& s, ShellConstants<double>& c) {
  const LinearGradients l = linear_gradients(p);
  const double x2 = p[1][0] - p[0][0], y2 = p[1][1] - p[0][1], x3 = p[2][0] - p[0][0], y3 = p[2][1] - p[0][1];
  // Slopes (β₁, β₂) of the corners → κ and γ; β₁ = θ_y, β₂ = −θ_x.
  std::array<std::array<double, 6>, 5> B{};
  const std::array<std::array<double, 4>, 3> gap{{{l.area, 0, 0, l.area},
                                                  {x2 * y3 / 2, y2 * y3 / 2, -x2 * x3 / 2, -y2 * x3 / 2},
                                                  {-y2 * x3 / 2, -y2 * y3 / 2, x2 * x3 / 2, x2 * y3 / 2}}};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t first = 2 * a + 1, second = 2 * a;
    B[0][first] = l.g[a][0];
    B[1][second] = -l.g[a][1];
    B[2][first] = l.g[a][1];
    B[2][second] = -l.g[a][0];
    for (std::size_t row = 0; row < 2; ++row) {
      B[3 + row][first] = gap[a][2 * row] / (2 * l.area);
      B[3 + row][second] = -gap[a][2 * row + 1] / (2 * l.area);
    }
  }
  const auto C = plane_stress(s);
  const double bend = l.area * std::pow(s.thickness, 3) / 12,
               shear = l.area * s.thickness * 5 / 6 * s.young / (2 * (1 + s.poisson));
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = 0;
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b) sum += bend * B[a][i] * C[a][b] * B[b][j];
      for (std::size_t a = 3; a < 5; ++a) sum += shear * B[a][i] * B[a][j];
      entry(c.bending, static_cast<int>(i), static_cast<int>(j)) = sum;
    }
}

/// The table of docs/decisions/shell_formulation.md.
TEST(ShellObstacles, FormulationsCompared) {
  const std::pair<const char*, Stiffness> formulations[] = {
      {"chosen", {}},
      {"OPT as on flat meshes",
       [](const PlaneTriangle& p, ShellSection s) {
         s.tilt = 0;
         return shell_stiffness(p, s);
       }},
      {"constant strain, DKMT", constant_strain},
      {"constant strain, shear gap",
       [](const PlaneTriangle& p, const ShellSection& s) {
         ShellConstants<double> c = constant_strain(p, s);
         use_shear_gap(p, s, c);
         return c;
       }},
      {"OPT, shear gap", [](const PlaneTriangle& p, const ShellSection& s) {
         ShellConstants<double> c = shell_stiffness(p, s);
         use_shear_gap(p, s, c);
         return c;
       }}};
  std::printf("deflection / reference, irregular meshes, n = 8, 16, 32\n%-28s", "");
  for (const Case& c : kCases) std::printf("%-27s", c.name);
  std::printf("\n");
  std::array<double, 3> chosen{};
  for (const auto& [name, stiffness] : formulations) {
    std::printf("%-28s", name);
    for (std::size_t k = 0; k < 3; ++k) {
      for (const int n : {8, 16, 32}) {
        const double ratio =
            kCases[k].deflection({n, n, Diagonals::alternating, 0.25}, stiffness) / kCases[k].reference;
        std::printf("%.4f   ", ratio);
        if (n != 16) continue;
        if (!stiffness) chosen[k] = std::abs(ratio - 1);
        EXPECT_LE(chosen[k], std::abs(ratio - 1) + 0.01) << name;
      }
    }
    std::printf("\n");
  }
}

}  // namespace
}  // namespace fascia::shell_obstacle_test
