#include "app/need/stored_study.hpp"

#include "app/machine.hpp"
#include "app/need/trials.hpp"
#include "app/reader/parse.hpp"
#include "app/reader/scene_tree.hpp"
#include "app/results/provenance.hpp"
#include "app/scene/toml_text.hpp"
#include "assembly/specification/errors.hpp"
#include "assembly/specification/readable.hpp"
#include "core/base/errors.hpp"
#include "io/files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Keys may differ between a scene and a run that serves it, as they change no result.
const std::vector<std::string> kBeside{"output", "probes", "silence"};

/// A scene fixes what it says, but for the model of a body: every body has to say one, so that it is no choice.
Value said_by(const Scene& scene) {
  Value tree = plain_tree(scene, {}, kBeside);
  if (Value* bodies = tree.find("bodies"); bodies && bodies->as_table())
    for (Member& body : *bodies->as_table())
      if (Table* keys = body.value.as_table()) std::erase_if(*keys, [](const Member& m) { return m.key == "model"; });
  return tree;
}

/// A dearer run is nearer to a need only where it is so much nearer: the same mesh solved otherwise is not.
constexpr double kClearlyLess = 0.99;

class Reader {
 public:
  explicit Reader(const Scene& scene)
      : scene_(scene), need_(*scene.need), said_(said_by(scene)), file_(*need_.study / "study.json"), json_(read()) {}

  StoredStudy study() try {
    find_measures();
    const Json& machine = json_.at("machine");
    const Machine here = this_machine();
    study_.same_machine = machine.at("cpu") == here.cpu && machine.at("threads") == here.threads;
    read_base();
    for (const Json& run : json_.at("runs")) add(run);
    if (study_.runs.empty()) fail(why_none());
    std::stable_sort(study_.runs.begin(), study_.runs.end(),
                     [](const StudiedRun& a, const StudiedRun& b) { return a.seconds < b.seconds; });
    return std::move(study_);
  } catch (const nlohmann::json::exception&) {
    fail(fmt::format("{} is not what fascia study of this version writes; make the study again", file_.string()));
  }

 private:
  [[noreturn]] void fail(const std::string& why) const { throw SceneError({{scene_.place_of("need.study"), why}}); }

  Json read() const {
    std::error_code none;
    if (!fs::exists(file_, none))
      fail(
          fmt::format("{} is no file; name the directory that fascia study wrote, or make it by fascia study STUDY "
                      "--output {}",
                      file_.string(), need_.study->string()));
    Json json;
    try {
      json = Json::parse(io::read_file(file_), nullptr, false);
    } catch (const std::runtime_error& e) {
      fail(e.what());
    }
    if (!json.is_object() || !json.contains("runs") || !json.contains("measures"))
      fail(fmt::format("{} holds no runs; call fascia study again, which goes on where it was", file_.string()));
    return json;
  }

  void find_measures() {
    std::vector<std::string> known, sources;
    for (const Json& question : json_.at("measures")) {
      const std::string measure = question.at("measure"), of = question.value("probe", measure);
      known.push_back(in_quotes(of));
      if (need_.probe && of != *need_.probe) continue;
      const Json& reference = question.at("reference");
      if (!reference.contains("uncertainty")) continue;
      if (!uncertainty_.contains(measure)) study_.measures += (uncertainty_.empty() ? "" : ", ") + in_quotes(measure);
      double& uncertainty = uncertainty_[measure];
      uncertainty = std::max(uncertainty, reference.at("uncertainty").get<double>());
      const std::string source = reference.at("source");
      if (std::find(sources.begin(), sources.end(), source) == sources.end()) sources.push_back(source);
    }
    study_.source = fmt::format("{}", fmt::join(sources, "; "));
    if (!uncertainty_.empty()) return;
    fail(need_.probe ? fmt::format("{} has no errors of probe {}, but measures {}; name one of them, or add it to the "
                                   "study with a reference",
                                   need_.study->string(), in_quotes(*need_.probe), fmt::join(known, ", "))
                     : fmt::format("{} has no errors, as none of its measures has a reference; add one to the study",
                                   need_.study->string()));
  }

  /// The largest error of the measures that count; none where one is unknown.
  std::optional<double> error_of(const Json& run) const {
    double most = 0;
    for (const auto& [measure, uncertainty] : uncertainty_) {
      const Json& measured = run.at("measures").at(measure);
      if (!measured.contains("error")) return std::nullopt;
      most = std::max(most, measured.at("error").get<double>() + uncertainty);
    }
    return most;
  }

  void add(const Json& run) {
    if (!run.contains("record")) return;
    ++study_.all;
    if (run.at("status") != "converged") return;
    StudiedRun candidate;
    candidate.overrides = of_base_;
    for (const Json& change : run.at("overrides")) candidate.overrides.push_back(change);
    candidate.overrides = possible_changes(scene_, candidate.overrides);
    // Pictures and the like are the scene's own.
    std::erase_if(candidate.overrides, [](const std::string& change) { return change.starts_with("output."); });
    try {
      const Value changed = plain_tree(scene_, candidate.overrides, kBeside);
      if (const auto lost = tree_difference(said_, changed, false)) {
        ++study_.changing;
        if (!lost_) lost_ = lost;
        return;
      }
      std::vector<std::string> changes = scene_.overrides;
      changes.emplace_back("need=");
      changes.insert(changes.end(), candidate.overrides.begin(), candidate.overrides.end());
      const Scene own = parse_scene_text(scene_.text, scene_.path, changes);
      if (simulation_digest(own) != run.at("simulation").get<std::string>()) {
        ++study_.others;
        if (!other_) other_ = difference_from_base(run.at("overrides"), changed);
        return;
      }
    } catch (const SceneError& e) {
      ++study_.others;
      if (!refused_) refused_ = e.diagnostics().front().text();
      return;
    } catch (const FileError& e) {
      ++study_.others;
      if (!refused_) refused_ = e.what();
      return;
    }
    const std::optional<double> error = error_of(run);
    if (!error) return;
    const Json& record = run.at("record");
    candidate.error = *error;
    candidate.seconds = record.at("setup").at("median").get<double>() + record.at("solve").at("median").get<double>();
    candidate.step = record.at("step").at("median");
    candidate.memory = record.at("memory");
    candidate.dofs = record.at("dofs");
    for (const auto& [axis, value] : run.at("axes").items())
      candidate.label += fmt::format("{}{} {}", candidate.label.empty() ? "" : ", ", axis, value.get<std::string>());
    study_.runs.push_back(std::move(candidate));
  }

  /// Keys that the study varied and this scene leaves out stand in its base where a run does not change them.
  void read_base() {
    base_ = json_.at("base_file").get<std::string>();
    try {
      const Value tree = scene_tree(parse_scene_file(base_, {}), {});
      std::set<std::string> varied;
      for (const Json& run : json_.at("runs"))
        for (const Json& change : run.at("overrides")) {
          const std::string text = change;
          varied.insert(text.substr(0, text.find('=')));
        }
      for (const std::string& key : varied)
        if (const Value* value = value_at(tree, key); value && !value_at(said_, key) && !key.starts_with("output"))
          of_base_.push_back(key + "=" + toml_text(*value));
    } catch (const SceneError&) {
      of_base_.clear();  // then runs that need them are of another scene
    } catch (const FileError&) {
      of_base_.clear();
    }
  }

  /// Where the study's scene is another than this one, in words.
  std::string difference_from_base(const std::vector<std::string>& overrides, const Value& changed) const {
    try {
      const Scene other = parse_scene_file(base_, overrides);
      if (const auto d = tree_difference(plain_tree(other, {}, kBeside), changed, true))
        return fmt::format("its `{}` is {} where this scene has {}", d->key, d->first.empty() ? "not said" : d->first,
                           d->second.empty() ? "none" : d->second);
    } catch (const SceneError&) {
      return base_ + " is no valid scene any more";
    } catch (const FileError&) {
      return base_ + " cannot be read any more";
    }
    return base_ + ", or a mesh that it reads, was changed since; make the study again";
  }

  std::string why_none() const {
    const std::string text =
        fmt::format("none of the {} runs of {} serves this scene", study_.all, need_.study->string());
    if (other_) return text + ": " + *other_;
    if (refused_ && !lost_) return text + ": " + *refused_;
    if (lost_)
      return fmt::format("{}: the scene says `{}` = {}, which no run has; leave it out, as the study varies it", text,
                         lost_->key, lost_->first);
    return text + ": none converged with an error; look at study.html there";
  }

  const Scene& scene_;
  const StatedNeed& need_;
  Value said_;
  fs::path file_;
  Json json_;
  std::map<std::string, double> uncertainty_;  ///< of the references, by measure that counts
  StoredStudy study_;
  std::optional<TreeDifference> lost_;
  std::string base_;                    ///< file of the study's scene
  std::vector<std::string> of_base_;    ///< what is taken from there, "key=value"
  std::optional<std::string> other_;    ///< where a run is of another scene
  std::optional<std::string> refused_;  ///< why a run makes no valid scene of this one
};

}  // namespace

StoredStudy read_stored_study(const Scene& scene) { return Reader(scene).study(); }

StudiedChoice choose_of_study(const StoredStudy& study, const StatedNeed& need) {
  const double error = need.error.value_or(INFINITY), step = need.step.value_or(INFINITY),
               memory = need.memory.value_or(INFINITY);
  const auto limits = [&](const StudiedRun& r) { return std::max(kStepSpread * r.step / step, r.memory / memory); };
  StudiedChoice choice;
  std::size_t nearest = 0;
  double least = INFINITY;
  for (std::size_t r = 0; r < study.runs.size(); ++r) {
    const StudiedRun& run = study.runs[r];
    const double error_ratio = need.error ? run.error / error : 0, ratio = std::max(error_ratio, limits(run));
    if (ratio <= 1) choice.runs.push_back(r);
    if (ratio < kClearlyLess * least) nearest = r, least = ratio;
  }
  if (choice.runs.empty()) {
    const StudiedRun& run = study.runs[nearest];
    choice.runs = {nearest};
    choice.why_not =
        need.error && run.error > error
            ? fmt::format("the nearest of its runs, {}, has {:.3g} times the error that is allowed", run.label,
                          run.error / error)
        : kStepSpread * run.step > step
            ? fmt::format("steps of the nearest of its runs, {}, took {}", run.label, time_text(run.step))
            : fmt::format("the nearest of its runs, {}, took {:.2g} GB of memory", run.label, run.memory / 1e9);
    return choice;
  }
  if (!need.error)
    std::stable_sort(choice.runs.begin(), choice.runs.end(),
                     [&](std::size_t a, std::size_t b) { return study.runs[a].error < study.runs[b].error; });
  // A run whose steps turn out too long gives way to those whose steps are shorter.
  std::vector<std::size_t> shorter;
  for (const std::size_t r : choice.runs)
    if (shorter.empty() || study.runs[r].step < study.runs[shorter.back()].step) shorter.push_back(r);
  choice.runs = std::move(shorter);
  return choice;
}

}  // namespace fascia::app
