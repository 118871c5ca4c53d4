#include "app/reader/readers.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fascia::app {
namespace {

/// The keys of a need. @param probes  of the scene  @param folder  that paths begin in
std::optional<StatedNeed> read_one(const TableReader& table, const std::vector<Probe>& probes,
                                   const std::filesystem::path& folder) {
  if (!table.exists()) return std::nullopt;
  StatedNeed need;
  need.place = table.place();
  need.error = table.number("error");
  need.probe = table.text("probe");
  need.step = table.number("step");
  need.memory = table.number("memory");
  if (const auto study = table.text("study")) need.study = (folder / *study).lexically_normal();
  if (!need.probe) return need;
  std::vector<std::string> known;
  known.reserve(probes.size());
  for (const Probe& probe : probes) known.push_back(probe.name);
  if (std::find(known.begin(), known.end(), *need.probe) == known.end())
    table.error("probe", known.empty() ? fmt::format("{} is no probe, as the scene has none; remove it, or add "
                                                     "[probes.{}]",
                                                     in_quotes(*need.probe), *need.probe)
                                       : unknown_name("probe", *need.probe, known));
  if (!table.has("error")) table.error("error", "is missing beside probe; must be a part, as \"1 %\"");
  return need;
}

/// What a need asks for that its scene cannot have.
void check_kind(const TableReader& table, const TableReader& need, const Scene& scene) {
  const Solver& solver = scene.solver;
  if (scene.need && need.has("step") && !is_dynamic(solver.kind))
    need.error("step", fmt::format("is a time of steps, and solver.kind = \"{}\" takes none; remove it, or ask for "
                                   "dynamics",
                                   table.table("solver").text("kind").value_or("static")));
  if (solver.kind == SolverKind::modes)
    need.error("cannot be stated with solver.kind = \"modes\" yet; say frames and cells, and use output.estimate");
  if (solver.control != StaticControl::load)
    need.error(
        "cannot be stated where a path is followed; say frames and cells, and use control = \"load\" or "
        "output.estimate");
  if (scene.need && !need.has("error") && !need.has("step") && !need.has("probe"))
    need.error("error or step is missing; give one at least");
}

/// Something of a body is left to be chosen.
bool leaves_open(const TableReader& table, const Body& body) {
  if (body.open) return true;
  if (is_mesh_model(body) && !table.has("order") && body.locking != Locking::f_bar) return true;
  if (body.model == BodyModel::meshless) return !table.table("frames").has("kind");
  const TableReader domain = table.table("domain");
  return !is_carrier(body) && domain.has("file") && !domain.has("refine");
}

/// Something of the scene is.
bool leaves_open(const TableReader& table, const Scene& scene) {
  const std::vector<TableReader> bodies = table.tables("bodies");
  bool open = scene.solver.step_open || scene.solver.scheme_open;
  for (std::size_t b = 0; b < bodies.size() && !open; ++b) open = leaves_open(bodies[b], scene.bodies[b]);
  return open;
}

}  // namespace

const char* const kNeedWouldChoose = "; or state what the results must be worth in [need], which then chooses it";

bool states_need(const TableReader& scene) {
  if (scene.has("need")) return true;
  const std::vector<TableReader> bodies = scene.tables("bodies");
  return std::any_of(bodies.begin(), bodies.end(), [](const TableReader& body) { return body.has("need"); });
}

void read_need(const TableReader& table, Scene& scene) {
  const std::filesystem::path folder = scene.path.parent_path();
  scene.need = read_one(table.table("need"), scene.probes, folder);
  for (const TableReader& body : table.tables("bodies")) {
    const auto found =
        std::find_if(scene.bodies.begin(), scene.bodies.end(), [&](const Body& b) { return b.name == body.name(); });
    const TableReader need = body.table("need");
    if (found == scene.bodies.end() || !need.exists()) continue;
    found->need = read_one(need, scene.probes, folder);
    if (scene.need && scene.need->study)
      need.error("cannot stand beside need.study, which has measures of its own; remove one of them");
    if (is_carrier(*found))
      need.error(
          fmt::format("has nothing to choose, as model = \"{}\" has no field of its own; remove it, or name its "
                      "probe in [need]",
                      word(found->model)));
  }
  if (!scene.states_need()) return;
  const bool top = table.has("need");
  const auto with_need = std::find_if(scene.bodies.begin(), scene.bodies.end(), [](const Body& b) { return !!b.need; });
  const TableReader bodies = table.table("bodies");
  const TableReader need = top ? table.table("need") : bodies.table(with_need->name).table("need");
  check_kind(table, need, scene);
  const bool readable = scene.bodies.size() == table.tables("bodies").size();  // else what is open is not known
  const bool by_study = scene.need && scene.need->study;                       // it may have varied anything
  if (readable && !by_study && table.diagnostics().empty() && !leaves_open(table, scene))
    need.error(
        "leaves nothing to choose, as the scene says frames, cells, orders and steps itself; remove some of "
        "them, or remove the need and ask for output.estimate");
}

}  // namespace fascia::app
