#include "tests/robustness/scene_runs.hpp"

#include <cmath>

namespace fascia::bad_couplings_test {

// Couplings that contradict themselves or hold too little. One line that names the key and the place; status 2, nothing
// written. And those that look odd but are sound: they run, without a NaN.
namespace {

using namespace fascia::test;

constexpr const char* kMaterial = "[materials.soft]\nyoung = \"100 kPa\"\npoisson = 0.3\n";
constexpr const char* kGravity = "[world]\ngravity = [0, 0, -0.1]\n";
constexpr const char* kStatic = "[solver]\nkind = \"static\"\n";
constexpr const char* kDynamic = "[solver]\nkind = \"implicit-euler\"\ntime_step = \"5 ms\"\nsteps = 4\n";
constexpr const char* kBottom = "{ halfspace = { point = [0, 0, 0.001], normal = [0, 0, 1] } }";

/// A slab 0.2 × 0.2 × 0.1 m whose lower face is at `bottom` tenths of a metre.
std::string slab(const std::string& name, const std::string& model, int bottom) {
  const std::string low = std::to_string(0.1 * bottom), high = std::to_string(0.1 * (bottom + 1));
  std::string cells = model == "meshless" ? "" : ", cells = [2, 2, 1]";
  std::string text = "[bodies." + name + "]\nmodel = \"" + model + "\"\ndomain = { box = { min = [0, 0, " + low +
                     "], max = [0.2, 0.2, " + high + "]" + cells + " } }\n";
  if (model != "surface") text += "density = 1000\n";
  if (model != "surface" && model != "rigid") text += "material = \"soft\"\n";
  if (model == "meshless") text += "frames = { grid = [3, 3, 2] }\n";
  return text;
}

/// The nodes between z = 0.1 m and 0.2 m lower edge of a slab.
std::string level(int bottom) {
  return "{ box = { min = [-1, -1, " + std::to_string(0.1 * bottom - 0.001) + "], max = [1, 1, " +
         std::to_string(0.1 * bottom + 0.001) + "] } }";
}

std::string coupling(const std::string& name, const std::string& kind, const std::string& body,
                     const std::string& where, const std::string& to) {
  return "[couplings." + name + "]\nkind = \"" + kind + "\"\nbody = \"" + body + "\"\nwhere = " + where + "\nto = \"" +
         to + "\"\n";
}

std::string fixed(const std::string& body, const std::string& where) {
  return "[[constraints]]\nbody = \"" + body + "\"\nwhere = " + where + "\nfix = \"all\"\n";
}

/// A tissue on top of the lower slab, frames of which are nodes of that.
std::string tissue(const std::string& frames, const std::string& share) {
  return "[bodies.tissue]\nmodel = \"meshless\"\ndomain = { box = { min = [0, 0, 0.1], max = [0.2, 0.2, 0.2] } }\n"
         "frames = { " +
         frames + ", share = [" + share + "] }\ndensity = 1000\nmaterial = \"soft\"\n";
}

/// The texts one after the other.
std::string all(std::initializer_list<std::string> parts) {
  std::string text;
  for (const std::string& part : parts) text += part;
  return text;
}

std::string gap(const std::string& more = "", const std::string& where = "") {
  return "[bodies.tissue]\nmodel = \"meshless\"\ndomain = { between = [\"low\", \"up\"]" +
         (where.empty() ? "" : ", where = " + where) + more +
         " }\nframes = { count = 8 }\ndensity = 1000\nmaterial = \"soft\"\n";
}

class BadCouplings : public SceneRuns {
 protected:
  nlohmann::json expect_sound(const std::string& scene) const {
    write("scene.toml", scene);
    const ProgramResult result = fascia({"run", "scene.toml", "--output", "sound"});
    EXPECT_EQ(result.status, 0) << result.err;
    if (result.status != 0) return {};
    EXPECT_EQ(read_text(folder_ / "sound" / "summary.json").find("null"), std::string::npos);
    return summary("sound");
  }

  std::string checked(const std::string& scene) const {
    write("scene.toml", scene);
    const ProgramResult result = fascia({"check", "scene.toml"});
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  }
};

const std::string kTwo = std::string(kGravity) + kMaterial + slab("low", "tetrahedra", 0);

TEST_F(BadCouplings, Shares) {
  const std::string rest = fixed("low", kBottom) + kStatic, top = "where = " + level(1);
  const auto shares = [&](const std::string& share, const std::string& frames = "count = 8") {
    return kTwo + tissue(frames, share) + rest;
  };
  expect_refused(shares("{ body = \"low\", where = " + level(7) + " }"),
                 {"bodies.tissue.frames.share[0].where", "selects no node of body \"low\", which lies between"});
  expect_refused(shares("{ body = \"tissue\" }"), {"bodies.tissue.frames.share[0].body", "is the body itself"});
  expect_refused(shares("{ body = \"lwo\" }"), {"bodies.tissue.frames.share[0].body", "did you mean \"low\"?"});
  expect_refused(shares("{ body = \"low\", " + top + " }", "grid = [4, 4, 2]"),
                 {"bodies.tissue.frames.grid", "coincides with no frame of the grid", "use scattered frames"});
  expect_refused(shares(""), {"bodies.tissue:", "nothing holds this body"});
  // Overlapping shares are one; a body may come later in the file.
  expect_sound(shares("{ body = \"low\", " + top + " }, { body = \"low\", " + top + ", rotations = false }"));
  expect_sound(std::string(kGravity) + kMaterial + tissue("count = 8", "{ body = \"low\", " + top + " }") +
               slab("low", "tetrahedra", 0) + rest);
}

TEST_F(BadCouplings, SheetsNeedRotations) {
  std::string sheet = tissue("count = 8", "{ body = \"low\", where = " + level(1) + ", rotations = false }");
  sheet = with(sheet, "box = { min = [0, 0, 0.1], max = [0.2, 0.2, 0.2] }",
               "rectangle = { origin = [0, 0, 0.1], edge_u = [0.2, 0, 0.1], edge_v = [0, 0.2, 0] }");
  expect_refused(kTwo + with(sheet, "density", "thickness = 0.002\ndensity") + fixed("low", kBottom) + kStatic,
                 {"bodies.tissue.frames.count", "share them with rotations = true"});
}

TEST_F(BadCouplings, ContradictingHolds) {
  const std::string move =
      "[[constraints]]\nbody = \"tissue\"\nwhere = " + level(1) + "\nmove = { translate = [0.01, 0, 0] }\n";
  const std::string hold = fixed("low", level(1)), share = "{ body = \"low\", where = " + level(1) + " }";
  for (const char* frames : {"grid = [3, 3, 2]", "count = 8"}) {
    SCOPED_TRACE(frames);
    for (const std::string& both : {hold + move, move + hold})
      expect_refused(all({kTwo, tissue(frames, share), both, kStatic}),
                     {"constraints[", "prescribes another value than an earlier constraint"});
    expect_sound(all({kTwo, tissue(frames, share), hold, fixed("tissue", level(1)), kStatic}));
  }
}

TEST_F(BadCouplings, Circles) {
  const std::string rest = fixed("low", kBottom) + kStatic;
  for (const char* model : {"meshless", "tetrahedra"}) {
    const std::string bodies = all({kGravity, kMaterial, slab("low", model, 0), slab("up", model, 1)});
    expect_refused(all({bodies, coupling("a", "embed", "up", level(1), "low"),
                        coupling("b", "embed", "low", level(1), "up"), rest}),
                   {"couplings.b:", "closes a circle: body \"low\" follows \"up\""});
    // A chain is none.
    expect_sound(all({bodies, slab("top", model, 2), coupling("a", "embed", "up", level(1), "low"),
                      coupling("b", "embed", "top", level(2), "up"), rest}));
  }
  std::string other = tissue("count = 8", "{ body = \"tissue\" }");
  expect_refused(
      kTwo + tissue("count = 8", "{ body = \"other\" }") + with(other, "[bodies.tissue]", "[bodies.other]") + rest,
      {"bodies.other.frames.share[0].body", "closes a circle, tissue → other → tissue"});
}

TEST_F(BadCouplings, Followers) {
  const std::string rest = fixed("low", kBottom) + kStatic;
  const auto scene = [&](const std::string& model, const std::string& more) {
    return kTwo + slab("up", model, 1) + more + rest;
  };
  const std::string top = level(1);
  expect_refused(scene("meshless", coupling("a", "embed", "up", top, "low") + coupling("b", "embed", "up", top, "low")),
                 {"couplings.b:", "follows couplings.a already"});
  expect_refused(scene("meshless", coupling("a", "embed", "up", top, "low") + fixed("up", top)),
                 {"couplings.a:", "is held by a constraint, and cannot follow \"low\" too"});
  expect_refused(scene("meshless", coupling("a", "weld", "up", top, "low")),
                 {"couplings.a.to", "has no frames", "use kind = \"embed\""});
  expect_refused(scene("meshless", coupling("a", "embed", "up", "\"all\"", "low")),
                 {"couplings.a:", "lies 0.1 m outside body \"low\""});
  expect_refused(scene("meshless", coupling("a", "embed", "up", level(5), "low")),
                 {"couplings.a.where", "selects no frame of body \"up\""});
  expect_refused(scene("meshless", coupling("a", "embed", "up", top, "up")), {"couplings.a.to", "is the body itself"});
  expect_refused(scene("meshless", coupling("up", "embed", "up", top, "low")), {"couplings.up:", "name of a body"});
  expect_refused(scene("meshless", coupling("\"ö\"", "embed", "up", top, "low")), {"cannot name a file"});
  const std::string affine = with(scene("meshless", ""), "[3, 3, 2] }", "[3, 3, 2], kind = \"affine\" }");
  expect_refused(affine + slab("top", "meshless", 2) + coupling("a", "weld", "top", level(2), "up"),
                 {"couplings.a:", "welds affine frames"});
  expect_refused(std::string(kGravity) + kMaterial + slab("low", "meshless", 0) +
                     coupling("a", "weld", "low", "\"all\"", "bone") + rest,
                 {"couplings.a.to", "the scene has no other"});
}

TEST_F(BadCouplings, Between) {
  const std::string rest = fixed("low", kBottom) + kStatic;
  const std::string sides = "{ box = { min = [-1, -1, 0.099], max = [1, 1, 0.201] } }";
  const std::string apart = kTwo + slab("up", "tetrahedra", 2);
  expect_refused(apart + gap() + rest, {"bodies.tissue.domain", "do not face each other"});
  expect_refused(apart + gap("", level(1)) + rest, {"bodies.tissue.domain", "selects no face", "\"up\""});
  expect_refused(kTwo + slab("up", "tetrahedra", 1) + gap("", level(1)) + rest,
                 {"bodies.tissue.domain", "touch everywhere"});
  expect_refused(apart + gap(", as = \"sheet\"", sides) + rest, {"bodies.tissue.thickness", "is missing for as"});
  expect_refused(apart + gap(", as = \"strands\"", sides) + rest, {"bodies.tissue.radius", "is missing for as"});
  expect_refused(apart + with(gap("", sides), "count = 8", "grid = [2, 2, 2]") + rest,
                 {"bodies.tissue.frames.grid", "cannot fill the space between two bodies"});
  expect_refused(apart + with(gap("", sides), "[\"low\", \"up\"]", "[\"low\", \"low\"]") + rest,
                 {"bodies.tissue.domain.between[1]", "is the same body again"});
  const std::string line =
      with(with(slab("up", "meshless", 2), "box = { min = [0, 0, 0.200000], max = [0.2, 0.2, 0.300000] }",
                "line = { from = [0, 0, 0.2], to = [0.2, 0.2, 0.2] }"),
           "grid = [3, 3, 2]", "grid = [3]");
  expect_refused(kTwo + line + "radius = 0.01\n" + gap("", sides) + rest,
                 {"bodies.tissue.domain", "body \"up\" has no faces"});
  for (const char* model : {"rigid", "meshless", "hexahedra"})
    expect_sound(all({kTwo, slab("up", model, 2), gap("", sides), rest}));
}

TEST_F(BadCouplings, MechanismsAreNamed) {
  const std::string rest = fixed("low", kBottom) + kStatic;
  const auto hung = [&](const std::string& where) {
    return std::string(kGravity) + kMaterial + slab("low", "meshless", 0) + slab("up", "tetrahedra", 1) +
           coupling("joint", "embed", "up", where, "low");
  };
  const std::string ball = "{ nearest = [0, 0, 0.1] }";
  const std::string hinge = "{ any_of = [{ nearest = [0, 0, 0.1] }, { nearest = [0.2, 0, 0.1] }] }";
  expect_refused(hung(ball) + rest,
                 {"bodies.up:", "hangs on a mechanism", "(rotation about x, rotation about y, rotation about z)"});
  expect_refused(hung(hinge) + rest, {"bodies.up:", "(rotation about x)", "couple it at more nodes"});
  expect_refused(kTwo + slab("up", "rigid", 1) + rest,
                 {"bodies.up:", "nothing holds this body in a static solve (translation along x,"});
  std::string springs = std::string(kGravity) + kMaterial + slab("up", "tetrahedra", 1);
  for (const char* axis : {"x", "y", "z"})
    springs += std::string("[couplings.") + axis + "]\nkind = \"spring\"\nbody = \"up\"\nwhere = " + ball +
               "\npoint = [0, 0, 1]\nstiffness = 10\ndirection = [" + (*axis == 'x' ? "1" : "0") + ", " +
               (*axis == 'y' ? "1" : "0") + ", " + (*axis == 'z' ? "1" : "0") + "]\n";
  expect_refused(springs + kStatic,
                 {"bodies.up:", "nothing holds this body", "(rotation about x, rotation about y, rotation about z)"});
  const std::string said = checked(hung(hinge) + fixed("low", kBottom) + kDynamic);
  for (const char* line : {"coupling joint: 2 nodes of \"up\" embedded in \"low\"", "body low: alone held",
                           "mechanism: \"up\": rotation about x"})
    EXPECT_NE(said.find(line), std::string::npos) << said;
}

TEST_F(BadCouplings, ManyPieces) {
  constexpr int count = 3000;
  std::string points, cells, types;
  for (int i = 0; i < count; ++i) {
    const int x = 2 * (i % 15), y = 2 * (i / 15 % 15), z = 2 * (i / 225);
    for (int k = 0; k < 4; ++k)
      points +=
          std::to_string(x + (k == 1)) + " " + std::to_string(y + (k == 2)) + " " + std::to_string(z + (k == 3)) + "\n";
    cells += "4 " + std::to_string(4 * i) + " " + std::to_string(4 * i + 1) + " " + std::to_string(4 * i + 2) + " " +
             std::to_string(4 * i + 3) + "\n";
    types += "10\n";
  }
  const std::string n = std::to_string(count);
  write("crumbs.vtk", "# vtk DataFile Version 3.0\ncrumbs\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " +
                          std::to_string(4 * count) + " double\n" + points + "CELLS " + n + " " +
                          std::to_string(5 * count) + "\n" + cells + "CELL_TYPES " + n + "\n" + types);
  const std::string crumbs = std::string(kMaterial) +
                             "[bodies.crumbs]\nmodel = \"tetrahedra\"\ndomain = { file = \"crumbs.vtk\" }\ndensity = "
                             "1000\nmaterial = \"soft\"\n";
  expect_refused(crumbs + kStatic, {"bodies.crumbs:", "and 2999 more of its parts"});
  const std::string box =
      "[bodies.box]\nmodel = \"rigid\"\ndomain = { box = { min = [-1, -1, -1], max = [50, 50, 50] } "
      "}\nmass = 1\n" +
      fixed("box", "\"all\"");
  std::string corners;
  for (int i = 0; i < count; ++i) corners += (i > 0 ? ", " : "") + std::to_string(4 * i);
  expect_refused(crumbs + box + coupling("joint", "embed", "crumbs", "{ ids = [" + corners + "] }", "box") + kStatic,
                 {"bodies.crumbs:", "hangs on a mechanism", "rotation about x of its part", "and 8994 more motions"});
  const std::string said = checked(crumbs + box + coupling("joint", "embed", "crumbs", "\"all\"", "box") + kStatic);
  EXPECT_NE(said.find("body crumbs: 3000 parts"), std::string::npos) << said;
}

TEST_F(BadCouplings, Springs) {
  const auto scene = [&](const std::string& stiffness, const std::string& more = "") {
    return kTwo + "[couplings.s]\nkind = \"spring\"\nbody = \"low\"\nwhere = " + level(1) +
           "\npoint = [0, 0, 0.1]\nstiffness = " + stiffness + "\n" + more + fixed("low", kBottom) + kStatic;
  };
  expect_refused(scene("0"), {"couplings.s.stiffness", "must be above 0"});
  expect_refused(scene("-1"), {"couplings.s.stiffness", "must be above 0"});
  expect_refused(scene("nan"), {"couplings.s.stiffness", "is not finite"});
  expect_refused(scene("1", "direction = [0, 0, 0]\n"), {"couplings.s.direction", "has no direction"});
  expect_refused(scene("1", "to = \"low\"\n"), {"couplings.s.to", "is not used by kind = \"spring\""});
  for (const char* stiffness : {"1e-9", "10", "1e15"}) expect_sound(scene(stiffness));  // one ends where it begins
  write("scene.toml", scene("1"));
  const ProgramResult result = fascia({"check", "scene.toml", "--set", "couplings.s.stifness=3"});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("did you mean \"stiffness\"?"), std::string::npos) << result.err;
}

TEST_F(BadCouplings, Surfaces) {
  const std::string skin = slab("skin", "surface", 0), rest = fixed("low", kBottom);
  expect_refused(kTwo + skin + rest + kStatic, {"bodies.skin:", "rides on nothing; add [couplings.NAME]"});
  for (const char* solver : {kStatic, kDynamic})
    expect_refused(all({kTwo, skin, coupling("a", "embed", "skin", level(1), "low"), rest, solver}),
                   {"bodies.skin:", "9 of its 18 vertices ride on nothing", "where = \"all\""});
  const std::string rides = kTwo + skin + coupling("a", "embed", "skin", "\"all\"", "low") + rest;
  expect_sound(rides + kStatic);
  // What is embedded in it or held to it by springs is carried by what it rides on.
  expect_sound(rides + slab("up", "tetrahedra", 1) + coupling("b", "embed", "up", level(1), "skin") + kStatic);
  expect_refused(rides + fixed("skin", "\"all\"") + kStatic, {"constraints[1].body", "is a surface"});
  expect_refused(kTwo + with(skin, "[bodies.skin]", "[bodies.skin]\nfluid = { pressure = 1 }") +
                     coupling("a", "embed", "skin", "\"all\"", "low") + rest + kStatic,
                 {"bodies.skin.fluid", "is not used by model = \"surface\""});
}

TEST_F(BadCouplings, BodiesWithoutNodesOfTheirOwn) {
  const std::string whole = with(tissue("grid = [3, 3, 2]", "{ body = \"low\" }"),
                                 "min = [0, 0, 0.1], max = [0.2, 0.2, 0.2]", "min = [0, 0, 0], max = [0.2, 0.2, 0.1]");
  const std::string rest = fixed("low", kBottom) + kDynamic;
  expect_refused(kTwo + with(whole, "density", "initial = { velocity = [1, 0, 0] }\ndensity") + rest,
                 {"bodies.tissue:", "initial motion is lost on this body"});
  std::string probes;
  for (const char* quantity : {"max_displacement", "mean_displacement", "momentum", "kinetic_energy", "total_energy",
                               "volume", "mass", "energy"})
    probes += std::string("[probes.") + quantity + "]\nbody = \"tissue\"\nquantity = \"" + quantity + "\"\n";
  for (const char* quantity : {"displacement", "rotation", "velocity", "strain", "stress"})
    probes += std::string("[probes.") + quantity + "]\nbody = \"tissue\"\nat = [0.1, 0.1, 0.1]\nquantity = \"" +
              quantity + "\"\n";
  const nlohmann::json results =
      expect_sound(kTwo + whole + rest + probes + "[output]\npicture = { size = [64, 64] }\n");
  EXPECT_GT(results["probes"]["max_displacement"]["value"].get<double>(), 0);
}

TEST_F(BadCouplings, RigidBodies) {
  const std::string bone = slab("bone", "rigid", 0), rest = kDynamic;
  const std::string open = with(bone, "box = { min = [0, 0, 0.000000], max = [0.2, 0.2, 0.100000], cells = [2, 2, 1] }",
                                "rectangle = { origin = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 1, 0], cells = [2, "
                                "2] }");
  expect_refused(open + rest, {"bodies.bone.density", "needs a volume"});
  const auto inertia = [&](const std::string& rows) {
    return with(bone, "density = 1000", "mass = 1\ninertia = " + rows);
  };
  expect_refused(inertia("[[-1, 0, 0], [0, 1, 0], [0, 0, 1]]") + rest, {"bodies.bone.inertia", "must be above 0"});
  expect_refused(inertia("[[nan, 0, 0], [0, 1, 0], [0, 0, 1]]") + rest, {"bodies.bone.inertia", "is not finite"});
  expect_refused(inertia("[[1, 0, 0], [0, 1, 0], [0, 0, 5]]") + rest, {"bodies.bone.inertia", "which no mass has"});
  expect_refused(with(bone, "density = 1000", "mass = 0") + rest, {"bodies.bone.mass", "must be above 0"});
  expect_refused(bone + "[solver]\nkind = \"modes\"\n", {"solver:", "nothing in the scene is elastic"});
  const std::string turned =
      "[[constraints]]\nbody = \"bone\"\nwhere = \"all\"\nmove = { rotate = { axis = [0, 0, 1], "
      "angle = \"720 degree\", center = [0, 0, 0] } }\n";
  const std::string probe = "[probes.corner]\nbody = \"bone\"\nat = [0.2, 0.2, 0.1]\nquantity = \"displacement\"\n";
  const nlohmann::json results = expect_sound(bone + turned + kStatic + probe);
  for (const double u : results["probes"]["corner"]["value"]) EXPECT_NEAR(u, 0, 1e-12);
  const std::string said = checked(bone + "[solver]\nkind = \"explicit\"\ntime_step = \"auto\"\nduration = 0.01\n");
  EXPECT_NE(said.find("nothing elastic limits the time step"), std::string::npos) << said;
}

/// Stiffnesses and masses of 8 and 6 orders apart are solved; so is the same scene in other lengths.
TEST_F(BadCouplings, Extremes) {
  const std::string sides = "{ box = { min = [-1, -1, 0.099], max = [1, 1, 0.201] } }";
  const std::string scene = kTwo + with(slab("up", "tetrahedra", 2), "density = 1000", "density = 1000.5") +
                            with(gap("", sides), "\"soft\"", "{ young = \"10 kPa\", poisson = 0.3 }") +
                            fixed("low", kBottom);
  expect_sound(with(scene, "10 kPa", "1e9 kPa") + kStatic);
  for (const char* young : {"1e9 kPa", "1e-6 kPa"}) expect_sound(with(scene, "10 kPa", young) + kDynamic);
  for (const char* density : {"1e-3", "1e9"}) expect_sound(with(scene, "1000.5", density) + kDynamic);
}

/// A heavy bar in the corner of a light second-order host, whose weights are negative: what a static solve without
/// gravity does not use is not refused.
TEST_F(BadCouplings, MassesThatNothingMoves) {
  const std::string box = "{ box = { min = [-0.1, -1, -1], max = [0.01, 2, 2] } }";
  const std::string scene =
      "[bodies.host]\nmodel = \"tetrahedra\"\norder = 2\ndomain = { box = { min = [0, 0, 0], max = [1, 1, 1], cells = "
      "[1, 1, 1] } }\ndensity = 1\nmaterial = { young = 1e4, poisson = 0.3 }\n[bodies.bar]\nmodel = \"hexahedra\"\n"
      "domain = { box = { min = [0.1, 0.02, 0.02], max = [0.9, 0.1, 0.1], cells = [4, 1, 1] } }\ndensity = 1e4\n"
      "material = { young = 1e6, poisson = 0.3 }\n" +
      coupling("inside", "embed", "bar", "\"all\"", "host") + fixed("host", box) +
      "[[loads]]\nbody = \"host\"\nwhere = { box = { min = [0.99, -1, -1], max = [1.01, 2, 2] } }\ntotal_force = [10, "
      "0, 0]\n";
  expect_sound(scene + kStatic);
  for (const std::string& moved : {kGravity + scene + kStatic, scene + kDynamic})
    expect_refused(moved, {"couplings.inside", "would have a mass of"});
}

}  // namespace

}  // namespace fascia::bad_couplings_test
