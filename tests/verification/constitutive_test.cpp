// Closed forms of St Venant-Kirchhoff material on one block; unit cube, E = 1 kPa, nu = 0.3.
#include "tests/support/solved_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace fascia::test::constitutive_test {
namespace {

constexpr double kYoung = 1000, kPoisson = 0.3, kTolerance = 1e-8;
constexpr double kLambda = kYoung * kPoisson / ((1 + kPoisson) * (1 - 2 * kPoisson)),
                 kMu = kYoung / (2 * (1 + kPoisson));

using Matrix = std::array<std::array<double, 3>, 3>;

Matrix stress(const SolvedScene& run) {
  const nlohmann::json rows = run.probe("stress");
  Matrix s{};
  for (std::size_t i = 0; i < 3; ++i) s[i] = SolvedScene::as_vector(rows.is_array() ? rows[i] : nlohmann::json());
  return s;
}

std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", v);
  return text;
}

std::string translation(int constraint, const std::array<double, 3>& v) {
  return "constraints[" + std::to_string(constraint) + "].move.translate=[" + number(v[0]) + "," + number(v[1]) + "," +
         number(v[2]) + "]";
}

/// Prints and checks one value; errors are relative to `scale`.
void compare(const char* what, double parameter, double computed, double exact, double scale) {
  std::printf("%-22s %9.5f  %18.10f %18.10f  %8.1e\n", what, parameter, computed, exact,
              std::abs(computed - exact) / scale);
  EXPECT_NEAR(computed, exact, kTolerance * scale) << what << " at " << parameter;
}

void print_header() {
  std::printf("quantity               parameter            computed        closed form     error\n");
}

double uniaxial(double l) { return kYoung * l * (l * l - 1) / 2; }
double side(double l) { return std::sqrt(1 - kPoisson * (l * l - 1)); }

/// The block with its faces at l along each axis, nothing solved.
SolvedScene imposed(const std::array<double, 3>& l) {
  return SolvedScene("svk_imposed_stretch", {translation(1, {l[0] - 1, 0, 0}), translation(3, {0, l[1] - 1, 0}),
                                             translation(5, {0, 0, l[2] - 1})});
}

TEST(Constitutive, UniaxialSolved) {
  print_header();
  for (const double l : {0.7, 0.8, 0.9, 1.1, 1.25, 1.5}) {
    const SolvedScene run("svk_uniaxial", {translation(1, {l - 1, 0, 0})});
    const double P = uniaxial(l), w = side(l);
    compare("uniaxial force", l, run.vector("force_x")[0], P, std::abs(P));
    compare("uniaxial side", l, 1 + run.vector("corner")[1], w, w);
    compare("uniaxial side", l, 1 + run.vector("corner")[2], w, w);
    compare("uniaxial Cauchy stress", l, stress(run)[0][0], P / (w * w), std::abs(P) / (w * w));
    compare("lateral Cauchy stress", l, stress(run)[1][1], 0, std::abs(P) / (w * w));
  }
}

TEST(Constitutive, UniaxialImposed) {
  print_header();
  for (const double l : {0.3, 0.5, 1 / std::sqrt(3.0), 0.7, 2.0}) {
    const double P = uniaxial(l), w = side(l);
    const SolvedScene run = imposed({l, w, w});
    compare("uniaxial force", l, run.vector("force_x")[0], P, std::abs(P));
    compare("lateral force", l, run.vector("force_y")[1], 0, std::abs(P));
    compare("uniaxial Cauchy stress", l, stress(run)[0][0], P / (w * w), std::abs(P) / (w * w));
  }
}

TEST(Constitutive, LimitPoint) {
  print_header();
  const double l = 1 / std::sqrt(3.0), h = 1e-3;
  const auto force = [](double stretch) {
    return imposed({stretch, side(stretch), side(stretch)}).vector("force_x")[0];
  };
  const double below = force(l - h), at = force(l), above = force(l + h);
  compare("limit force / E", l, at / kYoung, -1 / (3 * std::sqrt(3.0)), 0.192450);
  EXPECT_GT(below, at);
  EXPECT_GT(above, at);
  compare("slope at the limit / E", l, (above - below) / (2 * h) / kYoung, h * h / 2, 1);
}

TEST(Constitutive, Confined) {
  print_header();
  for (const double l : {0.5, 1 / std::sqrt(3.0), 0.7, 0.8, 0.9, 1.1, 1.25, 1.5, 2.0}) {
    const SolvedScene run = imposed({l, 1, 1});
    const double P = (kLambda + 2 * kMu) * l * (l * l - 1) / 2, lateral = kLambda * (l * l - 1) / 2;
    compare("confined force", l, run.vector("force_x")[0], P, std::abs(P));
    compare("confined side force", l, run.vector("force_z")[2], lateral, std::abs(P));
    compare("confined Cauchy stress", l, stress(run)[0][0], P, std::abs(P));
  }
}

TEST(Constitutive, SimpleShear) {
  print_header();
  for (const double g : {0.1, 0.5, 1.0}) {
    const SolvedScene run("svk_simple_shear", {translation(1, {g, 0, 0})});
    const double M = kLambda + 2 * kMu;
    const Matrix exact{{{kLambda * g * g / 2 + kMu * g * g, kMu * g + M * g * g * g / 2, 0},
                        {kMu * g, M * g * g / 2, 0},
                        {0, 0, kLambda * g * g / 2}}};
    // P = J sigma F^-T with F = I + g e1 e2, J = 1.
    const Matrix s = stress(run);
    Matrix P = s;
    for (std::size_t i = 0; i < 3; ++i) P[i][0] = s[i][0] - g * s[i][1];
    const double scale = exact[0][1];
    compare("shear P11", g, P[0][0], exact[0][0], scale);
    compare("shear P12", g, P[0][1], exact[0][1], scale);
    compare("shear P21", g, P[1][0], exact[1][0], scale);
    compare("shear P22", g, P[1][1], exact[1][1], scale);
    compare("shear P33", g, P[2][2], exact[2][2], scale);
    compare("shear force on top", g, run.vector("force_y")[0], exact[0][1], scale);
    compare("normal force on top", g, run.vector("force_y")[1], exact[1][1], scale);
  }
}

TEST(Constitutive, Equibiaxial) {
  print_header();
  for (const double l : {0.8, 0.9, 1.1, 1.25}) {
    const SolvedScene run("svk_equibiaxial", {translation(1, {l - 1, 0, 0}), translation(3, {0, l - 1, 0})});
    const double P = kYoung * l * (l * l - 1) / (2 * (1 - kPoisson));
    const double thickness = std::sqrt(1 - 2 * kPoisson / (1 - kPoisson) * (l * l - 1));
    compare("equibiaxial force", l, run.vector("force_x")[0], P, std::abs(P));
    compare("equibiaxial force", l, run.vector("force_y")[1], P, std::abs(P));
    compare("equibiaxial thickness", l, 1 + run.vector("corner")[2], thickness, thickness);
  }
}

}  // namespace
}  // namespace fascia::test::constitutive_test
