// The scenes of couplings, solved by the library: forces balance, and the numbers that their headers name.
#include "tests/support/cases.hpp"
#include "tests/support/solved_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace fascia::test::coupling_scenes_test {
namespace {

constexpr double kGravity = 9.81;
const std::string kNoPicture = "output.picture.size=[16,16]";

double weight(const SolvedScene& run) {
  double mass = 0;
  for (const nlohmann::json& body : run.summary().value("bodies", nlohmann::json::object()))
    mass += body.value("mass", 0.0);
  return kGravity * mass;
}

/// Force of a coupling [N].
std::array<double, 3> force(const SolvedScene& run, const std::string& coupling) {
  return SolvedScene::as_vector(run.summary()["couplings"][coupling]["force"]);
}

/// Force of a tissue on one of its bodies [N].
std::array<double, 3> force(const SolvedScene& run, const std::string& tissue, const std::string& body) {
  return SolvedScene::as_vector(run.summary()["couplings"][tissue]["on"][body]["force"]);
}

void expect_sound(const SolvedScene& run) {
  ASSERT_TRUE(run.ok());
  EXPECT_EQ(run.summary()["status"], "converged");
  EXPECT_EQ(run.summary()["warnings"].dump(), "[]");
}

void expect_near(const std::array<double, 3>& a, const std::array<double, 3>& b, double tolerance) {
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(a.at(k), b.at(k), tolerance) << k;
}

std::array<double, 3> sum(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

TEST(CouplingScenes, TissueCarriesAForceFromWallToWall) {
  const SolvedScene run("coupled_surfaces", {kNoPicture});
  expect_sound(run);
  expect_near(run.vector("rim"), {-4, 1, 0}, 4e-6);
  expect_near(force(run, "tissue", "upper"), {4, -1, 0}, 4e-6);
  expect_near(force(run, "tissue", "lower"), {-4, 1, 0}, 4e-6);
  EXPECT_NEAR(run.vector("pulled_edge")[0], 9.9e-3, 0.01 * 9.9e-3);
  EXPECT_LT(run.summary()["couplings"]["tissue"]["gap"].get<double>(), 0.5e-3);
}

TEST(CouplingScenes, AFillingBladderLiftsTheUterus) {
  // In longer steps it moves alike to three digits.
  const SolvedScene run("uterus_bladder", {kNoPicture, full_size() ? "title='full'" : "solver.time_step=0.04"});
  expect_sound(run);
  double lowest = 0, cervix = 0;
  for (const auto& row : run.history()) {
    lowest = std::min(lowest, row.at(2));
    cervix = std::max(cervix, std::hypot(row.at(4), row.at(5), row.at(6)));
  }
  std::printf("uterus: fundus from %.2f to %.2f mm, cervix %.2f mm, %.0f Pa, a step in %.1f ms\n", 1e3 * lowest,
              1e3 * run.vector("fundus")[1], 1e3 * cervix, run.number("pressure"),
              1e3 * run.summary()["seconds"]["step_median"].get<double>());
  EXPECT_NEAR(lowest, -15.9e-3, 0.01 * 15.9e-3);
  EXPECT_NEAR(run.vector("fundus")[1], 7.3e-3, 0.01 * 7.3e-3);
  EXPECT_LT(cervix, 1e-3);
  EXPECT_NEAR(run.number("pressure"), 2020, 0.01 * 2020);
  EXPECT_NEAR(run.number("volume"), 250e-6, 0.01 * 250e-6);
}

TEST(CouplingScenes, ALiverHangsFromTheDiaphragm) {
  const SolvedScene run("hanging_liver", {kNoPicture});
  expect_sound(run);
  const double W = weight(run);
  EXPECT_NEAR(W, 18.300, 0.01 * 18.3);
  EXPECT_NEAR(run.vector("rim")[1], W, 1e-6 * W);
  expect_near(sum(run.vector("rim"), force(run, "vena_cava")), {0, W, 0}, 1e-6 * W);
  // What ties the liver carries its weight, that of the tissues on its nodes apart.
  const double own = 9.81 * run.summary()["bodies"]["liver"]["mass"].get<double>();
  std::array<double, 3> ties = force(run, "vena_cava");
  for (const char* tissue : {"falciform", "coronary", "omentum"}) ties = sum(ties, force(run, tissue, "liver"));
  expect_near(ties, {0, own, 0}, 1e-6 * W);
  EXPECT_NEAR(run.vector("liver")[1], -19.1e-3, 0.01 * 19.1e-3);
  EXPECT_NEAR(run.vector("liver")[2], 7.41e-3, 0.01 * 7.41e-3);
}

TEST(CouplingScenes, ALiverBreathes) {
  const SolvedScene run("breathing_liver",
                        {kNoPicture, "solver.duration=3.2", full_size() ? "title='full'" : "solver.time_step=0.04"});
  expect_sound(run);
  double highest = -1;
  for (const auto& row : run.history())
    if (row[0] > 1.5) highest = std::max(highest, row.at(2));
  std::printf("liver: breathed out at %.2f mm, a step in %.1f ms\n", 1e3 * highest,
              1e3 * run.summary()["seconds"]["step_median"].get<double>());
  EXPECT_NEAR(highest, -10.9e-3, 0.01 * 10.9e-3);
}

TEST(CouplingScenes, FiveTissuesBetweenSixOrgans) {
  const SolvedScene run("five_tissues", {kNoPicture});
  expect_sound(run);
  const double W = weight(run);
  EXPECT_EQ(run.summary()["couplings"].size(), 5u);
  expect_near(sum(run.vector("rim"), run.vector("spine")), {0, W, 0}, 1e-6 * W);
  EXPECT_NEAR(run.vector("rim")[1], 4.468, 0.01 * 4.468);
  EXPECT_NEAR(run.vector("spine")[1], 3.845, 0.01 * 3.845);
  EXPECT_NEAR(run.vector("liver")[1], -23.4e-3, 0.01 * 23.4e-3);
}

TEST(CouplingScenes, AHandCarriesPlateCushionAndBone) {
  const SolvedScene run("bone_plate", {kNoPicture});
  expect_sound(run);
  const double W = weight(run);
  EXPECT_NEAR(W, 3.475, 0.01 * 3.475);
  expect_near(run.vector("hand"), {0, W, 0}, 1e-6 * W);
  EXPECT_NEAR(run.vector("bone")[1], 44.4e-3, 0.01 * 44.4e-3);
  EXPECT_NEAR(run.vector("bone")[0], -9.5e-3, 0.01 * 9.5e-3);
}

TEST(CouplingScenes, WhatPressesASurfacePressesItsHost) {
  const SolvedScene run("riding_surface", {kNoPicture});
  expect_sound(run);
  const double F = run.vector("table")[1];
  expect_near(force(run, "skin_on_organ"), run.vector("table"), 1e-6 * F);
  EXPECT_NEAR(F, 0.680, 0.01 * 0.68);
  EXPECT_NEAR(run.vector("under_the_finger")[1], -2.30e-3, 0.01 * 2.30e-3);
  EXPECT_EQ(run.summary()["bodies"]["skin"]["mass"], 0.0);
}

TEST(CouplingScenes, SoftSpringsLetGoAndStiffOnesHold) {
  for (const double stiffness : {20.0, 40.0}) {
    const SolvedScene run("ligament_springs",
                          {kNoPicture, "couplings.soft_along_x.stiffness=" + std::to_string(stiffness)});
    expect_sound(run);
    expect_near(force(run, "soft_along_x"), {-1, 0, 0}, 1e-6);
    expect_near(force(run, "stiff_along_x"), {-1, 0, 0}, 1e-6);
    expect_near(run.vector("soft_mean"), {1 / stiffness, 0, 0}, 1e-6 / stiffness);
    const auto soft = run.vectors("soft_ligament_end"), stiff = run.vectors("stiff_ligament_end");
    EXPECT_LT(stiff.at(0)[0], 0.02e-3);
    EXPECT_NEAR(soft.at(1)[0] - soft.at(0)[0], 0.64e-3, 0.01 * 0.64e-3);
    EXPECT_NEAR(stiff.at(1)[0] - stiff.at(0)[0], 0.69e-3, 0.01 * 0.69e-3);
  }
}

}  // namespace
}  // namespace fascia::test::coupling_scenes_test
