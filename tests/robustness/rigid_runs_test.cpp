// Rigid bodies as scenes lead, load and probe them.
#include "tests/robustness/probed_runs.hpp"

namespace fascia::rigid_runs_test {
namespace {

using namespace fascia::test;

class RigidRuns : public ProbedRuns {};

constexpr const char* kRigid = R"([bodies.r]
model = "rigid"
domain = { box = { min = [-0.1, -0.1, -0.1], max = [0.1, 0.1, 0.1] } }
mass = 2
[solver]
kind = "KIND"
time_step = 0.01
duration = 0.5
[output]
every_steps = 1
)";

/// A rigid body is led about one axis, and free about the others: a box about an axis of its inertia turns as told,
/// with I w of momentum from the first step on, and no moment once it turns.
TEST_F(RigidRuns, ARigidBodyIsLedAboutOneAxis) {
  const std::string rest =
      "[[constraints]]\nbody = \"r\"\nwhere = \"all\"\nmove = { rotate = { axis = [0, 0, 1], angle = 1 }, axes = "
      "[\"rz\"] }\nover = 1\n[probes]\nM = { body = \"r\", where = \"all\", quantity = \"moment\" }\nL = { body = "
      "\"r\", quantity = \"angular_momentum\" }\nE = { body = \"r\", quantity = \"kinetic_energy\" }\n";
  const double inertia = 2 * 0.2 * 0.2 / 6;
  for (const char* kind : {"implicit-euler", "bdf2", "newmark", "midpoint"}) {
    run(with(kRigid, "KIND", kind) + rest);
    const std::vector<double> L = column("L.z"), E = column("E"), M = column("M.z");
    for (std::size_t i = 4; i < L.size(); ++i) {
      EXPECT_NEAR(L[i], inertia, 1e-4 * inertia) << kind << i;
      EXPECT_NEAR(E[i], inertia / 2, 1e-4 * inertia) << kind << i;
      EXPECT_NEAR(M[i], 0, 0.02 * inertia) << kind << i;
    }
  }
}

/// About an axis that is none of its inertia's a box that is led turns its free axes with it: no moment acts about
/// these, and their momentum stays none.
TEST_F(RigidRuns, WhatIsFreeKeepsItsMomentumBesideALedAxis) {
  const std::string rest =
      "[[constraints]]\nbody = \"r\"\nwhere = \"all\"\nmove = { rotate = { axis = [0, 0, 1], angle = 5 }, axes = "
      "[\"rz\"] }\nover = 0.5\nprofile = \"smooth\"\n[probes]\nL = { body = \"r\", quantity = \"angular_momentum\" }\n";
  for (const char* kind : {"bdf2", "newmark", "midpoint"}) {
    run(with(kRigid, "KIND", kind) + rest,
        {"bodies.r.inertia=[[0.02,0,0.006],[0,0.03,0],[0.006,0,0.025]]", "silence=['load']"});
    double across = 0, along = 0;
    for (const double L : column("L.x")) across = std::max(across, std::abs(L));
    for (const double L : column("L.y")) across = std::max(across, std::abs(L));
    for (const double L : column("L.z")) along = std::max(along, L);
    EXPECT_GT(along, 0.2) << kind;
    EXPECT_LT(across, 0.02 * along) << kind;
  }
}

/// Vertices of a rigid body's surface are what a region of it holds: probes and loads take them; a constraint takes its
/// mass centre, and says so.
TEST_F(RigidRuns, RegionsOfARigidBodyHoldVertices) {
  const std::string turned =
      "[[constraints]]\nbody = \"r\"\nwhere = \"all\"\nmove = { rotate = { axis = [0, 0, 1], angle = \"90 deg\" } "
      "}\nover "
      "= 0.5\n[probes]\nmean = { body = \"r\", where = { nearest = [0.1, 0.1, 0.1] }, quantity = \"mean_displacement\" "
      "}\n"
      "most = { body = \"r\", where = { nearest = [0.1, 0.1, 0.1] }, quantity = \"max_displacement\" }\n";
  run(with(kRigid, "KIND", "implicit-euler") + turned);
  EXPECT_NEAR(value("mean")[0].get<double>(), -0.2, 1e-12);
  EXPECT_NEAR(value("mean")[1].get<double>(), 0, 1e-12);
  EXPECT_NEAR(value("most").get<double>(), 0.2, 1e-12);

  const std::string pushed =
      "[[constraints]]\nbody = \"r\"\nwhere = \"all\"\nfix = \"all\"\n[[loads]]\nbody = \"r\"\nwhere = { box = { min = "
      "[0.099, -1, -1], max = [0.101, 1, 1] } }\nforce_per_node = [0, 0, 1]\n[probes]\nM = { body = \"r\", where = "
      "\"all\", quantity = \"moment\" }\nF = { body = \"r\", where = \"all\", quantity = \"force\" }\n";
  run(with(kRigid, "KIND", "implicit-euler") + pushed);
  EXPECT_NEAR(value("F")[2].get<double>(), -4, 1e-9);   // four vertices
  EXPECT_NEAR(value("M")[1].get<double>(), 0.4, 1e-9);  // 0.1 m beside the centre

  const std::string matter =
      "[probes.V]\nbody = \"r\"\nwhere = WHERE\nquantity = \"volume\"\n";  // all of it is at the one frame
  run(with(kRigid, "KIND", "implicit-euler") + with(matter, "WHERE", "{ nearest = [0.1, 0.1, 0.1] }"));
  EXPECT_TRUE(warns("rigid"));
  run(with(kRigid, "KIND", "implicit-euler") + with(matter, "WHERE", "\"all\""));
  EXPECT_FALSE(warns("rigid"));

  const std::string pinned = "[[constraints]]\nbody = \"r\"\nwhere = WHERE\nfix = \"position\"\n";
  run(with(kRigid, "KIND", "implicit-euler") + with(pinned, "WHERE", "{ nearest = [0.1, 0.1, 0.1] }"));
  EXPECT_TRUE(warns("rigid"));
  run(with(kRigid, "KIND", "implicit-euler") + with(pinned, "WHERE", "\"all\""));
  EXPECT_FALSE(warns("rigid"));
}

}  // namespace
}  // namespace fascia::rigid_runs_test
