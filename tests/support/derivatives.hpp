#pragma once

#include "core/executor/executor.hpp"
#include "core/linear/block_matrix.hpp"
#include "tests/support/fading.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace fascia::test {

/// Forces and tangents of a model at a random state, and what holds of each.
///
/// Case has a name and a dt (above 0: with viscous stress), Built a model.
template <class Case, class Built>
class DerivativeTest : public testing::TestWithParam<Case> {
 protected:
  /// @param displacement, rotation  largest of the state [m], [rad]
  DerivativeTest(Built built, double displacement, double rotation)
      : built_(std::move(built)),
        executor_(built_.model.points, pool_),
        state_(random_state(built_.model, displacement, rotation)),
        memory_(built_.model.points, 200) {
    history_.given = memory_.given();
    if (tested().dt <= 0) return;
    history_.inverse_step = 1 / tested().dt;
    executor_.store_strain(random_state(built_.model, 0.01, 0.5 * rotation, 7), history_.E);
  }
  std::size_t size() const { return static_cast<std::size_t>(built_.model.dof_count()); }
  double energy(const State& state) {
    std::vector<double> unused(size());
    return executor_.gradient(state, history_, unused).total();
  }
  std::vector<double> gradient(const State& state) {
    std::vector<double> g(size());
    executor_.gradient(state, history_, g);
    return g;
  }
  Linearization linearization(Tangent tangent) {
    gradient(state_);
    Linearization lin;
    executor_.linearize(state_, history_, tangent, lin);
    return lin;
  }
  std::vector<double> product(const Linearization& lin, const std::vector<double>& d) {
    std::vector<double> Kd(size());
    executor_.multiply(lin, d, Kd);
    return Kd;
  }

  void expect_gradient_of_the_energy() {
    const std::vector<double> d = random_direction(built_.model), g = gradient(state_);
    const double h = 1e-6;  // truncation h² and rounding eps/h balance near here
    const double numeric =
        (energy(moved(built_.model, state_, d, h)) - energy(moved(built_.model, state_, d, -h))) / (2 * h);
    const double error = std::abs(numeric - dot(g, d)) / (norm(g) * norm(d));
    std::printf("%-28s gradient against differences of the energy: %.1e\n", tested().name.c_str(), error);
    EXPECT_LT(error, 1e-8);
  }

  /// @param Kd  what the derivative of the gradient along d must be
  void expect_derivative_of_the_gradient(const std::vector<double>& d, const std::vector<double>& Kd) {
    const double h = 1e-6;
    const std::vector<double> plus = gradient(moved(built_.model, state_, d, h)),
                              minus = gradient(moved(built_.model, state_, d, -h));
    std::vector<double> difference(size());
    for (std::size_t i = 0; i < size(); ++i) difference[i] = (plus[i] - minus[i]) / (2 * h) - Kd[i];
    const double error = norm(difference) / norm(Kd);
    std::printf("%-28s product against differences of the gradient: %.1e\n", tested().name.c_str(), error);
    EXPECT_LT(error, 1e-8);
  }

  void expect_second_derivative_along_exponentials() {
    const std::vector<double> d = random_direction(built_.model);
    const std::vector<double> Kd = product(linearization(Tangent::full), d);
    const double h = 1e-4;
    const double numeric =
        (energy(moved(built_.model, state_, d, h)) - 2 * energy(state_) + energy(moved(built_.model, state_, d, -h))) /
        (h * h);
    const double error = std::abs(numeric - dot(d, Kd)) / std::abs(numeric);
    std::printf("%-28s dᵀKd against second differences: %.1e\n", tested().name.c_str(), error);
    EXPECT_LT(error, 1e-6);
  }

  /// The derivative of successive increments is K − ½ [torque]× on the rotation blocks (docs/notation.md).
  void expect_differences_to_be_tangent_minus_half_torque() {
    const std::vector<double> d = random_direction(built_.model), g = gradient(state_);
    std::vector<double> Kd = product(linearization(Tangent::full), d);
    for (int node = 0; node < built_.model.node_count(); ++node) {
      if (built_.model.kind(node) != FrameKind::rigid) continue;
      const auto i = static_cast<std::size_t>(built_.model.points.dofs.begin(node));
      const Vec3d torque{{g[i + 3], g[i + 4], g[i + 5]}}, dr{{d[i + 3], d[i + 4], d[i + 5]}};
      const Vec3d correction = cross(torque, dr) * 0.5;
      for (std::size_t k = 0; k < 3; ++k) Kd[i + 3 + k] -= correction[static_cast<int>(k)];
    }
    expect_derivative_of_the_gradient(d, Kd);
  }

  void expect_assembled_equals_product() {
    for (const Tangent tangent : {Tangent::full, Tangent::material})
      expect_assembled_equals_product(linearization(tangent));
  }
  void expect_assembled_equals_product(const Linearization& lin) {
    BlockMatrix matrix(built_.model.points);
    std::fill_n(matrix.values(), matrix.value_count(), std::numeric_limits<double>::quiet_NaN());  // all is cleared
    executor_.assemble(lin, matrix);
    const std::vector<double> d = random_direction(built_.model), free = product(lin, d);
    std::vector<double> assembled(size());
    matrix.multiply(pool_, d, assembled);
    for (std::size_t i = 0; i < size(); ++i) assembled[i] -= free[i];
    EXPECT_LT(norm(assembled), 1e-12 * norm(free)) << tested().name;
  }

  /// Where a step led, products with stresses extrapolated along it miss those with the stresses there by its square.
  void expect_extrapolation_of_second_order() {
    const std::vector<double> d = random_direction(built_.model), probe = random_direction(built_.model, 5);
    const auto error = [&](double length) {
      const State end = moved(built_.model, state_, d, length);
      gradient(end);
      Linearization there, extrapolated;
      executor_.linearize(end, history_, Tangent::full, there);
      TakenStep taken{state_.u, state_.D, d};
      for (double& v : taken.d) v *= length;
      executor_.linearize(end, history_, Tangent::full, extrapolated, true, &taken);
      expect_assembled_equals_product(extrapolated);
      const std::vector<double> exact = product(there, probe);
      std::vector<double> difference = product(extrapolated, probe);
      for (std::size_t i = 0; i < size(); ++i) difference[i] -= exact[i];
      return norm(difference) / norm(exact);
    };
    const double whole = error(0.02), half = error(0.01);
    std::printf("%-28s extrapolated tangent, a step and its half: %.1e %.1e\n", tested().name.c_str(), whole, half);
    EXPECT_LT(whole, 0.05);
    if (whole > 1e-12) {  // 0: a law without stress in its tangent
      EXPECT_NEAR(whole / half, 4, 0.4);
    }
  }

  void expect_symmetric_and_not_negative() {
    const Linearization lin = linearization(Tangent::material);
    for (unsigned seed = 1; seed <= 20; ++seed) {
      const std::vector<double> a = random_direction(built_.model, seed),
                                b = random_direction(built_.model, seed + 100);
      const std::vector<double> Ka = product(lin, a), Kb = product(lin, b);
      EXPECT_GE(dot(a, Ka), 0);
      EXPECT_NEAR(dot(a, Kb), dot(b, Ka), 1e-12 * norm(Ka) * norm(b));
    }
  }

  static const Case& tested() { return testing::TestWithParam<Case>::GetParam(); }

  Built built_;
  ThreadPool pool_{1};
  CpuExecutor executor_;
  State state_;
  MidwayMemory memory_;  ///< of materials whose stress fades
  StrainHistory history_;
};

}  // namespace fascia::test
