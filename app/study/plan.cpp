#include "app/study/plan.hpp"

#include "app/estimate/resolution.hpp"
#include "app/machine.hpp"
#include "app/reader/parse.hpp"
#include "app/results/probes.hpp"
#include "app/results/provenance.hpp"
#include "app/scene/diagnostics.hpp"
#include "app/scene/units.hpp"
#include "app/study/alternatives.hpp"
#include "core/base/errors.hpp"
#include "io/digest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace fascia::app {
namespace {

/// A study of more runs than this is a slip of the pen.
constexpr std::size_t kMostRuns = 100'000;

/// What two results must share to be equal: scene, files that it reads, changes, program.
std::string key_of(const Scene& scene) {
  const Machine machine = this_machine();
  std::string text = fmt::format("{} {} {} {}\n{}\n", machine.fascia, machine.commit, machine.compiler, machine.flags,
                                 io::sha256(scene.text));
  for (const std::string& change : scene.overrides) text += change + "\n";
  for (const std::filesystem::path& file : input_files(scene)) text += io::sha256_of(file) + "\n";
  return io::sha256(text).substr(0, 12);
}

/// Changes of one axis value, which may depend on those made before.
void add_changes(const Study& study, const StudyAxis& axis, const AxisValue& value,
                 std::vector<std::string>& overrides) {
  std::vector<std::string> more = value.overrides;
  if (!value.model.empty()) more = model_alternative(study.base, overrides, axis.body, value.model);
  if (value.refine != 1)
    more = resized(parse_scene_file(study.base, overrides), value.refine,
                   axis.body.empty() ? std::nullopt : std::optional(axis.body))
               .overrides;
  overrides.insert(overrides.end(), more.begin(), more.end());
}

/// Models come first, then keys, then sizes: a later change may concern keys that an earlier one makes.
int rank(const AxisValue& value) { return !value.model.empty() ? 0 : value.refine == 1 ? 1 : 2; }

PlannedRun plan_run(const Study& study, std::vector<std::size_t> at) {
  PlannedRun run;
  run.at = std::move(at);
  run.overrides = study.overrides;
  try {
    for (const int wanted : {0, 1, 2})
      for (std::size_t a = 0; a < study.axes.size(); ++a) {
        const AxisValue& value = study.axes[a].values[run.at[a]];
        if (rank(value) == wanted) add_changes(study, study.axes[a], value, run.overrides);
      }
    Scene scene = parse_scene_file(study.base, run.overrides);
    if (scene.output.picture) {
      run.overrides.emplace_back("output.picture=");
      scene = parse_scene_file(study.base, run.overrides);
    }
    run.key = key_of(scene);
    run.simulation = simulation_digest(scene);
    run.directory = "runs/" + run.key;
  } catch (const SceneError& e) {
    run.refused = e.diagnostics().front().text();
  } catch (const InputError& e) {
    run.refused = e.what();
  }
  return run;
}

/// Values with units become SI, in the unit of the probe. @return what is wrong, "" otherwise
std::string resolve(StudyReference& reference, Quantity quantity) {
  for (std::size_t i = 0; i < reference.quantities.size(); ++i) {
    if (reference.quantities[i].empty()) continue;
    const auto result = parse_quantity(reference.quantities[i], probe_unit(quantity));
    if (const auto* error = std::get_if<UnitError>(&result)) return error->message;
    reference.value[i] = std::get<double>(result);
  }
  return "";
}

/// Says what the base scene lacks for a field to be measured.
void check_field(const StudyMeasure& measure, const Scene& base, std::vector<Diagnostic>& wrong) {
  const auto add = [&](const char* key, std::string message) {
    Place place = measure.place;
    place.key += key;
    wrong.push_back({std::move(place), std::move(message)});
  };
  std::vector<std::string> bodies;
  for (const Body& body : base.bodies) bodies.push_back(body.name);
  if (!measure.body.empty() && std::find(bodies.begin(), bodies.end(), measure.body) == bodies.end())
    add(".body", unknown_name("body of " + base.path.string(), measure.body, bodies));
  const std::vector<std::string>& fields = base.output.fields;
  if (base.says("output.fields") && std::find(fields.begin(), fields.end(), measure.field) == fields.end())
    add(".field", fmt::format("{} is not among `output.fields` of {}, and not saved; add it there, or take the key "
                              "away with remove = [\"output.fields\"]",
                              in_quotes(measure.field), base.path.string()));
}

void check_measures(Study& study, const Scene& base) {
  std::vector<std::string> known;
  for (const Probe& probe : base.probes) known.push_back(probe.name);
  std::vector<Diagnostic> wrong;
  for (StudyMeasure& measure : study.measures) {
    if (!measure.field.empty()) {
      check_field(measure, base, wrong);
      continue;
    }
    const auto found = std::find(known.begin(), known.end(), measure.probe);
    Place place = measure.place;
    if (found == known.end()) {
      if (place.file != "--measure") place.key += ".probe";
      wrong.push_back({std::move(place), unknown_name("probe of " + study.base.string(), measure.probe, known)});
      continue;
    }
    const Quantity quantity = base.probes[static_cast<std::size_t>(found - known.begin())].quantity;
    if (const std::string error = resolve(measure.reference, quantity); !error.empty()) {
      place = measure.reference.place;
      place.key += ".value";
      wrong.push_back({std::move(place), error});
    }
  }
  if (!wrong.empty()) throw SceneError(std::move(wrong));
}

}  // namespace

std::vector<PlannedRun> plan_study(Study& study) {
  check_measures(study, parse_scene_file(study.base, study.overrides));
  std::size_t count = 1;
  const bool paired = study.mode == StudyMode::paired;
  for (const StudyAxis& axis : study.axes) {
    count = paired ? axis.values.size() : count * axis.values.size();
    if (count > kMostRuns)
      throw InputError(fmt::format("{}: has more than {} combinations; leave out values, or use mode = \"paired\"",
                                   study.path.string(), kMostRuns));
  }
  std::vector<PlannedRun> runs;
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<std::size_t> at(study.axes.size(), i);
    std::size_t rest = i;
    for (std::size_t a = study.axes.size(); a-- > 0 && !paired;) {
      at[a] = rest % study.axes[a].values.size();
      rest /= study.axes[a].values.size();
    }
    runs.push_back(plan_run(study, std::move(at)));
  }
  if (std::all_of(runs.begin(), runs.end(), [](const PlannedRun& r) { return !r.refused.empty(); }))
    throw InputError(fmt::format("{}: none of the {} combinations is a valid scene; the first: {}", study.path.string(),
                                 runs.size(), runs.front().refused));
  return runs;
}

PlannedRun plan_reference(const Study& study, const StudyMeasure& measure, std::optional<std::size_t> group) {
  const StudyReference& reference = measure.reference;
  const std::filesystem::path& path = reference.scene.empty() ? study.base : reference.scene;
  PlannedRun run;
  if (reference.scene.empty()) run.overrides = study.overrides;
  if (group) {
    const StudyAxis& axis = study.axes[*measure.per];
    add_changes(study, axis, axis.values[*group], run.overrides);
  }
  run.overrides.insert(run.overrides.end(), reference.overrides.begin(), reference.overrides.end());
  Scene scene = parse_scene_file(path, run.overrides);
  if (scene.output.picture) {
    run.overrides.emplace_back("output.picture=");
    scene = parse_scene_file(path, run.overrides);
  }
  run.key = key_of(scene);
  run.directory = "runs/" + run.key;
  return run;
}

}  // namespace fascia::app
