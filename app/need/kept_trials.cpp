#include "app/need/kept_trials.hpp"

#include "app/cache.hpp"
#include "app/machine.hpp"
#include "app/reader/scene_tree.hpp"
#include "app/results/provenance.hpp"
#include "app/scene/toml_text.hpp"
#include "app/study/machine_load.hpp"
#include "app/tune/kept_costs.hpp"
#include "io/digest.hpp"
#include "io/files.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <stdexcept>
#include <system_error>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::uintmax_t kMostBytes = 50'000'000;

Json json_of(const Trial& t, const std::vector<Wanted>& wanted) {
  Json j{{"status", t.status}, {"seconds", t.seconds}, {"step", t.step},     {"step_median", t.step_median},
         {"memory", t.memory}, {"dofs", t.dofs},       {"points", t.points}, {"steps", t.steps},
         {"newton", t.newton}, {"others", t.others}};
  j["body_mass"] = t.body_mass;
  for (std::size_t w = 0; w < wanted.size(); ++w)
    j["values"][wanted[w].probe] = {{"times", t.values[w].times}, {"values", t.values[w].values}};
  return j;
}

/// @throws nlohmann::json::exception  it is no trial that gave all of these quantities
Trial trial_of(const Json& j, const std::vector<Wanted>& wanted) {
  Trial t;
  t.status = j.at("status");
  t.seconds = j.at("seconds");
  t.step = j.at("step");
  t.step_median = j.at("step_median");
  t.memory = j.at("memory");
  t.dofs = j.at("dofs");
  t.points = j.at("points");
  t.steps = j.at("steps");
  t.newton = j.at("newton");
  t.others = j.at("others");
  t.body_mass = j.at("body_mass").get<std::map<std::string, double>>();
  for (const Wanted& w : wanted) {
    const Json& series = j.at("values").at(w.probe);
    t.values.push_back(
        {series.at("times").get<std::vector<double>>(), series.at("values").get<std::vector<std::vector<double>>>()});
  }
  t.kept = true;
  return t;
}

}  // namespace

KeptTrials::KeptTrials(const Scene& scene, bool anew) : scene_(scene), anew_(anew) {
  for (const fs::path& file : input_files(scene)) digests_.push_back(io::sha256_of(file));
  const Machine machine = this_machine();
  const char* devices = std::getenv("CUDA_VISIBLE_DEVICES");
  origin_ = stamp_of_program("");
  if (origin_.empty()) return;
  folder_ = cache_folder();
  if (!folder_.empty()) folder_ /= "trials";
  origin_ += machine_key(machine).dump() + Json(machine.gpu).dump() + machine.driver + (devices ? devices : "") + "\n";
  for (const std::string& digest : digests_) origin_ += digest + "\n";
}

bool KeptTrials::is_of_scene(const Json& summary) const {
  const Json& provenance = summary.at("provenance");
  std::vector<std::string> digests;
  for (const Json& file : provenance.at("files")) digests.push_back(file.at("sha256"));
  return provenance.at("scene_sha256") == io::sha256(scene_.text) && digests == digests_;
}

fs::path KeptTrials::file_of(const std::vector<std::string>& changes) const {
  return folder_ / (io::sha256(origin_ + toml_text(plain_tree(scene_, changes))).substr(0, 32) + ".json");
}

std::optional<Trial> KeptTrials::find(const std::vector<std::string>& changes, const std::vector<Wanted>& wanted) const
    try {
  if (folder_.empty() || anew_) return std::nullopt;
  const fs::path file = file_of(changes);
  std::error_code none;
  if (!fs::exists(file, none)) return std::nullopt;
  Trial trial = trial_of(Json::parse(io::read_file(file)), wanted);
  const bool by_step = scene_.need && scene_.need->step;
  const bool disturbed =
      by_step && (trial.others > kBusy || interrupted_steps(scene_, trial.step, trial.step_median, kStepSpread));
  return disturbed ? std::nullopt : std::optional(std::move(trial));
} catch (const nlohmann::json::exception&) {
  return std::nullopt;  // cut off, or of other quantities: it is made anew
} catch (const std::runtime_error&) {
  return std::nullopt;  // empty, or gone meanwhile
}

void KeptTrials::keep(const std::vector<std::string>& changes, const std::vector<Wanted>& wanted,
                      const Trial& trial) const try {
  if (folder_.empty() || !trial.good()) return;
  keep_in_cache(file_of(changes), json_of(trial, wanted).dump() + "\n", kMostBytes);
} catch (const std::runtime_error&) {
  return;  // the next search makes it again
}

}  // namespace fascia::app
