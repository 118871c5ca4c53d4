// What is no gap: sides without faces, bodies that overlap or touch, sides that look away, strips without a length.
#include "core/base/errors.hpp"
#include "tests/unit/coupling/gap_samples.hpp"

#include <gtest/gtest.h>

namespace fascia::gap_errors_test {
namespace {

using namespace test;

template <class Act>
void expect_error(const Act& act, const std::vector<std::string>& parts) {
  try {
    act();
  } catch (const InputError& e) {
    for (const std::string& part : parts)
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what() << "\nlacks " << part;
    return;
  }
  FAIL() << "no error, but " << parts[0];
}

/// All three ways to fill a gap.
void expect_all(const GapSide& a, const GapSide& b, const std::vector<std::string>& parts) {
  expect_error([&] { gap_volume(a, b); }, parts);
  expect_error([&] { gap_sheet(a, b, 0.1); }, parts);
  expect_error([&] { gap_strands(a, b, 0.1); }, parts);
}

GapSide box(const std::string& body, double low, double high, double face) {
  return closed_side(body, box_surface({{0, 0, low}}, {{2, 1, high}}, 6, 3, 3),
                     [=](const Vec3d& X) { return X[2] > face - 1e-9 && X[2] < face + 1e-9; });
}

const GapSide kPlate = plate("plate", {{0, 0, 0}}, 2, 1, {6, 3});

TEST(GapErrors, NoFaces) {
  GapSide none = kPlate;
  none.body = "bone";
  none.faces.triangles.clear();
  expect_all(none, kPlate, {"no face of the surface of body \"bone\"", "all its vertices are selected"});
  expect_all(kPlate, none, {"body \"bone\""});
}

TEST(GapErrors, Overlap) {
  const GapSide low = box("low", 0, 1, 1), high = box("high", 0.7, 2, 0.7);
  expect_all(low, high, {"\"low\" and \"high\" overlap", "move them apart"});
  GapSide inside = plate("inside", {{0.5, 0.2, 0.5}}, 1, 0.5, {3, 3});
  expect_all(inside, low, {"overlap", "of \"inside\" at", "0.4667 m inside \"low\""});
}

/// Bodies that lie on each other do not overlap.
TEST(GapErrors, TouchingEverywhere) {
  expect_all(box("low", 0, 1, 1), box("high", 1, 2, 1), {"touch everywhere", "\"low\" and \"high\""});
}

TEST(GapErrors, NotFacing) {
  // The far faces, and one near with one far.
  expect_all(box("low", 0, 1, 0), box("high", 1.5, 2, 2), {"do not face each other", "\"low\" and \"high\"", "where"});
  expect_all(box("low", 0, 1, 0), box("high", 1.5, 2, 1.5), {"do not face each other"});
  expect_all(box("low", 0, 1, 1), box("high", 1.5, 2, 2), {"do not face each other"});
  // Plates in one plane, side by side.
  expect_all(kPlate, plate("beside", {{3, 0, 0}}, 2, 1, {4, 4}), {"do not face each other"});
  // A whole box over a plate: the lines from its back run through it.
  const GapSide all =
      closed_side("box", box_surface({{0, 0, 0.2}}, {{2, 1, 1}}, 6, 3, 3), [](const Vec3d&) { return true; });
  expect_error([&] { gap_volume(all, kPlate); }, {"do not face each other"});
  EXPECT_NO_THROW(gap_volume(box("box", 0.2, 1, 0.2), kPlate));
}

TEST(GapErrors, SheetWithoutALength) {
  const GapSide square = plate("square", {{0, 0, 0.5}}, 1, 1, {3, 3});
  expect_error([&] { gap_sheet(kPlate, square, 0.1); }, {"body \"square\" is only 1 times as long as it is wide"});
  expect_error([&] { gap_sheet(square, kPlate, 0.1); }, {"a sheet needs a strip"});
  const GapSide strip = plate("strip", {{0, 0, 0.5}}, 2, 0.5, {3, 3});
  expect_error([&] { gap_sheet(kPlate, strip, 1e-9); }, {"larger spacing"});
}

}  // namespace
}  // namespace fascia::gap_errors_test
