#include "core/run/modes.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <cstdio>

namespace fascia::modes_test {
namespace {

using namespace fascia::test;

/// A soft half carries one that is ever stiffer, whose rounding moves the soft modes at each iteration: that is no
/// reason to find none, but in the end one to tell them no longer from free motions, and to say so.
TEST(Modes, OfASoftPartBesideAStiffOneAreFoundOrDoubted) {
  const auto modes_of = [](double stiff) {
    BlockOptions o;
    o.grid = {7, 4, 4};
    GridSpec spec = block_spec(o);
    spec.material = [stiff](const Vec3d& X) {
      const Lame lame = Lame::from_young(X[0] < 0.5 ? 1.0 : stiff, 0.3);
      return PointMaterialSpec{{lame}, 0, 0};
    };
    BuiltModel built = build({spec});
    hold_face(built.model);
    ThreadPool pool(1);
    return natural_modes(built.model, pool, 3);
  };
  const Modes soft = modes_of(1e2);
  for (const double stiff : {1e8, 1e10, 1e12, 1e14}) {
    const Modes modes = modes_of(stiff);
    std::printf("%.0e: %.6f and %.6f Hz, uncertain by %.1e, nothing told from 0 below %.1e Hz, %d iterations\n", stiff,
                soft.frequency[0], modes.frequency[0], modes.uncertainty, modes.least, modes.iterations);
    EXPECT_TRUE(modes.converged);
    EXPECT_LT(modes.uncertainty, 0.03);
    for (std::size_t k = 0; k < 3; ++k) {
      if (modes.frequency[k] > 0)
        EXPECT_NEAR(modes.frequency[k], soft.frequency[k], 0.1 * soft.frequency[k]);
      else
        EXPECT_GT(modes.least, soft.frequency[k]);
    }
  }
  EXPECT_LT(soft.uncertainty, 1e-9);
  EXPECT_GT(modes_of(1e12).uncertainty, 1e-6);
}

}  // namespace
}  // namespace fascia::modes_test
