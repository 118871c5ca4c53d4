#include "app/need/kept_trials.hpp"

#include "app/machine.hpp"
#include "app/reader/scene_tree.hpp"
#include "app/results/provenance.hpp"
#include "app/scene/toml_text.hpp"
#include "app/study/machine_load.hpp"
#include "app/tune/kept_costs.hpp"
#include "core/base/errors.hpp"
#include "io/digest.hpp"
#include "io/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Above as many, the older half goes.
constexpr std::size_t kMostKept = 4000;

void drop_old(const fs::path& folder) {
  std::error_code none;
  std::vector<std::pair<fs::file_time_type, fs::path>> files;
  for (const auto& entry : fs::directory_iterator(folder, none))
    files.emplace_back(entry.last_write_time(none), entry.path());
  if (files.size() <= kMostKept) return;
  std::sort(files.begin(), files.end());
  for (std::size_t i = 0; i < files.size() - kMostKept / 2; ++i) fs::remove(files[i].second, none);
}

Json json_of(const Trial& t, const std::vector<Wanted>& wanted) {
  Json j{{"status", t.status}, {"seconds", t.seconds}, {"step", t.step},     {"memory", t.memory}, {"dofs", t.dofs},
         {"points", t.points}, {"steps", t.steps},     {"newton", t.newton}, {"others", t.others}};
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

KeptTrials::KeptTrials(const Scene& scene, bool anew) : scene_(scene), folder_(cache_folder()), anew_(anew) {
  if (folder_.empty()) return;
  folder_ /= "trials";
  drop_old(folder_);
  origin_ = machine_key(this_machine()).dump() + "\n" + stamp_of_program("");
  for (const fs::path& file : input_files(scene)) origin_ += io::sha256_of(file) + "\n";
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
  return by_step && trial.others > kBusy ? std::nullopt : std::optional(std::move(trial));
} catch (const nlohmann::json::exception&) {
  return std::nullopt;  // cut off, or of other quantities: it is made anew
} catch (const FileError&) {
  return std::nullopt;
}

void KeptTrials::keep(const std::vector<std::string>& changes, const std::vector<Wanted>& wanted,
                      const Trial& trial) const try {
  if (folder_.empty() || !trial.good()) return;
  io::make_directories(folder_);
  io::replace_file(file_of(changes), json_of(trial, wanted).dump() + "\n");
} catch (const FileError&) {
  return;  // the next search makes it again
}

}  // namespace fascia::app
