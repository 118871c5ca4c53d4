#include "core/math/lane_rows.hpp"
#include "core/base/index.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace fascia::lane_rows_test {
namespace {

/// Where each lane has its row: two lanes share one, and rows have odd places.
constexpr std::array kPlaces{3, 0, 5, 3, 1, 6, 2, 4};

template <int N, int W>
void expect_rows() {
  const auto place = [](int lane) { return kPlaces[at(lane)] * (N + 1) + 1; };
  std::vector<double> memory(8 * (N + 1) + 1);
  for (std::size_t i = 0; i < memory.size(); ++i) memory[i] = 1.0 + static_cast<double>(i);
  const std::vector<double> before = memory;

  Batch<W> gathered[N];
  gather_rows<N>([&](int lane) { return memory.data() + place(lane); }, gathered);
  LaneArray<N, W> sums;
  for (int k = 0; k < N; ++k)
    for (int lane = 0; lane < W; ++lane) {
      EXPECT_EQ(gathered[k].v[lane], before[at(place(lane) + k)]) << k << " of lane " << lane;
      sums.numbers[W * k + lane] = 1000.0 * (lane + 1) + k;
    }

  std::vector<double> expected = before;
  for (int lane = 0; lane < W; ++lane)
    for (int k = 0; k < N; ++k) expected[at(place(lane) + k)] += 1000.0 * (lane + 1) + k;
  add_to_rows<N>(sums, [&](int lane) { return memory.data() + place(lane); });
  EXPECT_EQ(memory, expected);

  std::vector<double> stored(W * N + 2, -1);
  store_rows<N>(sums, [&](int lane) { return stored.data() + 1 + lane * N; });
  EXPECT_EQ(stored.front(), -1);
  EXPECT_EQ(stored.back(), -1);
  for (int lane = 0; lane < W; ++lane)
    for (int k = 0; k < N; ++k)
      EXPECT_EQ(stored[at(1 + lane * N + k)], 1000.0 * (lane + 1) + k) << k << " of lane " << lane;
}

template <int W>
void expect_rows_of_all_lengths() {
  expect_rows<9, W>();
  expect_rows<12, W>();
  expect_rows<18, W>();
  expect_rows<36, W>();
  expect_rows<144, W>();
}

/// Registers of every width that a build may have, whatever this one has.
TEST(LaneRows, HaveEachNumberOnceInRegistersOfEveryWidth) {
  expect_rows_of_all_lengths<2>();
  expect_rows_of_all_lengths<4>();
  expect_rows_of_all_lengths<8>();
}

}  // namespace
}  // namespace fascia::lane_rows_test
