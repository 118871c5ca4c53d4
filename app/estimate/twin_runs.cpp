#include "app/estimate/twin_runs.hpp"

#include "app/study/child_run.hpp"
#include "core/base/errors.hpp"
#include "io/files.hpp"
#include "io/result_directory.hpp"

#include <fmt/format.h>

#include <system_error>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

/// Removes a folder where this ends, however it ends.
class Folder {
 public:
  explicit Folder(fs::path path) : path_(std::move(path)) { io::make_directories(path_); }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// What the scene's own run needs and a twin does not.
std::vector<std::string> without_pictures(const Scene& scene) {
  std::vector<std::string> changes{"output.estimate=false", "output.fields=[\"displacement\"]"};
  if (scene.says("output.picture")) changes.emplace_back("output.picture=");
  return changes;
}

}  // namespace

TwinRuns::TwinRuns(const Simulation& simulation, const EstimatePlan& plan, const FieldSamples* fields,
                   const fs::path& directory, const std::function<void(const std::string&)>& tell,
                   const std::function<bool()>& stop)
    : simulation_(simulation), fields_(fields) {
  const Folder folder(directory / io::kTwins);
  for (std::size_t i = 0; i < plan.twins.size() && !stopped_; ++i) {
    const PlannedTwin& twin = plan.twins[i];
    std::string changes;
    for (const std::string& change : twin.twin.changes) changes += (changes.empty() ? "" : "; ") + change;
    tell(fmt::format("estimate: run {} of {}, {}: {}", i + 1, plan.twins.size(), twin.name, changes));
    run(twin, folder.path(), stop);
    stopped_ = stop();
  }
}

void TwinRuns::run(const PlannedTwin& twin, const fs::path& folder, const std::function<bool()>& stop) {
  ChildRun child;
  child.scene = simulation_.scene.path;
  child.overrides = simulation_.scene.overrides;
  child.output = folder / std::to_string(runs_.size());
  const auto append = [&](const std::vector<std::string>& changes) {
    child.overrides.insert(child.overrides.end(), changes.begin(), changes.end());
  };
  append(without_pictures(simulation_.scene));
  append(twin.twin.overrides);
  const std::vector<std::string> without_fields = child.overrides;
  const std::size_t bodies = fields_ ? fields_->size() : 0;
  for (std::size_t b = 0; b < bodies; ++b) child.overrides.push_back(fields_->override_for(b));
  ChildResult result = run_child(child, stop);
  bool has_fields = true;
  if (bodies > 0 && result.exit_status == 2 && !stop()) {  // a place that is not on the twin's body
    child.overrides = without_fields;
    has_fields = false;
    const std::string why = result.message;
    result = run_child(child, stop);
    if (result.exit_status == 0)
      failures_.push_back(fmt::format("the displacements of bodies were not compared with {}: {}", twin.name, why));
  }
  nlohmann::ordered_json told{{"twin", twin.name},
                              {"changes", twin.twin.changes},
                              {"overrides", twin.twin.overrides},
                              {"status", result.status()},
                              {"seconds", result.seconds}};
  if (result.summary.is_object()) told["dofs"] = result.summary.value("dofs", 0);
  runs_.push_back(std::move(told));
  if (stop()) return;
  if (result.exit_status != 0) {
    failures_.push_back(fmt::format("{} gives nothing ({}): {}", twin.name, result.status(), result.message));
    return;
  }
  try {
    outcomes_.insert_or_assign(twin.role, Outcome{ProbeTable(child.output), has_fields});
  } catch (const std::runtime_error& e) {
    failures_.push_back(fmt::format("{} gives nothing: {}", twin.name, e.what()));
  }
}

std::optional<Series> TwinRuns::probe(TwinRole role, const std::string& name) const {
  const auto found = outcomes_.find(role);
  if (found == outcomes_.end()) return std::nullopt;
  return found->second.probes.series(name, simulation_.scene.solver.kind);
}

std::optional<Series> TwinRuns::field(TwinRole role, std::size_t body) const {
  const auto found = outcomes_.find(role);
  if (found == outcomes_.end() || !found->second.has_fields) return std::nullopt;
  return fields_->weighted(body, found->second.probes.series(fields_->probe(body), simulation_.scene.solver.kind));
}

}  // namespace fascia::app
