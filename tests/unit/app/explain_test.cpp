#include "app/explain/body_motion.hpp"
#include "app/explain/changes.hpp"
#include "app/explain/profile.hpp"
#include "app/explain/promise.hpp"
#include "app/explain/report.hpp"
#include "app/explain/suggestions.hpp"
#include "app/reader/parse.hpp"
#include "assembly/build/build_simulation.hpp"
#include "core/math/rotation.hpp"
#include "io/result_writer.hpp"
#include "tests/support/paths.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

namespace fascia::explain_test {
namespace {

using namespace fascia::app;

const std::string kScene = R"(
[materials]
gel = { law = "neo-hookean", young = 1e4, poisson = 0.3, damping = { mass = 1 }, viscosity = [{ share = 0.5, time = 1 }], relax = "shear" }
[bodies.base]
model = "hexahedra"
order = 2
domain = { box = { min = [0, 0, 0], max = [1, 1, 1], cells = [4, 4, 4] } }
density = 1000
material = "gel"
[bodies.stone]
model = "tetrahedra"
domain = { box = { min = [0, 0, 1], max = [1, 1, 2], cells = [2, 2, 2], split = 5 } }
density = 1000
material = { young = 1e9, poisson = 0.3 }
[[constraints]]
body = "stone"
where = { nearest = [0, 0, 2] }
fix = ["x"]
[[constraints]]
body = "base"
where = { box = { min = [-1, -1, -1], max = [2, 2, 0.01] } }
fix = "all"
[[constraints]]
body = "stone"
where = { nearest = [1, 0, 2] }
fix = ["y"]
[couplings.glue]
kind = "embed"
body = "stone"
where = { box = { min = [-1, -1, -1], max = [2, 2, 1.01] } }
to = "base"
[solver]
kind = "newmark"
time_step = 0.01
steps = 4
newton = { tolerance = 1e-6 }
[probes.top]
body = "stone"
at = [0.5, 0.5, 2]
quantity = "displacement"
[probes.stress]
body = "stone"
at = [0.5, 0.5, 1.5]
quantity = "stress"
)";

Scene scene_of(const std::string& text) { return parse_scene_text(text, "scene.toml", {}); }

const Variant* find(const std::vector<Variant>& all, VariantKind kind, const std::string& part) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Variant& v) { return v.kind == kind && v.part == part; });
  return found == all.end() ? nullptr : &*found;
}

/// The scene with a variant's changes.
Scene carried_out(const Variant& v) { return parse_scene_text(kScene, "scene.toml", v.overrides); }

TEST(Variants, LeaveABodyOutWithAllThatActsOnItAlone) {
  const Scene scene = scene_of(kScene);
  const std::vector<Variant> stone = body_variants(scene, scene.bodies[1], {});
  const Variant* without = find(stone, VariantKind::left_out, "bodies.stone");
  ASSERT_TRUE(without);
  EXPECT_EQ(without->refused, "");
  const Scene left = carried_out(*without);
  ASSERT_EQ(left.bodies.size(), 1u);
  ASSERT_EQ(left.constraints.size(), 1u);
  EXPECT_EQ(left.constraints[0].body, "base");
  EXPECT_TRUE(left.couplings.empty());
  EXPECT_TRUE(left.probes.empty());
  const std::vector<Variant> base = body_variants(scene, scene.bodies[0], {});
  EXPECT_EQ(find(base, VariantKind::left_out, "bodies.base")->refused, "`couplings.glue` ties `bodies.stone` to it");
}

TEST(Variants, ARigidBodyKeepsItsPlaceAndLosesItsMatter) {
  const Scene scene = scene_of(kScene);
  const std::vector<Variant> stone = body_variants(scene, scene.bodies[1], {});
  const Scene rigid = carried_out(*find(stone, VariantKind::rigid, "bodies.stone"));
  EXPECT_EQ(rigid.bodies[1].model, BodyModel::rigid);
  EXPECT_EQ(rigid.bodies[1].cells->count, (std::vector<int>{2, 2, 2}));
  ASSERT_EQ(rigid.probes.size(), 1u);  // it has no stress
  EXPECT_EQ(rigid.probes[0].name, "top");
}

TEST(Variants, AShellKeepsItsMassAsRigid) {
  const Scene scene = scene_of(R"(
[bodies.ball]
model = "shell"
domain = { sphere = { center = [0, 0, 0], radius = 1, cells = [8] } }
thickness = 0.01
density = 1000
material = { young = 1e6, poisson = 0.3 }
[solver]
kind = "modes"
[probes.f]
quantity = "frequency"
)");
  RunFacts facts;
  facts.body_mass["ball"] = 125.5;
  const std::vector<Variant> ball = body_variants(scene, scene.bodies[0], facts);
  EXPECT_FALSE(find(ball, VariantKind::left_out, "bodies.ball"));  // the only one
  const Variant* rigid = find(ball, VariantKind::rigid, "bodies.ball");
  EXPECT_NE(std::find(rigid->overrides.begin(), rigid->overrides.end(), "bodies.ball.mass=125.5"),
            rigid->overrides.end());
}

TEST(Variants, FormulationsBringALawThatTheyTake) {
  const Scene scene = scene_of(kScene);
  const std::vector<Variant> base = body_variants(scene, scene.bodies[0], {});
  int formulations = 0;
  for (const Variant& v : base) {
    if (v.kind != VariantKind::formulation) continue;
    ++formulations;
    const Scene changed = carried_out(v);
    EXPECT_NE(changed.bodies[0].formulation, Formulation::large_strain);
    EXPECT_EQ(changed.bodies[0].materials[0].material.law, Law::st_venant_kirchhoff);
    EXPECT_NEAR(changed.bodies[0].materials[0].material.young(), 1e4, 1e-8);
    EXPECT_EQ(changed.bodies[0].materials[0].material.mass_damping, 1);
    EXPECT_FALSE(v.closer);
  }
  EXPECT_EQ(formulations, 2);
  EXPECT_EQ(carried_out(*find(base, VariantKind::order, "bodies.base.order")).bodies[0].order, 1);
}

TEST(Variants, OfMaterialsAndTheSolver) {
  const Scene scene = scene_of(kScene);
  const std::vector<Variant> materials = material_variants(scene);
  ASSERT_EQ(materials.size(), 3u);
  EXPECT_EQ(carried_out(*find(materials, VariantKind::viscosity, "materials.gel.viscosity"))
                .bodies[0]
                .materials[0]
                .material.viscosity,
            nullptr);
  EXPECT_EQ(carried_out(*find(materials, VariantKind::damping, "materials.gel.damping"))
                .bodies[0]
                .materials[0]
                .material.mass_damping,
            0);
  EXPECT_EQ(carried_out(*find(materials, VariantKind::law, "materials.gel.law")).bodies[0].materials[0].material.law,
            Law::st_venant_kirchhoff);
  RunFacts facts;
  facts.processors = 4;
  const std::vector<Variant> solver = solver_variants(scene, facts);
  for (const Variant& v : solver) EXPECT_EQ(v.refused, "") << v.part;
  EXPECT_FALSE(find(solver, VariantKind::linear_tolerance, "solver.linear.tolerance"));  // a factorisation has none
  EXPECT_EQ(carried_out(*find(solver, VariantKind::linear_solver, "solver.linear.kind")).solver.linear,
            LinearMethod::cg);
  EXPECT_EQ(carried_out(*find(solver, VariantKind::time_step, "solver.time_step")).solver.time_step, 0.02);
  EXPECT_EQ(find(solver, VariantKind::threads, "solver.threads")->overrides[0], "solver.threads=0");
  int looser = 0, tighter = 0;
  for (const Variant& v : solver)
    if (v.kind == VariantKind::newton_tolerance) ++(v.closer ? tighter : looser);
  EXPECT_EQ(looser, 1);
  EXPECT_EQ(tighter, 1);
}

TEST(Ratios, AreThoseOfNeighbours) {
  const Ratio turns = ratio_of_pairs({2, 1, 3}, {4, 4, 4});
  EXPECT_EQ(turns.median, 0.5);
  EXPECT_EQ(turns.low, 0.25);
  EXPECT_EQ(turns.high, 0.75);
  EXPECT_TRUE(turns.is_less());
  EXPECT_FALSE(ratio_of_pairs({2, 4}, {4, 4}).is_less());
  EXPECT_EQ(ratio_of_pairs({1, 2}, {0, 0}).median, 1);  // a time of 0 says nothing
}

TEST(Ratios, OfOneRunAreAsUncertainAsTheSceneAsItIs) {
  const Ratio wide = widened({0.5, 0.5, 0.5}, {2, 1, 3});
  EXPECT_EQ(wide.median, 0.5);
  EXPECT_EQ(wide.low, 0.25);
  EXPECT_EQ(wide.high, 0.75);
  EXPECT_EQ(widened({0.5, 0.5, 0.5}, {0, 0, 0}).high, 0.5);  // no times, no spread
}

/// A part that was run, with a ratio of times and the change of one probe.
Part ran(Variant variant, double ratio, std::optional<double> change) {
  Part part;
  part.variant = std::move(variant);
  part.record.emplace();
  part.record->status = "converged";
  part.solve = {ratio, ratio - 0.02, ratio + 0.02};
  part.changes = {{"top", change}};
  return part;
}

Explanation explanation_of(std::vector<Part> parts) {
  Explanation e;
  e.scene = scene_of(kScene);
  e.base.status = "converged";
  BodyProfile stone;
  stone.name = "stone";
  stone.motion.emplace();
  stone.motion->rotation = 0.03;
  stone.motion->strain = 0.0083;
  e.bodies = {stone};
  e.parts = std::move(parts);
  return e;
}

Variant rigid_stone() {
  Variant v;
  v.kind = VariantKind::rigid;
  v.part = "bodies.stone";
  v.body = "stone";
  v.change = "as `model = \"rigid\"`";
  v.overrides = {"bodies.stone.model=\"rigid\""};
  return v;
}

Variant tolerance(bool closer) {
  Variant v;
  v.kind = VariantKind::newton_tolerance;
  v.part = "solver.newton.tolerance";
  v.change = "with `solver.newton.tolerance = 1e-05`";
  v.overrides = {"solver.newton.tolerance=1e-05"};
  v.closer = closer;
  return v;
}

TEST(Suggestions, AreInTheScenesWordsAndSortedByGain) {
  Explanation e = explanation_of({ran(tolerance(false), 0.9, 1e-7), ran(rigid_stone(), 0.69, 2e-4)});
  const std::vector<Part*> parts = worth_suggesting(e);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0]->variant.kind, VariantKind::rigid);
  EXPECT_EQ(suggestion_of(e, *parts[0], {0.69, 0.67, 0.72}).text,
            "`bodies.stone` stays below 2° and 0.9 % strain: as `model = \"rigid\"` the step is 31 % shorter (28 to 33 "
            "%), and probe `top` changes most, by 0.02 %.");
  EXPECT_EQ(suggestion_of(e, *parts[1], {0.9, 0.9, 0.9}).text,
            "With `solver.newton.tolerance = 1e-05` the step is 10 % shorter (10 to 10 %), and probe `top` changes "
            "most, by 1.0e-07.");
}

TEST(Promise, PutsWhatMayGainWithoutHarmFirst) {
  Explanation e = explanation_of(
      {ran(tolerance(true), 1, 0), ran(rigid_stone(), 1, 0), ran(tolerance(false), 1, 0), ran(rigid_stone(), 1, 0)});
  e.bodies[0].points = 10;
  e.bodies[0].motion->displacement = 1;
  e.bodies[0].motion->deformation = 0.5;
  e.parts[3].variant.refused = "no valid scene";
  estimate(e);
  EXPECT_EQ(e.parts[1].estimated_gain, 1);
  EXPECT_EQ(*e.parts[1].estimated_change, 0.5);
  const std::vector<Part*> order = by_promise(e);
  EXPECT_EQ(order, (std::vector<Part*>{&e.parts[2], &e.parts[1], &e.parts[0]}));
}

TEST(Suggestions, LeaveOutWhatChangesProbesOrGainsNothing) {
  const auto none = [](Part part) {
    Explanation e = explanation_of({std::move(part)});
    return worth_suggesting(e).empty();
  };
  EXPECT_FALSE(none(ran(rigid_stone(), 0.8, 0.009)));
  EXPECT_TRUE(none(ran(rigid_stone(), 0.8, 0.011)));
  EXPECT_TRUE(none(ran(rigid_stone(), 0.8, std::nullopt)));  // the probe is gone
  EXPECT_TRUE(none(ran(rigid_stone(), 0.995, 0)));           // not worth a line in a scene
  EXPECT_FALSE(none(ran(rigid_stone(), 0.985, 0)));          // to be measured in turns: it may be
  const Explanation e = explanation_of({});
  EXPECT_FALSE(is_worth(e, ran(rigid_stone(), 0.985, 0)));  // chance
  EXPECT_TRUE(is_worth(e, ran(rigid_stone(), 0.9, 0)));
  EXPECT_TRUE(none(ran(tolerance(true), 0.8, 0)));  // answers closer: it is no simplification
  Part failed = ran(rigid_stone(), 0.5, 0);
  failed.record->status = "diverged";
  EXPECT_TRUE(none(std::move(failed)));
}

TEST(BodyMotion, TellsARigidTurnFromStrain) {
  std::string folder = (std::filesystem::temp_directory_path() / "fascia test XXXXXX").string();
  ASSERT_NE(mkdtemp(folder.data()), nullptr);
  const std::filesystem::path path = folder;
  const Mat3d R = rotation_about(normalized(Vec3d{{1, 2, -1}}), 0.7);
  const std::vector<Vec3d> solid{{{0, 0, 0}}, {{1, 0, 0}}, {{0, 2, 0}}, {{0, 0, 3}}, {{1, 1, 1}}};
  const std::vector<Vec3d> line{{{0, 0, 0}}, {{1, 0, 0}}, {{2, 0, 0}}};
  io::Collection collection(path / "run.pvd");
  const auto save = [&](double time, const std::string& body, const std::vector<Vec3d>& rest, const auto& moved) {
    io::VisualMesh mesh;
    io::FieldArray places{"rest_position", 3, {}}, strain{"strain", 9, {}};
    for (const Vec3d& X : rest) {
      mesh.points.push_back(moved(X));
      mesh.vertices.push_back(static_cast<int>(mesh.vertices.size()));
      mesh.part.push_back(1);
      places.values.insert(places.values.end(), X.v, X.v + 3);
      for (int i = 0; i < 9; ++i) strain.values.push_back(i == 1 || i == 3 ? 0.02 * time : 0);
    }
    mesh.point_fields = {places, strain};
    const std::string file = body + std::to_string(static_cast<int>(time)) + ".vtu";
    io::write_vtu(path / file, mesh);
    collection.add(time, body, file);
  };
  for (const double time : {0.0, 1.0}) {
    save(time, "solid", solid, [&](const Vec3d& X) { return time > 0 ? R * X + Vec3d{{5, 0, 0}} : X; });
    save(time, "line", line, [&](const Vec3d& X) { return X * (1 + 0.5 * time); });
  }
  const std::map<std::string, BodyMotion> motions = body_motions(path / "run.pvd");
  const double rounding = 1e-12;
  EXPECT_NEAR(motions.at("solid").rotation, 0.7, rounding);
  EXPECT_NEAR(motions.at("solid").deformation, 0, rounding);
  EXPECT_NEAR(*motions.at("solid").strain, 0.02, rounding);  // a shear of 0.02 in one plane has this principal value
  EXPECT_NEAR(motions.at("line").rotation, 0, rounding);     // its own axis is open: the smallest turn
  EXPECT_NEAR(motions.at("line").deformation, 0.5, rounding);
  EXPECT_NEAR(motions.at("line").displacement, 1, rounding);
  std::filesystem::remove_all(path);
}

TEST(Profile, SharesSumToTheWhole) {
  const std::filesystem::path scene = test::source_dir() / "scenes" / "five_tissues.toml";
  const Simulation s = build_simulation(parse_scene_file(scene, {}));
  const std::vector<BodyProfile> bodies = profile_of(s);
  int unknowns = 0;
  for (const BodyProfile& b : bodies) unknowns += b.unknowns;
  EXPECT_EQ(unknowns, s.model.free_dof_count());
  EXPECT_EQ(bodies.size(), 11u);
}

}  // namespace
}  // namespace fascia::explain_test
