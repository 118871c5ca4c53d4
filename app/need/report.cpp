#include "app/need/report.hpp"

#include "app/estimate/resolution.hpp"
#include "app/results/probes.hpp"
#include "app/scene/diagnostics.hpp"
#include "assembly/specification/readable.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

namespace fascia::app {
namespace {

using Json = nlohmann::ordered_json;

std::string unit_of(const Scene& scene, const Wanted& wanted) {
  for (const Probe& p : scene.probes)
    if (wanted.body.empty() && p.name == wanted.probe) return probe_unit(p.quantity);
  return "m";
}

/// Of Newton's method and the linear solver, by a coarse trial with tight tolerances.
std::vector<double> solver_error(Trials& trials, const Trial& coarsest) {
  const SceneTwin exact = solved_exactly(trials.scene());
  std::vector<double> error(trials.wanted().size(), 0);
  if (!exact.complete()) return error;
  NeedChoice choice = coarsest.choice;
  choice.more.insert(choice.more.end(), exact.overrides.begin(), exact.overrides.end());
  const Trial& trial = trials.run(choice);
  for (std::size_t w = 0; w < error.size() && trial.good(); ++w)
    error[w] = relative_distance(coarsest.values[w], trial.values[w]).value_or(0);
  return error;
}

/// Why the next finer level that was tried was not taken, a clause behind others.
std::string finer(const Trials& trials, const NeedChoice& choice, const Scene& scene) {
  const Trial* next = nullptr;
  for (const Trial& t : trials.all()) {
    NeedChoice like = t.choice;
    like.resolution.level = choice.resolution.level;
    if (like == choice && t.choice > choice && (!next || t.choice < next->choice)) next = &t;
  }
  if (!next) return "";
  const std::string text = "; " + trials.open().text(next->choice.resolution);
  if (!next->good()) return text + ": " + next->message;
  return scene.need && scene.need->step ? fmt::format("{}: steps of up to {}", text, time_text(next->step)) : "";
}

}  // namespace

std::string percent(double part) { return fmt::format("{:.2g} %", 100 * part); }

Json json_of(const StatedNeed& need) {
  Json j = Json::object();
  if (need.error) j["error"] = *need.error;
  if (need.probe) j["probe"] = *need.probe;
  if (need.step) j["step"] = *need.step;
  if (need.memory) j["memory"] = *need.memory;
  if (need.study) j["study"] = need.study->string();
  return j;
}

std::string families_text(const OpenScene& open) {
  std::vector<std::string> parts;
  for (const OpenBody& body : open.bodies) {
    std::vector<std::string> names;
    for (const Family& f : body.families) names.push_back(f.name);
    parts.push_back(fmt::format("{} of {}", fmt::join(names, " and "), in_quotes(body.name)));
  }
  return parts.empty() ? "time steps" : fmt::format("{}", fmt::join(parts, ", "));
}

void NeedReport::add(Trials& trials, const Found& found, const SaidCells& said, double seconds) {
  const Trial& own = *trials.find(found.choice);
  const Trial& judged = *trials.find(found.judged.value_or(found.choice));
  const Accuracy accuracy(trials, judged.choice);
  seconds_ = seconds;
  why_not_ = found.met ? "" : found.why_not;
  const std::vector<const Trial*>& levels = accuracy.levels(found.choice.resolution.family);
  const std::vector<double> solver = solver_error(trials, *levels.front());
  errors_ = Json::object();
  std::vector<std::string> told;
  for (std::size_t w = 0; w < trials.wanted().size(); ++w) {
    const Wanted& wanted = trials.wanted()[w];
    std::optional<double> space = accuracy.error(judged, w);
    if (space && !said.error.empty()) *space += said.error[w];
    const double time = w < found.time_error.size() ? found.time_error[w] : 0;
    const double simpler = w < found.simpler_error.size() ? found.simpler_error[w] : 0;
    const std::optional<double> total = space ? std::optional(*space + time + solver[w] + simpler) : std::nullopt;
    Json e{{"discretisation", space ? Json(*space) : Json(nullptr)},
           {"time", time},
           {"solver", solver[w]},
           {"precision", 0.0},
           {"total", total ? Json(*total) : Json(nullptr)},
           {"scale", own.values[w].largest()},
           {"unit", unit_of(scene_, wanted)}};
    if (simpler > 0) e["simplification"] = simpler;
    if (const auto& c = accuracy.convergence(found.choice.resolution.family, w))
      e["order"] = c->order, e["order_measured"] = c->measured;
    if (wanted.allowed)
      told.push_back(fmt::format("{} {} of {} allowed", wanted.name, total ? percent(*total) : "unknown",
                                 percent(*wanted.allowed)));
    else if (trials.wanted().front().allowed == std::nullopt && w < 3)
      told.push_back(fmt::format("{} {}", wanted.name, total ? percent(*total) : "unknown"));
    if (wanted.body.empty())
      errors_[wanted.probe] = std::move(e);
    else
      errors_["bodies"][wanted.body] = std::move(e);
  }
  reached_ = fmt::format("estimated error of {}", fmt::join(told, ", "));
  how_ = {fmt::format("discretisation: by what trials of {} levels converge to, with its uncertainty", levels.size())};
  if (!said.error.empty())
    how_.push_back(fmt::format("discretisation of {}, whose cells the scene says: by a coarse trial with twice as many",
                               said.bodies));
  if (!said.unknown.empty())
    how_.push_back(fmt::format("discretisation of {}: not known, as {}", said.bodies, said.unknown));
  if (is_dynamic(scene_.solver.kind)) how_.emplace_back("time: by a trial of half the step");
  how_.emplace_back("solver: by a coarse trial with tight tolerances");
  trials_ = Json::array();
  std::size_t good = 0, kept = 0;
  const bool has_error = trials.wanted().front().allowed.has_value();
  for (const Trial& t : trials.all()) {
    Json j{{"choice", trials.text(t.choice)}, {"status", t.status}, {"seconds", t.seconds}, {"unknowns", t.dofs}};
    if (!t.choice.more.empty()) j["twin"] = t.choice.more;
    if (t.kept) j["kept"] = true;
    if (is_dynamic(scene_.solver.kind)) j["step_p99"] = t.step;
    if (const auto ratio = has_error && t.choice.steps == judged.choice.steps && t.choice.more == judged.choice.more
                               ? accuracy.ratio(t)
                               : std::nullopt)
      j["error_over_allowed"] = *ratio;
    good += t.good() ? 1 : 0;
    kept += t.kept ? 1 : 0;
    trials_.push_back(std::move(j));
  }
  sentences_ = {
      fmt::format("chosen: {}: {:.0f} unknowns, {}", trials.text(found.choice), own.dofs, time_text(own.seconds)),
      fmt::format("why: {} of {} trials in {}{}",
                  !found.met  ? "the nearest to the need"
                  : has_error ? "the cheapest that meets the need"
                              : "the finest that meets the need",
                  good, time_text(seconds), kept > 0 ? fmt::format(", of which {} were kept from before", kept) : ""),
      reached_};
  if (!has_error && found.met) sentences_[1] += finer(trials, own.choice, scene_);
  sentences_.insert(sentences_.end(), found.simpler.begin(), found.simpler.end());
  const Trial* coarser = nullptr;
  for (const Trial* t : levels)
    if (t->choice.resolution.level < own.choice.resolution.level) coarser = t;
  if (const auto ratio = coarser ? accuracy.ratio(*coarser) : std::nullopt; ratio && *ratio > 1)
    sentences_[1] += fmt::format("; {} has {:.2g} times the error that is allowed",
                                 trials.open().text(coarser->choice.resolution), *ratio);
}

void NeedReport::write(Json& summary) {
  std::vector<std::string> chosen = sentences_;
  step_.clear();
  if (scene_.need && scene_.need->step) {
    const auto p99 = summary.at("seconds").at("step_p99").get<double>();
    chosen.push_back(
        fmt::format("99 of 100 steps take at most {}, of {} allowed", time_text(p99), time_text(*scene_.need->step)));
    interrupted_ = interrupted_steps(scene_, summary, 1);
    if (p99 > *scene_.need->step)
      step_ = fmt::format("99 of 100 steps of the run take up to {}, more than those of its trial", time_text(p99));
  }
  Json need = scene_.need ? json_of(*scene_.need) : Json::object();
  for (const Body& body : scene_.bodies)
    if (body.need) need["bodies"][body.name] = json_of(*body.need);
  need["met"] = met();
  if (!met()) need["why_not"] = why_not_.empty() ? step_ : why_not_;
  need["seconds"] = seconds_;
  need["trials"] = trials_;
  const Json provenance = summary.at("provenance");
  summary.erase("provenance");
  summary["chosen"] = chosen;
  summary["estimated_error"] = errors_;
  summary["estimate"] = {{"how", how_}, {"seconds", seconds_}};
  summary["need"] = std::move(need);
  summary["provenance"] = provenance;
}

std::string NeedReport::not_met() const {
  return fmt::format("the need is not met: {}; reached: {}", why_not_.empty() ? step_ : why_not_, reached_);
}

}  // namespace fascia::app
