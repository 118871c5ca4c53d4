#include "tests/unit/app/scene_text.hpp"

#include <gtest/gtest.h>

// What is wrong with rigid bodies, surfaces, the space between bodies, shared nodes and couplings. What follows the
// beam starts at line 10.
namespace fascia::app::couplings_errors_test {
namespace {

using test::errors_of_beam;

/// A body "bone": its domain at column 12 of line 12, further keys from line 13 on.
std::string errors_of_bone(const std::string& domain, const std::string& more = "mass = 1\n") {
  return errors_of_beam("[bodies.bone]\nmodel = \"rigid\"\ndomain = { " + domain + " }\n" + more);
}
const std::string bone_file = "file = \"bone.stl\"";

/// The bone and a body "tissue": its domain at column 12 of line 18, further keys from line 19 on.
std::string errors_of_tissue(const std::string& domain, const std::string& more) {
  return errors_of_bone(bone_file,
                        "mass = 1\n[bodies.tissue]\nmodel = \"meshless\"\nmaterial = \"soft\"\nmass = 1\n"
                        "domain = { " +
                            domain + " }\n" + more);
}

/// The bone and a coupling "c": keys from line 15 on.
std::string errors_of_coupling(const std::string& keys, const std::string& name = "c") {
  return errors_of_bone(bone_file, "mass = 1\n[couplings." + name + "]\n" + keys);
}

/// A surface "skin" with keys from line 13 on.
std::string errors_of_skin(const std::string& keys) {
  return errors_of_beam("[bodies.skin]\nmodel = \"surface\"\ndomain = { file = \"skin.obj\" }\n" + keys);
}
const std::string ride = "[couplings.ride]\nkind = \"embed\"\nbody = \"skin\"\nwhere = \"all\"\nto = \"beam\"\n";

TEST(RigidErrors, KeysOfOtherModels) {
  EXPECT_EQ(errors_of_bone(bone_file,
                           "mass = 1\nmaterial = \"soft\"\nframes = { count = 9 }\npoints = { count = 9 }\n"
                           "weights = { kind = \"mls\" }\nthickness = 1\nradius = 1\nfluid = { pressure = 1 }\n"
                           "formulation = \"linear\"\norder = 2\nincompressibility = 1\nlocking = \"none\"\n"),
            "a.toml:14:12: bodies.bone.material: is not used by model = \"rigid\"; remove it\n"
            "a.toml:15:10: bodies.bone.frames: is not used by model = \"rigid\"; remove it\n"
            "a.toml:16:10: bodies.bone.points: is not used by model = \"rigid\"; remove it\n"
            "a.toml:17:11: bodies.bone.weights: is not used by model = \"rigid\"; remove it\n"
            "a.toml:18:13: bodies.bone.thickness: is not used by model = \"rigid\"; remove it\n"
            "a.toml:19:10: bodies.bone.radius: is not used by model = \"rigid\"; remove it\n"
            "a.toml:20:9: bodies.bone.fluid: is not used by model = \"rigid\"; remove it\n"
            "a.toml:21:15: bodies.bone.formulation: is not used by model = \"rigid\"; remove it\n"
            "a.toml:22:9: bodies.bone.order: is not used by model = \"rigid\"; remove it\n"
            "a.toml:23:21: bodies.bone.incompressibility: is not used by model = \"rigid\"; remove it\n"
            "a.toml:24:11: bodies.bone.locking: is not used by model = \"rigid\"; remove it");
  EXPECT_EQ(errors_of_beam("inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n"),
            "a.toml:10:11: bodies.beam.inertia: is not used by model = \"meshless\"; remove it");
  EXPECT_EQ(
      test::errors_of(test::mesh_body("tetrahedra", test::meshed_box, "inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n")),
      "a.toml:9:11: bodies.block.inertia: is not used by model = \"tetrahedra\"; remove it");
}

TEST(RigidErrors, Mass) {
  EXPECT_EQ(errors_of_bone(bone_file, ""), "a.toml:10:1: bodies.bone: mass or density is missing; give exactly one");
  EXPECT_EQ(errors_of_bone(bone_file, "mass = 1\ndensity = 1\n"),
            "a.toml:14:11: bodies.bone.density: cannot stand beside mass; give only one of them");
  EXPECT_EQ(errors_of_bone(bone_file, "mass = 0\n"),
            "a.toml:13:8: bodies.bone.mass: 0 is out of range; must be above 0");
  EXPECT_EQ(errors_of_bone("rectangle = { origin = [0, 0, 0], edge_u = [2, 0, 0], edge_v = [0, 1, 0], cells = [4, 2] }",
                           "density = 1\n"),
            "a.toml:13:11: bodies.bone.density: needs a volume, and a rectangle encloses none; give mass in its place");
  EXPECT_EQ(errors_of_bone("annulus = { center = [0, 0, 0], normal = [0, 0, 1], inner = 1, outer = 2, cells = [1, 8] }",
                           "density = 1\n"),
            "a.toml:13:11: bodies.bone.density: needs a volume, and an annulus encloses none; give mass in its place");
  EXPECT_EQ(
      errors_of_bone("cylinder = { from = [0, 0, 0], to = [0, 0, 1], radius = 1, cells = [1, 8], closed = false }",
                     "density = 1\n"),
      "a.toml:13:11: bodies.bone.density: needs a volume, and a cylinder without caps encloses none; give mass "
      "in its place");
}

TEST(RigidErrors, Inertia) {
  const std::string unit = "inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n";
  EXPECT_EQ(errors_of_bone(bone_file, unit),
            "a.toml:13:11: bodies.bone.inertia: needs the mass too; must stand beside mass or density");
  EXPECT_EQ(errors_of_bone(bone_file, "density = 1\n" + unit), "");
  EXPECT_EQ(errors_of_bone(bone_file, "mass = 1\ninertia = [[1, 0.5, 0], [0.25, 1, 0], [0, 0, 1]]\n"),
            "a.toml:14:11: bodies.bone.inertia: is not symmetric: xy is 0.5 kg m2, yx is 0.25; must be equal");
  EXPECT_EQ(errors_of_bone(bone_file, "mass = 1\ninertia = [[1, 0, 0], [0, 0, 0], [0, 0, 1]]\n"),
            "a.toml:14:11: bodies.bone.inertia: 0 kg m2 about y is no inertia; must be above 0");
  EXPECT_EQ(errors_of_bone(bone_file, "mass = 1\ninertia = [[1, 0, 0], [0, 2, 0], [0, 0, 5]]\n"),
            "a.toml:14:11: bodies.bone.inertia: 5 kg m2 about z is above the sum of the two others, 3, which no mass "
            "has; must be at most the sum");
  EXPECT_EQ(errors_of_bone(bone_file, "mass = 1\ninertia = [1, 2, 3]\n"),
            "a.toml:14:12: bodies.bone.inertia[0]: 1 is of the wrong type; must be a list of 3, each a moment of "
            "inertia in kg m2\n"
            "a.toml:14:15: bodies.bone.inertia[1]: 2 is of the wrong type; must be a list of 3, each a moment of "
            "inertia in kg m2\n"
            "a.toml:14:18: bodies.bone.inertia[2]: 3 is of the wrong type; must be a list of 3, each a moment of "
            "inertia in kg m2");
  EXPECT_EQ(errors_of_bone(bone_file, "mass = 1\ninertia = [[\"1 kg\", 0, 0], [0, 1, 0], [0, 0, 1]]\n"),
            "a.toml:14:13: bodies.bone.inertia[0][0]: \"1 kg\" is a mass; must be a moment of inertia in kg m2, such "
            "as \"5 g cm2\"");
}

TEST(RigidErrors, Domains) {
  EXPECT_EQ(errors_of_bone("line = { from = [0, 0, 0], to = [0, 0, 3] }"),
            "a.toml:12:19: bodies.bone.domain.line: is no surface, which model = \"rigid\" needs; must be box, block, "
            "cylinder, ellipsoid, sphere, file, rectangle or annulus");
  EXPECT_EQ(
      errors_of_bone("sphere = { center = [0, 0, 0], radius = 1 }"),
      "a.toml:12:21: bodies.bone.domain.sphere.cells: is missing for model = \"rigid\"; must be a list of 1, each "
      "a whole number from 1 to 10000");
  EXPECT_EQ(errors_of_bone("sphere = { center = [0, 0, 0], radius = 1, cells = [8, 2] }"),
            "a.toml:12:63: bodies.bone.domain.sphere.cells: has two numbers, as of a solid; must be one for model = "
            "\"rigid\", the cells around");
  EXPECT_EQ(errors_of_bone("box = { min = [0, 0, 0], max = [1, 1, 1], split = 5 }"),
            "a.toml:12:62: bodies.bone.domain.box.split: is not used by model = \"rigid\"; remove it");
  EXPECT_EQ(errors_of_bone("box = { min = [0, 0, 0], max = [1, 1, 1], cells = [3000, 3000, 1] }"),
            "a.toml:12:62: bodies.bone.domain.box.cells: asks for 1.8e+07 cells of the skin; must be at most 10000000");
}

TEST(SurfaceErrors, HaveNoMatter) {
  EXPECT_EQ(errors_of_skin("mass = 1\ninertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\nmaterial = \"soft\"\n"
                           "thickness = 1\ninitial = { velocity = [1, 0, 0] }\nfluid = { pressure = 1 }\n" +
                           ride),
            "a.toml:13:8: bodies.skin.mass: is not used by model = \"surface\"; remove it\n"
            "a.toml:14:11: bodies.skin.inertia: is not used by model = \"surface\"; remove it\n"
            "a.toml:15:12: bodies.skin.material: is not used by model = \"surface\"; remove it\n"
            "a.toml:16:13: bodies.skin.thickness: is not used by model = \"surface\"; remove it\n"
            "a.toml:17:11: bodies.skin.initial: is not used by model = \"surface\"; remove it\n"
            "a.toml:18:9: bodies.skin.fluid: is not used by model = \"surface\"; remove it");
  EXPECT_EQ(errors_of_skin("density = 1\n" + ride),
            "a.toml:13:11: bodies.skin.density: is not used by model = \"surface\"; remove it");
}

TEST(SurfaceErrors, RideOnNothing) {
  const std::string message =
      "a.toml:10:1: bodies.skin: rides on nothing; add [couplings.NAME] with kind = \"embed\", body = \"skin\" and to "
      "= the body that it rides on";
  EXPECT_EQ(errors_of_skin(""), message);
  EXPECT_EQ(errors_of_skin("[couplings.s]\nkind = \"spring\"\nbody = \"skin\"\nwhere = \"all\"\npoint = [0, 0, 0]\n"
                           "stiffness = 1\n"),
            message);
  EXPECT_EQ(errors_of_skin("[couplings.s]\nkind = \"embed\"\nbody = \"skim\"\nwhere = \"all\"\nto = \"beam\"\n"),
            "a.toml:15:8: couplings.s.body: \"skim\" is no known body; did you mean \"skin\"?");
}

TEST(SurfaceErrors, CannotBeHeld) {
  EXPECT_EQ(
      errors_of_skin(ride + "[[constraints]]\nbody = \"skin\"\nwhere = \"all\"\nfix = \"all\"\n"),
      "a.toml:19:8: constraints[0].body: \"skin\" is a surface, which only rides on others and has no unknowns to "
      "hold; must be a body that it rides on");
}

TEST(CarrierErrors, Probes) {
  const auto rigid = [](const std::string& quantity) {
    return errors_of_bone(bone_file,
                          "mass = 1\n[probes.p]\nbody = \"bone\"\nat = [0, 0, 0]\nquantity = \"" + quantity + "\"\n");
  };
  EXPECT_EQ(rigid("displacement"), "");
  EXPECT_EQ(rigid("rotation"), "");
  EXPECT_EQ(rigid("strain"),
            "a.toml:17:12: probes.p.quantity: a rigid body has no strain; must be a quantity of motion, such as "
            "\"displacement\", or the probe of another body");
  EXPECT_EQ(rigid("stress"),
            "a.toml:17:12: probes.p.quantity: a rigid body has no stress; must be a quantity of motion, such as "
            "\"displacement\", or the probe of another body");
  const auto surface = [](const std::string& quantity, const std::string& at = "") {
    return errors_of_skin(ride + "[probes.p]\nbody = \"skin\"\nquantity = \"" + quantity + "\"\n" + at);
  };
  EXPECT_EQ(surface("max_displacement"), "");
  EXPECT_EQ(surface("velocity", "at = [0, 0, 0]\n"), "");
  for (const std::string quantity : {"volume", "mass", "energy", "kinetic_energy", "total_energy", "momentum",
                                     "angular_momentum", "fluid_volume", "fluid_pressure"})
    EXPECT_EQ(surface(quantity), "a.toml:20:12: probes.p.quantity: \"" + quantity +
                                     "\" is of matter, and a surface has none; must be a quantity of motion, such as "
                                     "\"displacement\", or the probe of a body that it rides on");
  EXPECT_EQ(surface("strain", "at = [0, 0, 0]\n"),
            "a.toml:20:12: probes.p.quantity: \"strain\" is of matter, and a surface has none; must be a quantity of "
            "motion, such as \"displacement\", or the probe of a body that it rides on");
}

TEST(BetweenErrors, Bodies) {
  const std::string frames = "frames = { count = 9 }\n";
  EXPECT_EQ(errors_of_tissue("between = [\"boen\", \"tissue\"]", frames),
            "a.toml:18:23: bodies.tissue.domain.between[0]: \"boen\" is no known body; did you mean \"bone\"?\n"
            "a.toml:18:31: bodies.tissue.domain.between[1]: is the body itself; must be another one");
  EXPECT_EQ(errors_of_tissue("between = [\"bone\", \"x\"]", frames),
            "a.toml:18:31: bodies.tissue.domain.between[1]: \"x\" is no known body; must be \"beam\" or \"bone\"");
  EXPECT_EQ(errors_of_tissue("between = [\"bone\", \"bone\"]", frames),
            "a.toml:18:31: bodies.tissue.domain.between[1]: is the same body again; must be another one");
  EXPECT_EQ(errors_of_tissue("between = [\"bone\", 3]", frames),
            "a.toml:18:31: bodies.tissue.domain.between[1]: 3 is of the wrong type; must be the name of a body");
}

TEST(BetweenErrors, What) {
  const std::string frames = "frames = { count = 9 }\n", pair = "between = [\"bone\", \"beam\"]";
  EXPECT_EQ(errors_of_tissue(pair + ", as = \"shet\"", frames),
            "a.toml:18:45: bodies.tissue.domain.as: \"shet\" is no known value; must be \"volume\", \"sheet\" or "
            "\"strands\" (did you mean \"sheet\"?)");
  EXPECT_EQ(errors_of_tissue(pair, frames + "thickness = 1\nradius = 1\n"),
            "a.toml:20:13: bodies.tissue.thickness: is used only with as = \"sheet\"; remove it\n"
            "a.toml:21:10: bodies.tissue.radius: is used only with as = \"strands\"; remove it");
  EXPECT_EQ(errors_of_tissue(pair + ", as = \"sheet\"", frames + "radius = 1\n"),
            "a.toml:14:1: bodies.tissue.thickness: is missing for as = \"sheet\"; must be a length in m above 0, or a "
            "list by region\n"
            "a.toml:20:10: bodies.tissue.radius: is used only with as = \"strands\"; remove it");
  EXPECT_EQ(errors_of_tissue(pair + ", as = \"strands\"", frames + "thickness = 1\n"),
            "a.toml:14:1: bodies.tissue.radius: is missing for as = \"strands\"; must be a length in m above 0\n"
            "a.toml:20:13: bodies.tissue.thickness: is used only with as = \"sheet\"; remove it");
  EXPECT_EQ(errors_of_tissue("box = { min = [0, 0, 0], max = [1, 1, 1] }, where = \"all\", as = \"volume\"", frames),
            "a.toml:18:64: bodies.tissue.domain.where: is used only with between; remove it\n"
            "a.toml:18:76: bodies.tissue.domain.as: is used only with between; remove it");
  EXPECT_EQ(errors_of_tissue(pair + ", where = { box = { min = [0, 0, 0] } }", frames),
            "a.toml:18:56: bodies.tissue.domain.where.box.max: is missing; must be a list of 3, each a length in m");
}

TEST(BetweenErrors, FramesAndPlace) {
  const std::string pair = "between = [\"bone\", \"beam\"]";
  EXPECT_EQ(errors_of_tissue(pair, "frames = { grid = [2, 2, 2] }\npoints = { per_cell = [2, 2, 2] }\n"),
            "a.toml:19:19: bodies.tissue.frames.grid: cannot fill the space between two bodies; use poisson_disk or "
            "count");
  EXPECT_EQ(errors_of_tissue(pair, "frames = { count = 9 }\npoints = { per_cell = [2, 2, 2] }\n"),
            "a.toml:20:23: bodies.tissue.points.per_cell: needs the cells of grid frames; use poisson_disk, count or "
            "file for scattered frames");
  EXPECT_EQ(errors_of_tissue(pair, "frames = { count = 9 }\ntransform = { scale = 2 }\n"),
            "a.toml:20:13: bodies.tissue.transform: is not used by the space between two bodies, which is where they "
            "are; remove it");
}

TEST(BetweenErrors, OtherModels) {
  const std::string pair = "between = [\"bone\", \"beam\"]";
  const auto errors = [&](const std::string& model, const std::string& more) {
    return errors_of_bone(bone_file, "mass = 1\n[bodies.tissue]\nmodel = \"" + model + "\"\ndomain = { " + pair +
                                         " }\nmass = 1\n" + more);
  };
  EXPECT_EQ(errors("tetrahedra", "material = \"soft\"\n"),
            "a.toml:16:22: bodies.tissue.domain.between: is for meshless bodies; must be box, block, cylinder, "
            "ellipsoid, sphere or file");
  EXPECT_EQ(errors("shell", "material = \"soft\"\nthickness = 1\n"),
            "a.toml:16:22: bodies.tissue.domain.between: is for meshless bodies; must be rectangle, annulus, cylinder, "
            "ellipsoid, sphere or file");
  EXPECT_EQ(errors("rigid", ""),
            "a.toml:16:22: bodies.tissue.domain.between: is for meshless bodies; must be box, block, cylinder, "
            "ellipsoid, sphere, file, rectangle or annulus");
}

TEST(ShareErrors, Bodies) {
  const std::string pair = "between = [\"bone\", \"beam\"]";
  EXPECT_EQ(
      errors_of_tissue(pair, "frames = { count = 9, share = [{ body = \"baem\" }, { body = \"tissue\" }, {}] }\n"),
      "a.toml:19:41: bodies.tissue.frames.share[0].body: \"baem\" is no known body; did you mean \"beam\"?\n"
      "a.toml:19:60: bodies.tissue.frames.share[1].body: is the body itself; must be another one\n"
      "a.toml:19:72: bodies.tissue.frames.share[2].body: is missing; must be the name of a body");
  EXPECT_EQ(
      errors_of_tissue(pair, "frames = { count = 9, share = \"beam\" }\n"),
      "a.toml:19:31: bodies.tissue.frames.share: \"beam\" is of the wrong type; must be a list, each a table with "
      "body");
  EXPECT_EQ(errors_of_tissue(pair, "frames = { count = 9, share = [{ body = \"beam\", rotation = true }] }\n"),
            "a.toml:19:49: bodies.tissue.frames.share[0].rotation: is no known key; did you mean \"rotations\"?");
  EXPECT_EQ(errors_of_tissue(pair, "frames = { share = [{ body = \"beam\" }] }\n"),
            "a.toml:19:10: bodies.tissue.frames: grid, poisson_disk, count, positions or file is missing; give exactly "
            "one");
}

TEST(ShareErrors, Circles) {
  const auto body = [](const std::string& name, const std::string& domain, const std::string& share) {
    return "[bodies." + name + "]\nmodel = \"meshless\"\nmaterial = \"soft\"\nmass = 1\ndomain = { " + domain +
           " }\nframes = { count = 9, share = [" + share + "] }\n";
  };
  const std::string box = "box = { min = [0, 0, 0], max = [1, 1, 1] }";
  const char* end = "; share and between must not lead back to a body";
  EXPECT_EQ(
      errors_of_beam(body("tissue", "between = [\"beam\", \"uterus\"]", "") +
                     body("uterus", box, "{ body = \"beam\" }, { body = \"tissue\" }")),
      std::string("a.toml:21:60: bodies.uterus.frames.share[1].body: closes a circle, tissue → uterus → tissue") + end);
  EXPECT_EQ(errors_of_beam(body("a", box, "{ body = \"b\" }") + body("b", box, "{ body = \"c\" }") +
                           body("c", "between = [\"beam\", \"b\"]", "")),
            std::string("a.toml:26:31: bodies.c.domain.between[1]: closes a circle, b → c → b") + end);
  EXPECT_EQ(errors_of_beam(body("a", box, "{ body = \"b\" }, { body = \"c\" }") +
                           body("b", box, "{ body = \"c\" }, { body = \"beam\" }") + body("c", box, "")),
            "");
}

TEST(CouplingErrors, Missing) {
  EXPECT_EQ(errors_of_coupling("body = \"beam\"\nwhere = \"all\"\n"),
            "a.toml:14:1: couplings.c.kind: is missing; must be \"weld\", \"embed\" or \"spring\"");
  EXPECT_EQ(errors_of_coupling("kind = \"glue\"\nbody = \"beam\"\nwhere = \"all\"\nto = \"bone\"\n"),
            "a.toml:15:8: couplings.c.kind: \"glue\" is no known value; must be \"weld\", \"embed\" or \"spring\"");
  EXPECT_EQ(errors_of_coupling("kind = \"weld\"\n"),
            "a.toml:14:1: couplings.c.body: is missing; must be the name of a body\n"
            "a.toml:14:1: couplings.c.where: is missing; must be \"all\" or a table with box, sphere, cylinder, "
            "halfspace, nearest, group, ids, boundary, all_of, any_of or not\n"
            "a.toml:14:1: couplings.c.to: is missing for kind = \"weld\"; must be the name of a body");
  EXPECT_EQ(
      errors_of_coupling("kind = \"spring\"\nbody = \"beam\"\nwhere = \"all\"\n"),
      "a.toml:14:1: couplings.c.point: is missing for kind = \"spring\"; must be a list of 3, each a length in m\n"
      "a.toml:14:1: couplings.c.stiffness: is missing for kind = \"spring\"; must be a force per length in N/m "
      "above 0");
}

TEST(CouplingErrors, KeysOfOtherKinds) {
  EXPECT_EQ(errors_of_coupling("kind = \"embed\"\nbody = \"beam\"\nwhere = \"all\"\nto = \"bone\"\npoint = [0, 0, 0]\n"
                               "stiffness = 1\ndirection = [0, 0, 1]\n"),
            "a.toml:19:9: couplings.c.point: is not used by kind = \"embed\"; remove it\n"
            "a.toml:20:13: couplings.c.stiffness: is not used by kind = \"embed\"; remove it\n"
            "a.toml:21:13: couplings.c.direction: is not used by kind = \"embed\"; remove it");
  EXPECT_EQ(
      errors_of_coupling("kind = \"spring\"\nbody = \"beam\"\nwhere = \"all\"\nto = \"bone\"\npoint = [0, 0, 0]\n"
                         "stiffness = 1\n"),
      "a.toml:18:6: couplings.c.to: is not used by kind = \"spring\": springs to another body are not supported yet; "
      "remove it");
}

TEST(CouplingErrors, Bodies) {
  EXPECT_EQ(errors_of_coupling("kind = \"weld\"\nbody = \"baem\"\nwhere = \"all\"\nto = \"boen\"\n"),
            "a.toml:16:8: couplings.c.body: \"baem\" is no known body; did you mean \"beam\"?\n"
            "a.toml:18:6: couplings.c.to: \"boen\" is no known body; did you mean \"bone\"?");
  EXPECT_EQ(errors_of_coupling("kind = \"weld\"\nbody = \"beam\"\nwhere = \"all\"\nto = \"beam\"\n"),
            "a.toml:18:6: couplings.c.to: is the body itself; must be another one");
  EXPECT_EQ(errors_of_coupling("kind = \"weld\"\nbody = \"beam\"\nwhere = \"all\"\nto = \"x\"\n"),
            "a.toml:18:6: couplings.c.to: \"x\" is no known body; must be \"bone\"");
}

TEST(CouplingErrors, Names) {
  const std::string weld = "kind = \"weld\"\nbody = \"beam\"\nwhere = \"all\"\nto = \"bone\"\n";
  EXPECT_EQ(errors_of_coupling(weld, "bone"),
            "a.toml:14:1: couplings.bone: is the name of a body too, and results list both together; must be another "
            "name");
  EXPECT_EQ(errors_of_coupling(weld, "\"a/b\""),
            "a.toml:14:12: couplings.\"a/b\": \"a/b\" cannot name a file; use up to 100 letters, digits, _ and -");
}

TEST(CouplingErrors, Values) {
  const auto spring = [](const std::string& more) {
    return errors_of_coupling("kind = \"spring\"\nbody = \"beam\"\nwhere = \"all\"\n" + more);
  };
  EXPECT_EQ(spring("point = [0, 0]\nstiffness = 0\ndirection = [0, 0, 0]\n"),
            "a.toml:18:9: couplings.c.point: a list of 2 is of the wrong length; must be a list of 3, each a length in "
            "m\n"
            "a.toml:19:13: couplings.c.stiffness: 0 is out of range; must be above 0\n"
            "a.toml:20:13: couplings.c.direction: has no direction; must be a vector of a length other than 0");
  EXPECT_EQ(spring("point = [0, 0, 0]\nstiffness = \"2 N\"\n"),
            "a.toml:19:13: couplings.c.stiffness: \"2 N\" is a force; must be a force per length in N/m, such as "
            "\"5 N/mm\"");
  EXPECT_EQ(spring("point = [0, 0, 0]\nstiffness = inf\n"),
            "a.toml:19:13: couplings.c.stiffness: inf is not finite; must be a force per length in N/m above 0");
  EXPECT_EQ(spring("point = [0, 0, 0]\nstiffnes = 1\n"),
            "a.toml:14:1: couplings.c.stiffness: is missing for kind = \"spring\"; must be a force per length in N/m "
            "above 0\n"
            "a.toml:19:1: couplings.c.stiffnes: is no known key; did you mean \"stiffness\"?");
  EXPECT_EQ(test::errors_of("couplings = 3\n" + std::string(test::beam)),
            "a.toml:1:13: couplings: 3 is of the wrong type; must be tables with names");
}

}  // namespace
}  // namespace fascia::app::couplings_errors_test
