// These runs meet what the scene format says of regions, refusals and results, as scripts do.
#include "tests/robustness/probed_runs.hpp"

#include <cmath>

namespace fascia::format_runs_test {
namespace {

using namespace fascia::test;

class FormatRuns : public ProbedRuns {};

constexpr const char* kBar = R"([bodies.bar]
MODEL
density = 1000
material = { young = 1e6, poisson = 0 }
[[constraints]]
body = "bar"
where = { box = { min = [-1, -9, -9], max = [0.001, 9, 9] } }
fix = "all"
[[loads]]
body = "bar"
where = { box = { min = [0.999, -9, -9], max = [2, 9, 9] } }
total_force = [100, 0, 0]
[solver]
kind = "static"
)";
constexpr const char* kHexahedra =
    "model = \"hexahedra\"\ndomain = { box = { min = [0, 0, 0], max = [1, 0.1, 0.1], cells = [8, 2, 2] } }";
constexpr const char* kQuadratic =
    "model = \"tetrahedra\"\norder = 2\n"
    "domain = { box = { min = [0, 0, 0], max = [1, 0.1, 0.1], cells = [8, 2, 2] } }";
constexpr const char* kFrames =
    "model = \"meshless\"\ndomain = { box = { min = [0, 0, 0], max = [1, 0.1, 0.1] } }\nframes = { grid = [9, 2, 2] }";
constexpr const char* kShell =
    "model = \"shell\"\nthickness = 0.01\n"
    "domain = { rectangle = { origin = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 1, 0], cells = [8, 8] } }";

/// Nodes hold what they move of the points around them: regions without common nodes add up to the whole, and the nodes
/// of a face of a bar hold half of a layer of cells.
TEST_F(FormatRuns, EnergyAndVolumeOfARegion) {
  std::string probes;
  for (const char* quantity : {"volume", "energy", "total_energy", "mass"})
    for (const auto& [part, where] :
         {std::pair{"all", ""},
          std::pair{"end", "where = { halfspace = { point = [0.99, 0, 0], normal = [-1, 0, 0] } }"},
          std::pair{"rest", "where = { halfspace = { point = [0.99, 0, 0], normal = [1, 0, 0] } }"}})
      probes += std::string("[probes.") + quantity + "_" + part + "]\nbody = \"bar\"\nquantity = \"" + quantity +
                "\"\n" + where + "\n";
  for (const char* model : {kHexahedra, kQuadratic, kFrames, kShell}) {
    run(with(kBar, "MODEL", model) + probes);
    for (const std::string quantity : {"volume", "energy", "total_energy"}) {
      const double all = value(quantity + "_all"), end = value(quantity + "_end"), rest = value(quantity + "_rest");
      EXPECT_NEAR(end + rest, all, 1e-9 * std::abs(all)) << model << quantity;
      EXPECT_NE(end, all) << model << quantity;
      EXPECT_TRUE(end > 0 || quantity == "total_energy") << model << quantity << end;
    }
    const double share = value("volume_end").get<double>() / value("volume_all").get<double>();
    EXPECT_NEAR(share, model == kQuadratic ? 1.0 / 32 : 1.0 / 16, 0.002) << model;  // pulled by a few percent
  }
}

/// A face whose positions are held without rotations is softer than one that is clamped; an edge is a hinge.
TEST_F(FormatRuns, PositionsWithoutRotationsAreWarnedOf) {
  const std::string held = with(with(kBar, "MODEL", kFrames), "fix = \"all\"", "fix = \"position\"");
  run(held);
  EXPECT_TRUE(warns("rotations"));
  run(with(kBar, "MODEL", kHexahedra));
  EXPECT_FALSE(warns("rotations"));
  const std::string hinged =
      with(with(held, "max = [0.001, 9, 9]", "max = [0.001, 0.001, 9]"), "[[loads]]",
           "[[constraints]]\nbody = \"bar\"\nwhere = { halfspace = { point = [0.999, 0, 0], normal = "
           "[-1, 0, 0] } }\nfix = \"all\"\n[[loads]]");
  run(hinged);
  EXPECT_FALSE(warns("rotations"));
}

/// The errors of regions and points of a scene are told in one go.
TEST_F(FormatRuns, ErrorsOfTheGeometryAreToldTogether) {
  const std::string text =
      with(with(with(kBar, "MODEL", kHexahedra), "[-1, -9, -9]", "[-2, -9, -9]"), "[0.001, 9, 9]", "[-1.5, 9, 9]");
  write("scene.toml", with(text, "[0.999, -9, -9]", "[1.5, -9, -9]") +
                          "[probes.tip]\nbody = \"bar\"\nat = [3, 0, 0]\nquantity = \"displacement\"\n");
  const ProgramResult result = fascia({"check", "scene.toml"});
  EXPECT_EQ(result.status, 2);
  const std::vector<std::string> lines = lines_of(result.err);
  ASSERT_EQ(lines.size(), 3u) << result.err;
  EXPECT_NE(lines[0].find("constraints[0].where: the region selects no node"), std::string::npos) << lines[0];
  EXPECT_NE(lines[1].find("loads[0].where: the region holds no material"), std::string::npos) << lines[1];
  EXPECT_NE(lines[2].find("probes.tip.at: (3, 0, 0) lies 2 m outside"), std::string::npos) << lines[2];
}

/// Names of the format that this version does not have are refused as such, not as mistakes.
TEST_F(FormatRuns, WhatIsNotSupportedYetIsSaid) {
  write("scene.toml", with(kBar, "MODEL", kHexahedra));
  for (const char* setting :
       {"phases=[]", "contacts={gap=1}", "tools={}", "initial={from='out'}", "solver.accuracy='1 %'",
        "output.checkpoint='60 s'", "constraints[0].until=1", "loads[0].from=1", "bodies.bar.inertia_kind='lumped'",
        "bodies.bar.material.law='ogden'", "bodies.bar.material.law='yeoh'", "bodies.bar.material.incompressible=true",
        "probes.c={quantity='contact_force',body='bar'}",
        "couplings.s={kind='spring',body='bar',where='all',point=[0,0,0],stiffness=1,slack=0.1}",
        "couplings.s={kind='spring',body='bar',where='all',point=[0,0,0],stiffness=1,to='bar'}",
        "bodies.bar.material.fibres=[{cell_data='f'}]"}) {
    const ProgramResult result = fascia({"check", "scene.toml", "--set", setting});
    EXPECT_EQ(result.status, 2) << setting;
    EXPECT_NE(result.err.find("not supported yet"), std::string::npos) << setting << ": " << result.err;
  }
  for (const char* command : {"resume", "fit"}) {
    const ProgramResult result = fascia({command, "out"});
    EXPECT_EQ(result.status, 2);
    EXPECT_NE(result.err.find("is not supported yet"), std::string::npos) << result.err;
  }
}

TEST_F(FormatRuns, SummariesOfBodiesHaveTheirFrames) {
  run(with(kBar, "MODEL", kHexahedra), {"world.gravity=[0,-1,0]"});
  nlohmann::json bar = summary("out").at("bodies").at("bar");
  EXPECT_EQ(bar.at("frames"), 0);
  EXPECT_EQ(bar.at("nodes"), 81);
  EXPECT_EQ(summary("out").at("up"), nlohmann::json({0.0, 1.0, 0.0}));
  run(with(kBar, "MODEL", kFrames), {"world.up=[1,0,0]"});
  bar = summary("out").at("bodies").at("bar");
  EXPECT_EQ(bar.at("frames"), 36);
  EXPECT_FALSE(bar.contains("nodes"));
  EXPECT_EQ(summary("out").at("up"), nlohmann::json({1.0, 0.0, 0.0}));
}

TEST_F(FormatRuns, KeysWithoutEffectAreTold) {
  run(with(kBar, "MODEL", kHexahedra), {"output.fields=['rotation']"});
  EXPECT_TRUE(warns("no-effect"));
  run(with(kBar, "MODEL", kFrames), {"output.fields=['rotation']"});
  EXPECT_FALSE(warns("no-effect"));
  run(with(kBar, "MODEL", kHexahedra), {"loads=", "solver={kind='modes',count=500}"});
  EXPECT_TRUE(warns("no-effect"));
}

/// Frames of a cloud are not where their material is: what embeds them is told, and the gap is that of the material.
TEST_F(FormatRuns, ScatteredFramesThatAreEmbeddedPart) {
  const std::string pair = R"([bodies.host]
model = "hexahedra"
domain = { box = { min = [0, 0, 0], max = [1, 0.2, 0.2], cells = [4, 2, 2] } }
density = 1000
material = { young = 1e6, poisson = 0 }
[bodies.rider]
model = "meshless"
domain = { box = { min = [1, 0, 0], max = [2, 0.2, 0.2] } }
density = 1000
material = { young = 5e5, poisson = 0 }
frames = FRAMES
[couplings.c]
kind = "embed"
body = "rider"
where = { box = { min = [0.9999, -9, -9], max = [1.0001, 9, 9] } }
to = "host"
[[constraints]]
body = "host"
where = { box = { min = [-0.001, -9, -9], max = [0.001, 9, 9] } }
fix = "all"
[[loads]]
body = "rider"
where = { box = { min = [1.999, -9, -9], max = [2.001, 9, 9] } }
total_force = [0.4, 0, 0]
[solver]
kind = "static"
)";
  run(with(pair, "FRAMES", "{ poisson_disk = 0.15 }"), {"silence=['load']"});
  EXPECT_TRUE(warns("scattered"));
  EXPECT_GT(summary("out").at("couplings").at("c").at("gap").get<double>(), 1e-6);  // the joint moves by 1e-5
  run(with(pair, "FRAMES", "{ grid = [9, 3, 3] }"), {"silence=['load']"});
  EXPECT_FALSE(warns("scattered"));
  EXPECT_LT(summary("out").at("couplings").at("c").at("gap").get<double>(), 1e-7);
}

/// Nearly incompressible tetrahedra meet some indefinite tangents on the way from their first guess, and no buckle:
/// they are stretched in few steps.
TEST_F(FormatRuns, StretchesWithoutABuckleAreNotCut) {
  const std::string stretched = R"([bodies.b]
model = "tetrahedra"
domain = { box = { min = [0, -0.1, -0.1], max = [1, 0.1, 0.1], cells = [8, 2, 2] } }
material = { law = "neo-hookean", young = 1e5, poisson = 0.49 }
density = 1000
[[constraints]]
body = "b"
where = { box = { min = [-0.001, -9, -9], max = [0.001, 9, 9] } }
fix = "all"
[[constraints]]
body = "b"
where = { box = { min = [0.999, -9, -9], max = [1.001, 9, 9] } }
move = { translate = [SHIFT, 0, 0] }
[solver]
kind = "static"
)";
  for (const auto& [shift, most] : {std::pair{"0.3", 20}, std::pair{"1", 60}}) {
    run(with(stretched, "SHIFT", shift));
    EXPECT_LE(summary("out").at("newton_iterations").get<int>(), most) << shift;  // 42 and 154 where each cuts a step
    EXPECT_FALSE(warns("solver")) << shift;
  }
}

/// The ends of an inflated tube of coarse triangles bulge, unless they are held; a strip that is pulled has flat edges.
TEST_F(FormatRuns, EdgesThatBulgeAreTold) {
  const std::string tube = R"([bodies.tube]
model = "shell"
domain = { cylinder = { from = [0, 0, 0], to = [0, 0, 0.1], radius = 0.02, cells = [20, 12], caps = false } }
thickness = 0.0002
density = 1000
material = { young = 1e6, poisson = 0.3 }
[[constraints]]
body = "tube"
where = { box = { min = [-1, -1, -1e-6], max = [1, 1, 1e-6] } }
fix = "all"
[[loads]]
body = "tube"
where = "all"
pressure = -1
)";
  run(tube);
  EXPECT_TRUE(warns("resolution"));
  run(tube + "[[constraints]]\nbody='tube'\nwhere={box={min=[-1,-1,0.0999],max=[1,1,1]}}\nfix=['x','y']\n");
  EXPECT_FALSE(warns("resolution"));
  run(R"([bodies.strip]
model = "shell"
domain = { rectangle = { origin = [0, 0, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.04, 0], cells = [10, 4] } }
thickness = 0.0002
density = 1000
material = { young = 1e6, poisson = 0.3 }
[[constraints]]
body = "strip"
where = { box = { min = [-1, -1, -1], max = [1e-6, 1, 1] } }
fix = "all"
[[loads]]
body = "strip"
where = { box = { min = [0.0999, -1, -1], max = [1, 1, 1] } }
total_force = [0.001, 0, 0]
)");
  EXPECT_FALSE(warns("resolution"));
}

/// Triangles that face against the directors of their corners are no physical state, as solids inside out are none: a
/// ball of few triangles, blown to one and a half times its size.
TEST_F(FormatRuns, ShellsThatAreInsideOutAreInverted) {
  const std::string blown = R"([bodies.s]
model = "shell"
domain = { sphere = { center = [0, 0, 0], radius = 0.1, cells = [32] } }
thickness = 0.002
density = 1000
material = { young = 1e6, poisson = 0.3 }
fluid = { bulk_modulus = 1e8, volume = 0.0141372 }
[[constraints]]
body = "s"
where = { box = { min = [-1e-6, -9, -9], max = [1e-6, 9, 9] } }
fix = ["x"]
[[constraints]]
body = "s"
where = { box = { min = [-9, -1e-6, -9], max = [9, 1e-6, 9] } }
fix = ["y"]
[[constraints]]
body = "s"
where = { box = { min = [-9, -9, -1e-6], max = [9, 9, 1e-6] } }
fix = ["z"]
)";
  EXPECT_NE(run(blown, {}, 3).find("face against the directors"), std::string::npos);
  EXPECT_EQ(summary("out").at("status"), "inverted");
  run(blown, {"solver.accept=['inverted']"});
  EXPECT_EQ(summary("out").at("status"), "converged");
  EXPECT_TRUE(warns("inverted"));
}

/// A tapered block has the volume of its trilinear map, and bends as hexahedra of the same shape do.
TEST_F(FormatRuns, FramesFillATaperedBlock) {
  const std::string block = R"([world]
gravity = [0, 0, -1]
[bodies.b]
MODEL
density = 1000
material = { young = 1e6, poisson = 0.3 }
[[constraints]]
body = "b"
where = { box = { min = [-1, -1, -1], max = [0.001, 1, 1] } }
fix = "all"
[solver]
kind = "static"
[probes.tip]
body = "b"
at = [1, 0.1, 0.1]
quantity = "displacement"
)";
  const std::string domain =
      "domain = { block = { corners = [[0, 0, 0], [1, 0.05, 0.05], [1, 0.15, 0.05], [0, 0.2, 0], [0, 0, 0.2], [1, "
      "0.05, "
      "0.15], [1, 0.15, 0.15], [0, 0.2, 0.2]]CELLS } }\n";
  run(with(block, "MODEL", with(domain, "CELLS", ", cells = [10, 3, 3]") + "model = \"hexahedra\"\norder = 2"));
  const double sag = value("tip")[2];
  for (const auto& [frames, allowed] :
       {std::pair{"frames = { poisson_disk = 0.08 }", 0.03},
        std::pair{"frames = { grid = [11, 4, 4] }\npoints = { per_cell = [3, 3, 3] }", 0.06}}) {
    run(with(block, "MODEL", with(domain, "CELLS", "") + "model = \"meshless\"\n" + frames));
    EXPECT_NEAR(summary("out").at("bodies").at("b").at("volume").get<double>(), 0.07 / 3, 1e-12);
    EXPECT_NEAR(value("tip")[2].get<double>() / sag, 1, allowed) << frames;
  }
}

/// A flat ring of scattered frames has the area of a ring, and sags as shells do that are held where it is held.
TEST_F(FormatRuns, FramesFillARing) {
  const std::string ring = R"([world]
gravity = [0, 0, -1]
[bodies.b]
MODEL
thickness = 0.05
density = 1000
material = { young = 1e7, poisson = 0.3 }
[[constraints]]
body = "b"
where = { cylinder = { from = [0, 0, -1], to = [0, 0, 1], radius = 0.5001 } }
fix = "all"
[solver]
kind = "static"
[probes.rim]
body = "b"
at = [1, 0, 0]
quantity = "displacement"
)";
  const std::string domain =
      "domain = { annulus = { center = [0, 0, 0], normal = [0, 0, 1], inner = 0.5, outer = 1CELLS } }\n";
  run(with(ring, "MODEL", with(domain, "CELLS", ", cells = [8, 48]") + "model = \"shell\""));
  const double sag = value("rim")[2];
  run(with(ring, "MODEL", with(domain, "CELLS", "") + "model = \"meshless\"\nframes = { poisson_disk = 0.05 }"));
  EXPECT_NEAR(summary("out").at("bodies").at("b").at("volume").get<double>(), std::acos(-1.0) * 0.75 * 0.05, 1e-12);
  std::printf("ring: shell %.6f m, frames %.6f m\n", sag, value("rim")[2].get<double>());
  EXPECT_NEAR(value("rim")[2].get<double>() / sag, 1, 0.06);  // 0.19, 0.11, 0.04, 0.035 at 0.12, 0.08, 0.05, 0.035 m
  write("scene.toml",
        with(ring, "MODEL", with(domain, "CELLS", "") + "model = \"meshless\"\nframes = { grid = [4, 4] }"));
  const ProgramResult refused = fascia({"check", "scene.toml"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("frames.grid: cannot fill an annulus"), std::string::npos) << refused.err;
}

}  // namespace
}  // namespace fascia::format_runs_test
