#include "app/estimate/resolution.hpp"
#include "app/explain/variants.hpp"
#include "app/reader/parse.hpp"
#include "app/scene/laws.hpp"
#include "app/scene/toml_text.hpp"
#include "assembly/specification/errors.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

namespace fascia::app {
namespace {

Variant of_solver(VariantKind kind, const std::string& key, const std::string& value, bool closer = false) {
  const std::string part = "solver." + key;
  return {kind, part, fmt::format("with `{} = {}`", part, value), "", {part + "=" + value}, "", closer, 1};
}

void add_tolerances(VariantKind kind, const std::string& key, double tolerance, std::vector<Variant>& found) {
  if (tolerance * 10 < 1) found.push_back(of_solver(kind, key, fmt::format("{:g}", tolerance * 10)));
  found.push_back(of_solver(kind, key, fmt::format("{:g}", tolerance / 10), true));
}

/// A material and where the scene says its keys: [materials.NAME], bodies.NAME.material, bodies.NAME.material[0].use.
struct SaidMaterial {
  std::string path;
  const Material* material = nullptr;
};

std::vector<SaidMaterial> materials_of(const Scene& scene) {
  std::vector<SaidMaterial> found;
  for (const Body& body : scene.bodies)
    for (std::size_t i = 0; i < body.materials.size(); ++i) {
      const Material& material = body.materials[i].material;
      const std::string of_body = "bodies." + toml_key(body.name) + ".material";
      const std::string listed = fmt::format("{}[{}].use", of_body, i);
      const std::string path = !material.name.empty() ? "materials." + toml_key(material.name)
                               : scene.says(listed)   ? listed
                                                      : of_body;
      if (std::none_of(found.begin(), found.end(), [&](const SaidMaterial& m) { return m.path == path; }))
        found.push_back({path, &material});
    }
  return found;
}

}  // namespace

std::vector<Variant> material_variants(const Scene& scene) {
  std::vector<Variant> found;
  const auto add = [&](VariantKind kind, const std::string& key, const std::string& label, const std::string& change) {
    found.push_back({kind, key, label, "", {change}, "", false, 1});
  };
  for (const auto& [path, material] : materials_of(scene)) {
    const std::string damping = path + ".damping";
    const bool damped = material->mass_damping > 0 || material->stiffness_damping > 0;
    if (is_dynamic(scene.solver.kind) && damped)
      add(VariantKind::damping, damping, fmt::format("without `{}`", damping), damping + "=");
    if (material->viscosity && scene.solver.kind != SolverKind::modes) {
      const std::string viscosity = path + ".viscosity";
      add(VariantKind::viscosity, viscosity, fmt::format("without `{}`", viscosity), viscosity + "=");
      for (const char* beside : {".relax", ".statics"})  // which the scene may not say without it
        if (scene.says(path + beside)) found.back().overrides.push_back(path + beside + "=");
    }
    if (!needs_large_strain(material->law)) continue;
    add(VariantKind::law, path + ".law", fmt::format("with `{}.law = \"st-venant-kirchhoff\"`", path),
        path + ".law=\"st-venant-kirchhoff\"");
    std::vector<std::string>& changes = found.back().overrides;
    const LawWord& law = law_word(material->law);
    if (law.own.empty()) continue;  // else Young's modulus and Poisson's ratio in the place of what the law has
    for (const LawKey& key : law.own)
      if (scene.says(path + "." + key.name)) changes.push_back(fmt::format("{}.{}=", path, key.name));
    changes.push_back(path + ".bulk=");
    changes.push_back(fmt::format("{}.young={}", path, material->young()));
    changes.push_back(fmt::format("{}.poisson={}", path, material->poisson()));
  }
  return found;
}

std::vector<Variant> solver_variants(const Scene& scene, const RunFacts& facts) {
  std::vector<Variant> found;
  const Solver& solver = scene.solver;
  const bool newton = solver.kind == SolverKind::statics || is_implicit_dynamics(solver.kind);
  if (newton) {
    add_tolerances(VariantKind::newton_tolerance, "newton.tolerance", solver.newton_tolerance, found);
    if (facts.iterative)
      add_tolerances(VariantKind::linear_tolerance, "linear.tolerance", solver.linear_tolerance, found);
    Variant linear = of_solver(VariantKind::linear_solver, "linear.kind", facts.iterative ? "\"cholesky\"" : "\"cg\"");
    if (facts.iterative && scene.says("solver.linear.preconditioner"))
      linear.overrides.emplace_back("solver.linear.preconditioner=");
    found.push_back(std::move(linear));
    found.push_back(of_solver(VariantKind::tangent, "tangent", solver.full_tangent ? "\"material\"" : "\"full\""));
  }
  if (is_dynamic(solver.kind)) {
    const SceneTwin twin = with_time_step(scene, 2);
    Variant v = of_solver(VariantKind::time_step, "time_step", fmt::format("{:g}", 2 * solver.time_step));
    v.overrides = twin.overrides;
    if (!twin.complete()) v.refused = fmt::format("{}", fmt::join(twin.kept, "; "));
    found.push_back(std::move(v));
  }
  const bool on_gpu = facts.backend == "cuda";
  if (newton && (on_gpu || facts.iterative)) {
    for (const std::string precision : {"double", "mixed", "single"})
      if (solver.precision != precision && (on_gpu || precision != "single"))
        found.push_back(
            of_solver(VariantKind::precision, "precision", fmt::format("\"{}\"", precision), precision == "double"));
  }
  if (newton && on_gpu) found.push_back(of_solver(VariantKind::backend, "backend", "\"cpu\""));
  if (facts.threads > 1)
    found.push_back(of_solver(VariantKind::threads, "threads", "1"));
  else if (facts.processors > 1)
    found.push_back(of_solver(VariantKind::threads, "threads", "0"));
  return found;
}

std::vector<Variant> variants_of(const Scene& scene, const RunFacts& facts) {
  std::vector<Variant> found;
  const auto append = [&](std::vector<Variant> more) {
    found.insert(found.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  };
  for (const Body& body : scene.bodies) append(body_variants(scene, body, facts));
  for (const Coupling& c : scene.couplings) {
    const std::string part = "couplings." + toml_key(c.name);
    append({{VariantKind::coupling, part, fmt::format("without `{}`", part), "", {part + "="}, "", false, 1}});
  }
  append(material_variants(scene));
  append(solver_variants(scene, facts));
  for (Variant& v : found) {
    if (!v.refused.empty()) continue;
    std::vector<std::string> overrides = scene.overrides;
    overrides.insert(overrides.end(), v.overrides.begin(), v.overrides.end());
    try {
      parse_scene_file(scene.path, overrides);
    } catch (const SceneError& e) {
      v.refused = e.diagnostics().front().text();
    }
  }
  return found;
}

}  // namespace fascia::app
