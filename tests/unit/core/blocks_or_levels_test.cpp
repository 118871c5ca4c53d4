#include "core/levels/blocks_or_levels.hpp"

#include <gtest/gtest.h>

namespace fascia::test::blocks_or_levels_test {
namespace {

TEST(BlocksOrLevelsTest, GivesBlocksHalfOfWhatLevelsTake) {
  EXPECT_EQ(BlocksOrLevels({.cycle = 5, .making = 40}).patience(), 60);
  EXPECT_EQ(BlocksOrLevels({.cycle = 2, .making = 1000}).patience(), 516);
}

TEST(BlocksOrLevelsTest, StaysWithLevelsThatAreWorthIt) {
  BlocksOrLevels choice({.cycle = 5, .making = 40});
  EXPECT_FALSE(choice.levels());
  choice.turn_to_levels();
  for (int solve = 0; solve < 100; ++solve) choice.took(30, 1);
  EXPECT_TRUE(choice.levels());
}

/// One solve that is hard is no reason; several are. Blocks are then given as long as the levels took, and the next
/// time that levels have their turn they must be worse still.
TEST(BlocksOrLevelsTest, HandsBackWhatIsFarTooSlow) {
  BlocksOrLevels choice({.cycle = 5, .making = 40});
  choice.turn_to_levels();
  choice.took(400, 1);
  choice.took(20, 0);
  choice.took(20, 0);
  EXPECT_TRUE(choice.levels());
  for (int solve = 0; solve < 20; ++solve) choice.took(200, 2);
  EXPECT_FALSE(choice.levels());
  EXPECT_GT(choice.patience(), 500);
  choice.turn_to_levels();
  for (int solve = 0; solve < 20; ++solve) choice.took(200, 2);
  EXPECT_TRUE(choice.levels());
}

/// Beyond what was expected of them, and not in one solve alone: a factor may be cheaper then.
TEST(BlocksOrLevelsTest, SaysWhereLevelsDisappoint) {
  BlocksOrLevels choice({.cycle = 5, .making = 40});
  EXPECT_EQ(choice.expected(), 120);
  choice.turn_to_levels();
  choice.took(100, 1);
  EXPECT_EQ(choice.recent(), 540);
  EXPECT_FALSE(choice.disappoint());
  for (int solve = 0; solve < 10; ++solve) choice.took(10, 0);
  EXPECT_FALSE(choice.disappoint());
  for (int solve = 0; solve < 10; ++solve) choice.took(40, 1);
  EXPECT_TRUE(choice.disappoint());
}

/// Blocks that have gained nothing give way early; once levels have handed back to them they are left to it.
TEST(BlocksOrLevelsTest, LooksEarlyUntilLevelsHandBack) {
  BlocksOrLevels choice({.cycle = 5, .making = 40});
  const CgOptions first = choice.limited({1000, 1e-6});
  EXPECT_EQ(first.max_iterations, 60);
  EXPECT_GT(first.look, 0);
  EXPECT_LT(first.look, 60);
  EXPECT_EQ(choice.limited({30, 1e-6}).max_iterations, 30);
  choice.turn_to_levels();
  for (int solve = 0; solve < 20; ++solve) choice.took(200, 2);
  EXPECT_EQ(choice.limited({1000, 1e-6}).look, 0);
}

}  // namespace
}  // namespace fascia::test::blocks_or_levels_test
