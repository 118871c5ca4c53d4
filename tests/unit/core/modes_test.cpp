#include "core/solver/modes.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <cstdio>

namespace fascia::modes_test {
namespace {

using namespace fascia::test;

/// A soft half carries one that is 1e11 times as stiff: rounding there moves the soft modes by 1e-5 at each iteration,
/// which is no reason to find none, but one to say so. With 1e2 times as stiff a half they are nearly the same.
TEST(Modes, OfASoftPartBesideAStiffOneAreFoundAndDoubted) {
  const auto modes_of = [](double stiff) {
    BlockOptions o;
    o.grid = {7, 4, 4};
    GridSpec spec = block_spec(o);
    spec.material = [stiff](const Vec3d& X) {
      const Lame lame = Lame::from_young(X[0] < 0.5 ? 1.0 : stiff, 0.3);
      return PointMaterialSpec{lame.lambda, lame.mu, 0, 0};
    };
    BuiltModel built = build({spec});
    hold_face(built.model);
    ThreadPool pool(1);
    return natural_modes(built.model, pool, 3);
  };
  const Modes soft = modes_of(1e2), stiff = modes_of(1e11);
  std::printf("%.6f and %.6f Hz, uncertain by %.1e and %.1e, %d and %d iterations\n", soft.frequency[0],
              stiff.frequency[0], soft.uncertainty, stiff.uncertainty, soft.iterations, stiff.iterations);
  EXPECT_TRUE(soft.converged);
  EXPECT_EQ(soft.uncertainty, 0);
  EXPECT_TRUE(stiff.converged);
  EXPECT_GT(stiff.uncertainty, 1e-9);
  EXPECT_LT(stiff.uncertainty, 1e-3);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(stiff.frequency[k], soft.frequency[k], 0.1 * soft.frequency[k]);
}

}  // namespace
}  // namespace fascia::modes_test
