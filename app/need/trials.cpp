#include "app/need/trials.hpp"

#include "app/need/kept_trials.hpp"
#include "app/reader/parse.hpp"
#include "app/scene/diagnostics.hpp"
#include "app/scene/toml_text.hpp"
#include "app/study/machine_load.hpp"
#include "app/tune/kept_costs.hpp"
#include "assembly/specification/readable.hpp"
#include "core/base/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <system_error>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

/// A Courant number of which conjugate gradients take the iterations of statics.
constexpr double kLongSteps = 1e9;

/// Times at which trials are compared: a quarter of what the coarsest steps are.
constexpr int kComparedTimes = 16;

std::string displacement_probe(const Scene& scene, const std::string& body) {
  std::string name = "need-displacement-" + body;
  const auto taken = [&](const Probe& p) { return p.name == name; };
  while (std::any_of(scene.probes.begin(), scene.probes.end(), taken)) name += "-";
  return name;
}

Wanted displacement_of(const Scene& scene, const std::string& body, std::optional<double> allowed) {
  return {fmt::format("the displacement of {}", in_quotes(body)), displacement_probe(scene, body), body,
          Quantity::max_displacement, allowed};
}

/// The smaller of two allowed errors, of which one or both may be missing.
void tighten(std::optional<double>& allowed, std::optional<double> other) {
  if (other) allowed = std::min(allowed.value_or(*other), *other);
}

/// What the scene's own run needs and a trial does not, and what trials are compared by.
std::vector<std::string> lean(const Scene& scene) {
  std::vector<std::string> changes{"output.fields=[\"displacement\"]"};
  for (const char* key : {"output.picture", "output.estimate", "output.every", "output.every_steps"})
    if (scene.says(key)) changes.push_back(std::string(key) + "=");
  if (is_dynamic(scene.solver.kind)) {
    const double duration = scene.solver.duration.value_or(scene.solver.steps * scene.solver.time_step);
    changes.push_back(fmt::format("output.every={}", duration / kComparedTimes));
  }
  return changes;
}

constexpr int kTimedAgain = 5;
/// So long are the runs together that take a time again [s].
constexpr double kMostAgain = 10;

double step_p99(const ChildResult& result) { return result.summary.at("seconds").at("step_p99").get<double>(); }

}  // namespace

bool interrupted_steps(const Scene& scene, double p99, double median, double spread) {
  return scene.need && scene.need->step && spread * p99 > *scene.need->step && 1.5 * median < *scene.need->step;
}

bool interrupted_steps(const Scene& scene, const nlohmann::ordered_json& summary, double spread) {
  if (!scene.need || !scene.need->step || !summary.is_object()) return false;
  const auto& seconds = summary.at("seconds");
  return interrupted_steps(scene, seconds.at("step_p99").get<double>(), seconds.at("step_median").get<double>(),
                           spread);
}

std::vector<Wanted> wanted_of(const Scene& scene) {
  std::vector<Wanted> wanted;
  for (const Probe& p : scene.probes) wanted.push_back({in_quotes(p.name), p.name, "", p.quantity, std::nullopt});
  for (const Body& body : scene.bodies)
    if (!is_carrier(body)) wanted.push_back(displacement_of(scene, body.name, std::nullopt));
  const auto need = [&](const StatedNeed& stated, const std::string& body) {
    for (Wanted& w : wanted)
      if (stated.probe ? w.body.empty() && w.probe == *stated.probe
                       : !w.body.empty() && (body.empty() || w.body == body))
        tighten(w.allowed, stated.error);
  };
  if (scene.need) need(*scene.need, "");
  for (const Body& body : scene.bodies)
    if (body.need) need(*body.need, body.name);
  std::stable_partition(wanted.begin(), wanted.end(), [](const Wanted& w) { return w.allowed.has_value(); });
  return wanted;
}

double rounding_of(Quantity quantity, double size) {
  constexpr double rounding = 1e-12;
  switch (quantity) {
    case Quantity::displacement:
    case Quantity::position:
    case Quantity::max_displacement:
    case Quantity::mean_displacement:
      return rounding * size;
    case Quantity::rotation:
    case Quantity::strain:
      return rounding;
    default:
      return 0;
  }
}

std::optional<double> relative_distance(const Series& a, const Series& b) {
  const std::optional<double> far = distance(a, b, SeriesNorm::euclidean);
  if (far && *far == 0) return 0.0;
  const double scale = b.largest();
  return far && scale > 0 ? std::optional(*far / scale) : std::nullopt;
}

Trials::Trials(const Scene& scene, OpenScene open, std::vector<Wanted> wanted, fs::path folder, const KeptTrials* kept,
               std::function<void(const std::string&)> tell, std::function<bool()> stop)
    : scene_(scene),
      open_(std::move(open)),
      wanted_(std::move(wanted)),
      folder_(std::move(folder)),
      kept_(kept),
      tell_(std::move(tell)),
      stop_(std::move(stop)) {
  std::string ignored;  // `fascia check` tells it
  costs_ = kept_costs(ignored);
}

std::vector<std::string> Trials::overrides(const NeedChoice& choice) const {
  std::vector<std::string> all;
  if (scene_.need) all.emplace_back("need=");
  for (const Body& body : scene_.bodies)
    if (body.need) all.push_back("bodies." + toml_key(body.name) + ".need=");
  const std::vector<std::string> chosen = open_.overrides(choice.resolution);
  all.insert(all.end(), chosen.begin(), chosen.end());
  if (!choice.scheme.empty()) all.push_back("solver.kind=\"" + choice.scheme + "\"");
  if (choice.scheme == "explicit" || (choice.steps == 0 && scene_.solver.step_open))
    all.emplace_back("solver.time_step=\"auto\"");
  else if (choice.steps > 0)
    all.push_back(fmt::format("solver.time_step={}", *scene_.solver.duration / choice.steps));
  all.insert(all.end(), choice.more.begin(), choice.more.end());
  return all;
}

Scene Trials::scene_of(const NeedChoice& choice) const {
  std::vector<std::string> changes = scene_.overrides;
  const std::vector<std::string> chosen = overrides(choice);
  changes.insert(changes.end(), chosen.begin(), chosen.end());
  return parse_scene_text(scene_.text, scene_.path, changes);
}

const std::vector<Trials::CostedBody>& Trials::costed(const NeedChoice& choice) const {
  const auto [known, is_new] = costed_.try_emplace(choice.resolution.family);
  if (!is_new || !costs_) return known->second;
  for (const Body& body : scene_of(choice).bodies) {
    if (is_carrier(body)) continue;
    const auto found = costs_->kinds.find(cost_kind(body));
    if (found == costs_->kinds.end()) return known->second = {};
    known->second.push_back({found->second, is_shell(body) ? 2 : 3});
  }
  return known->second;
}

/// How far waves run in a step is not kept with a trial: of a long step conjugate gradients take the most iterations.
std::optional<double> Trials::tuned_growth(const Trial& trial, double more) const {
  double most = 0;  // of the bodies: which of them has the unknowns is not known
  for (const CostedBody& body : costed(trial.choice)) {
    const Solver& solver = scene_.solver;
    const bool implicit = is_implicit_dynamics(solver.kind), explicit_steps = is_dynamic(solver.kind) && !implicit;
    const LinearUse use = linear_use(solver, body.dimension, implicit ? kLongSteps : 0, true);
    const auto time = [&](double times) {
      const double solve = explicit_steps ? 0 : linear_cost(body.cost, times * trial.dofs, use).seconds;
      return body.cost.point * times * trial.points + solve;
    };
    most = std::max(most, time(more) / time(1));
  }
  return most > 0 && std::isfinite(most) ? std::optional(most) : std::nullopt;
}

double Trials::over_allowed(const std::vector<double>& errors) const {
  double most = 0;
  for (std::size_t w = 0; w < errors.size(); ++w)
    if (const auto& allowed = wanted_[w].allowed) most = std::max(most, errors[w] / *allowed);
  return most;
}

std::string Trials::text(const NeedChoice& choice) const {
  std::string text = open_.text(choice.resolution);
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : "; ") + part; };
  if (!choice.scheme.empty()) add(choice.scheme);
  if (choice.steps > 0)
    add(fmt::format("{} steps of {}", choice.steps, time_text(*scene_.solver.duration / choice.steps)));
  return text;
}

void Trials::settle(std::size_t body, int family, int direction) {
  open_.family(body, family).settled.push_back(direction);
}

void Trials::stretch(std::size_t body, int family) {
  for (Trial& trial : trials_)
    if (trial.choice.resolution.family == family && trial.choice.more.empty())
      trial.choice.more = {open_.doubled(trial.choice.resolution, body, {})};
  open_.family(body, family).stretch *= 2;
}

bool Trials::judges(std::size_t wanted) const {
  if (wanted_.front().allowed) return wanted_[wanted].allowed.has_value();
  return !wanted_[wanted].body.empty();
}

const Trial* Trials::find(const NeedChoice& choice) const {
  const auto found = std::find_if(trials_.begin(), trials_.end(), [&](const Trial& t) { return t.choice == choice; });
  return found == trials_.end() ? nullptr : &*found;
}

const Trial& Trials::run(const NeedChoice& choice) {
  if (const Trial* before = find(choice)) return *before;
  const std::vector<std::string> changes = changes_of_trial(choice);
  std::optional<Trial> trial = kept_ ? kept_->find(changes, wanted_) : std::nullopt;
  if (!trial) {
    trial = made(changes, choice);
    if (kept_) kept_->keep(changes, wanted_, *trial);
  }
  trial->choice = choice;
  trials_.push_back(std::move(*trial));
  return trials_.back();
}

std::vector<std::string> Trials::changes_of_trial(const NeedChoice& choice) const {
  std::vector<std::string> changes = overrides(choice);
  const std::vector<std::string> more = lean(scene_);
  changes.insert(changes.end(), more.begin(), more.end());
  for (const Wanted& w : wanted_)
    if (!w.body.empty())
      changes.push_back(fmt::format("probes.{}={{body=\"{}\", quantity=\"max_displacement\"}}", w.probe, w.body));
  return changes;
}

Trial Trials::made(const std::vector<std::string>& changes, const NeedChoice& choice) {
  Trial trial;
  ChildRun child{scene_.path, scene_.overrides, folder_ / std::to_string(trials_.size()), {}, {}};
  child.overrides.insert(child.overrides.end(), changes.begin(), changes.end());
  const MachineLoad load;
  ChildResult result = run_child(child, stop_);
  // Other work of the machine lengthens single steps: where most are fast enough, the time is taken again
  // (of what may be chosen; twins only tell errors).
  double spent = 0, own = result.processor_seconds;
  for (int again = 0; again < kTimedAgain && choice.more.empty() && spent < kMostAgain && result.exit_status == 0 &&
                      !stop_() && interrupted_steps(scene_, result.summary, kStepSpread);
       ++again) {
    ChildResult other = run_child(child, stop_);
    spent += other.seconds;
    own += other.processor_seconds;
    if (other.exit_status == 0 && step_p99(other) < step_p99(result)) result = std::move(other);
  }
  trial.others = load.others(own);
  trial.status = result.status();
  trial.message = result.message;
  if (result.summary.is_object() && result.exit_status == 0) {
    const auto& seconds = result.summary.at("seconds");
    trial.seconds = seconds.at("setup").get<double>() + seconds.at("solve").get<double>();
    if (kept_ && !kept_->is_of_scene(result.summary))
      throw InputError(
          fmt::format("{}: it, or a file that it reads, was changed while its need was looked for; run it again",
                      scene_.path.string()));
    trial.step = step_p99(result);
    trial.step_median = seconds.at("step_median").get<double>();
    trial.memory = result.summary.at("peak_memory_bytes").get<double>();
    trial.dofs = result.summary.at("dofs").get<double>();
    trial.steps = result.summary.at("steps").get<double>();
    for (const auto& [name, body] : result.summary.at("bodies").items()) {
      if (body.contains("mass")) trial.body_mass[name] = body.at("mass").get<double>();
      trial.points += body.value("points", 0.0);
    }
    trial.newton = result.summary.at("newton_iterations").get<double>();
    try {
      const ProbeTable table(child.output);
      for (const Wanted& w : wanted_) trial.values.push_back(table.series(w.probe, scene_.solver.kind));
    } catch (const std::runtime_error& e) {
      trial.values.clear();
      trial.message = e.what();
    }
  }
  std::error_code ignored;
  fs::remove_all(child.output, ignored);
  return trial;
}

}  // namespace fascia::app
