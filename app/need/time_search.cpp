#include "app/need/time_search.hpp"

#include "assembly/specification/readable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

constexpr int kFirstSteps = 32;
constexpr int kMostSteps = 1 << 18;
/// The part of the allowed error that steps may have.
constexpr double kShareOfTime = 0.25;
/// Where no error is stated, that of the steps is to be this part of the cells'.
constexpr double kUnstated = 0.01;
/// Differences of halved steps foretell errors to within this.
constexpr double kSafety = 1.25;

double order_of(const Scene& scene, const NeedChoice& choice) {
  if (choice.scheme.empty()) return scene.solver.kind == SolverKind::implicit_euler ? 1 : 2;
  return choice.scheme == "implicit-euler" ? 1 : 2;
}

class TimeSearch {
 public:
  TimeSearch(Trials& trials, const SearchLimits& limits)
      : trials_(trials), limits_(limits), solver_(trials.scene().solver) {}

  Found found(NeedChoice like) {
    // Coarse meshes of the best kind have about the frequencies of fine ones.
    const int family = trials_.open().families() - 1;
    like.resolution = {family, trials_.open().least(family)};
    if (open_steps() && !settle_steps(like)) return {like, false, why_not_};
    std::vector<double> error = time_error(like);
    const double used = largest(error);
    SearchLimits space = limits_;
    if (has_error()) {
      space.share = limits_.share - used;
      if (!(space.share > 0.1))
        return failed(like, fmt::format("the error of its time steps alone is {:.2g} times what is allowed", used),
                      error);
    }
    Found found = search_resolution(trials_, like, space);
    if (trials_.stopped()) return found;
    const Trial* trial = trials_.find(found.choice);
    if (!trial || !trial->good()) return found;
    found.time_error = time_error(found.choice);
    const double of_cells = Accuracy(trials_, found.choice).ratio(*trial).value_or(0);
    if (found.met && has_error() && of_cells + largest(found.time_error) > 1) {
      found.met = false;
      found.why_not = "finer cells made the error of the time steps larger than was foreseen";
    }
    if (found.met && solver_.scheme_open) try_explicit(found);
    return found;
  }

 private:
  bool open_steps() const { return solver_.step_open && solver_.kind != SolverKind::central_differences; }
  bool has_error() const {
    return std::any_of(trials_.wanted().begin(), trials_.wanted().end(), [](const Wanted& w) { return w.allowed; });
  }
  double allowed(std::size_t w) const {
    return trials_.wanted()[w].allowed.value_or(has_error() ? INFINITY : kUnstated / kShareOfTime);
  }
  double largest(const std::vector<double>& error) const {
    double most = 0;
    for (std::size_t w = 0; w < error.size(); ++w) most = std::max(most, error[w] / allowed(w));
    return most;
  }

  Found failed(const NeedChoice& choice, const std::string& why, std::vector<double> error) {
    trials_.run(choice);
    Found found{choice, false, why};
    found.time_error = std::move(error);
    return found;
  }

  /// Differences of two trials over the scale of the second, by quantity; empty where one gave nothing.
  std::vector<double> apart(const Trial& a, const Trial& b) const {
    if (!a.good() || !b.good()) return {};
    std::vector<double> far;
    for (std::size_t w = 0; w < a.values.size(); ++w)
      far.push_back(relative_distance(a.values[w], b.values[w]).value_or(0));
    return far;
  }

  /// The number of steps whose error is small enough, and the scheme that needs the fewest where it is open.
  bool settle_steps(NeedChoice& like) {
    std::vector<std::string> schemes{like.scheme};
    if (solver_.scheme_open) schemes = {"newmark", "bdf2"};
    NeedChoice best;
    for (const std::string& scheme : schemes) {
      NeedChoice choice = like;
      choice.scheme = scheme;
      const int steps = steps_needed(choice, best.steps > 0 ? best.steps : kMostSteps);
      if (trials_.stopped()) return false;
      if (steps > 0 && (best.steps == 0 || steps < best.steps)) best = choice, best.steps = steps;
    }
    if (best.steps == 0) return false;
    like = best;
    return true;
  }

  /// @param most  there is a scheme that needs no more; 0 where this one does not get there
  int steps_needed(NeedChoice choice, int most) {
    const double order = order_of(trials_.scene(), choice);
    choice.steps = kFirstSteps;
    const Trial* coarse = &trials_.run(choice);
    while (!trials_.stopped()) {
      choice.steps *= 2;
      if (choice.steps > std::min(2 * most, kMostSteps)) break;
      if (2 * coarse->seconds > limits_.seconds) break;
      const Trial& fine = trials_.run(choice);
      const std::vector<double> far = apart(*coarse, fine);
      if (!fine.good()) why_not_ = fine.message;
      coarse = &fine;
      if (far.empty()) continue;
      // Of the finer one; the coarser one has 2^p times that.
      const double error = kSafety * largest(far) / (std::exp2(order) - 1) / kShareOfTime;
      trials_.tell(fmt::format("need: {}: error of the time steps about {:.2g} of what they may have",
                               trials_.text(choice), error));
      if (error > 1) continue;
      const double steps = choice.steps * std::pow(error, 1 / order);
      constexpr int unit = 16;  // so that trials have times in common
      return std::clamp(unit * static_cast<int>(std::ceil(steps / unit)), unit, choice.steps);
    }
    if (why_not_.empty()) why_not_ = fmt::format("{} time steps are not enough", choice.steps);
    return 0;
  }

  /// Of a choice's time steps, by a run of half as long ones.
  std::vector<double> time_error(const NeedChoice& choice) {
    const Trial& own = trials_.run(choice);
    NeedChoice half = choice;
    if (choice.steps > 0)
      half.steps *= 2;
    else
      half.more.push_back(fmt::format("solver.time_step={}", half_step(own)));
    const Trial& shorter = trials_.run(half);
    const double order = order_of(trials_.scene(), choice), factor = std::exp2(order) / (std::exp2(order) - 1);
    std::vector<double> error = apart(own, shorter);
    for (double& e : error) e *= factor;
    return error;
  }

  double half_step(const Trial& own) const {
    if (!solver_.time_step_automatic && !solver_.step_open) return solver_.time_step / 2;
    return solver_.duration.value_or(1) / std::max(1.0, own.steps) / 2;
  }

  /// Explicit steps at the resolution that was chosen: cheaper for short motions of stiff bodies.
  void try_explicit(Found& found) {
    const Trial* own = trials_.find(found.choice);
    NeedChoice choice = found.choice;
    choice.scheme = "explicit";
    choice.steps = 0;
    const Trial& trial = trials_.run(choice);
    const std::vector<double> far = apart(trial, *own);
    if (far.empty() || largest(far) > kShareOfTime || trial.seconds >= 0.8 * own->seconds) return;
    trials_.tell(fmt::format("need: {}: {} in the place of {}", trials_.text(choice), time_text(trial.seconds),
                             time_text(own->seconds)));
    found.judged = found.choice;
    found.choice = choice;
    for (std::size_t w = 0; w < far.size(); ++w) found.time_error[w] += far[w];
  }

  Trials& trials_;
  SearchLimits limits_;
  const Solver& solver_;
  std::string why_not_;
};

}  // namespace

NeedChoice first_choice(const Trials& trials) {
  const Solver& solver = trials.scene().solver;
  NeedChoice choice;
  choice.resolution = {0, trials.open().least(0)};
  if (solver.step_open && solver.kind != SolverKind::central_differences) choice.steps = kFirstSteps;
  if (solver.scheme_open) choice.scheme = "newmark";
  return choice;
}

Found search_in_time(Trials& trials, const NeedChoice& first, const SearchLimits& limits) {
  return TimeSearch(trials, limits).found(first);
}

}  // namespace fascia::app
