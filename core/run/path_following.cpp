#include "core/run/path_following.hpp"

#include "core/base/clock.hpp"
#include "core/run/driver_parts.hpp"
#include "core/run/path_measure.hpp"

#include <limits>
#include <numeric>
#include <optional>
#include <sstream>
#include <utility>

namespace fascia {

namespace {

constexpr double kSmallest = 1.0 / 1024, kLongest = 100;  ///< steps, in lengths of the first
constexpr double kDesiredIterations = 5;
constexpr int kMostIterations = 15;  ///< of a step; one that needs more is better taken in halves
constexpr double kMostBent = 0.3;    ///< what the mean of the tangents at the ends of a step may miss of it
constexpr double kPolished = 0.02;   ///< residual over the rounding floor
constexpr int kMostPolishing = 2;
constexpr double kBeyond = 1.005;              ///< of the step to a limit point
constexpr double kBeside = 0.95;               ///< of a step that cannot be corrected because its tangent is singular
constexpr double kSlopeWidth = 2e-4;           ///< load factors apart for the slopes of factors
constexpr double kRotationPerIteration = 0.8;  ///< [rad]

class PathFollower {
 public:
  PathFollower(MechanicalSystem& system, State& state, const FactorFunction& factors, const SolverSettings& settings,
               const PathSettings& path)
      : system_(system), state_(state), factors_(factors), settings_(settings), path_(path), dots_(system.model()) {}

  RunReport run(const StepObserver& observe) {
    const bool started = start();
    while (started && !done_) {
      const Clock::time_point begin = Clock::now();
      if (run_.steps >= path_.max_steps) {
        give_up({}, "max_steps was reached; set it higher, or look at the way so far");
        break;
      }
      const NewtonReport report = advance();
      if (report.status != NewtonStatus::converged) break;
      const StepInfo info{run_.steps, lambda_, progress(), report, seconds_since(begin)};
      if (observe && !observe(info, state_, system_)) {
        if (!done_) run_.status = RunStatus::interrupted;
        break;
      }
    }
    return run_;
  }

 private:
  bool displacement() const { return path_.control == PathControl::displacement; }

  /// Equilibrium at λ = 0, the first tangent, the first length.
  bool start() {
    state_.time = 0;
    begin();
    Newton newton(system_, settings_, {1, 0});
    const NewtonReport report = newton.solve();
    run_.newton_iterations += report.iterations;
    if (drivers::ends_within(run_, report)) return false;
    if (report.status != NewtonStatus::converged) {
      keep_failure(run_, system_);
      return give_up(report, "there is no equilibrium to start from");
    }
    system_.finish_step(0, state_);
    begin();
    system_.evaluate();
    tangent_ = directions();
    if (!tangent_.usable) return give_up({}, "the tangent stiffness is singular at the start: is everything held?");
    if (!(dots_.norm(tangent_.d_f) > 0))
      return give_up({},
                     "no load or motion that grows with the load factor displaces a node (what only turns nodes is for "
                     "control = \"load\")");
    if (displacement() && !path_.controlled) path_.controlled = most_moved(system_.model(), tangent_.d_f);
    const double lambda = 1.0 / (path_.load_steps > 0 ? path_.load_steps : 10);
    if (displacement()) {
      const double answer = controlled_rate(*path_.controlled, system_.model(), state_, tangent_.d_f);
      const double wanted = path_.controlled->to.value_or(answer);
      if (wanted == 0) return give_up({}, "the loads do not move the controlled point along its direction at first");
      growth_ = wanted < 0 ? -1 : 1;
      first_ = std::abs(wanted) * lambda;
    } else {
      first_ = dots_.norm(tangent_.d_f) * lambda;
    }
    rate_ = path_rate(tangent_, 1);
    length_ = first_;
    return true;
  }

  void begin() {
    system_.begin_step(state_, 0);
    lambda_ = state_.time;
    system_.set_factors(factors_(lambda_));
  }

  PathDirections directions() {
    return system_.path_directions(factors_(lambda_ + 0.5 * kSlopeWidth), factors_(lambda_ - 0.5 * kSlopeWidth),
                                   kSlopeWidth);
  }

  /// p since the start of the step.
  double moved() const {
    if (!displacement()) return Translations::norm(system_.step_displacement());
    return growth_ * (controlled_displacement(*path_.controlled, system_.state()) -
                      controlled_displacement(*path_.controlled, state_));
  }
  /// p' · d; where nothing moved yet, of the arc length |d|.
  double moved_by(std::span<const double> d) const {
    if (displacement()) return growth_ * controlled_rate(*path_.controlled, system_.model(), system_.state(), d);
    const double p = moved();
    return p > 0 ? dots_.dot(system_.step_displacement(), d) / p : dots_.norm(d);
  }
  /// dλ/dp of the path at the present state. @param way  of the arc length: whether λ grows, 1 or −1
  double path_rate(const PathDirections& tangent, double way) const {
    if (displacement())
      return 1 / (growth_ * controlled_rate(*path_.controlled, system_.model(), system_.state(), tangent.d_f));
    return way / dots_.norm(tangent.d_f);
  }

  /// One step to where p is `length`, from the state of the last one.
  NewtonReport attempt(double length) {
    begin();
    move(tangent_, 0, rate_ * length);
    const double allowed = displacement() ? 1e-9 * length : 0.1 * length;
    return correct([&](const PathDirections& d) { return (length - moved() - moved_by(d.d_r)) / moved_by(d.d_f); },
                   [&] { return std::abs(moved() - length) <= allowed; });
  }

  /// From the present state of the step to λ = 1.
  NewtonReport attempt_end() {
    return correct([&](const PathDirections&) { return 1 - lambda_; }, [&] { return std::abs(1 - lambda_) < 1e-12; });
  }

  /// Applies weight d_r + dλ d_f and dλ, less of both where frames would turn too far.
  void move(const PathDirections& d, double weight, double dlambda) {
    const double turn = system_.steer(d, weight, dlambda);
    const double part = std::min(1.0, kRotationPerIteration / std::max(turn, 1e-300));
    system_.apply(part);
    lambda_ += part * dlambda;
    system_.set_factors(factors_(lambda_));
  }

  void go_back_to(double lambda, Evaluation& evaluation) {
    system_.restore();
    lambda_ = lambda;
    system_.set_factors(factors_(lambda));
    evaluation = system_.evaluate();
  }

  /// Newton's method on r = 0 and a constraint, which gives δλ.
  template <class Constraint, class Satisfied>
  NewtonReport correct(const Constraint& constraint, const Satisfied& satisfied) {
    NewtonReport report;
    const int limit = std::min(settings_.max_iterations, kMostIterations);
    std::optional<std::pair<double, double>> kept;  // relative residual and λ of the best converged state
    int polishing = 0;
    bool done = false;
    for (;; ++report.iterations) {
      report.last = system_.evaluate();
      report.status = NewtonStatus::converged;
      const bool good = report.last.finite() && report.last.converged() && satisfied() &&
                        (kept || !system_.has_prescribed_increment());
      if (good && (!kept || report.last.relative < kept->first)) {
        // Where rounding is the limit, well below it: what is left hides how the path goes on.
        done = report.last.relative <= std::max(settings_.tolerance, kPolished * report.last.relative_floor);
        if (done) break;
        if (!kept) effort_ = report.iterations;
        kept = {report.last.relative, lambda_};
        system_.save();
      }
      if (kept && ++polishing > kMostPolishing) break;
      report.status = NewtonStatus::not_finite;
      if (!report.last.finite()) break;
      report.status = NewtonStatus::limit;
      if (!kept && report.iterations >= limit) break;
      report.status = NewtonStatus::stopped;
      if (settings_.stops && settings_.stops()) break;
      if (settings_.iterating)
        settings_.iterating(
            {run_.steps + 1, lambda_, report.iterations + 1, report.last.relative, settings_.tolerance});
      const PathDirections d = directions();
      const double dlambda = d.usable ? constraint(d) : 0.0;
      report.status = NewtonStatus::linear_failure;
      if (!d.usable || !std::isfinite(dlambda)) break;
      move(d, 1, dlambda);
    }
    if (!kept) effort_ = report.iterations;
    if (kept && !done) {
      if (report.last.relative != kept->first) go_back_to(kept->second, report.last);
      report.status = NewtonStatus::converged;
    }
    run_.newton_iterations += report.iterations;
    return report;
  }

  /// The next step. What fails is taken in halves.
  NewtonReport advance() {
    double length = std::min(length_, kRotationPerStep / std::max(tangent_.largest_rotation * std::abs(rate_), 1e-300));
    const double left = to_go();
    NewtonReport failed;
    bool at_extremum = false;  // the step was shortened to a limit point
    bool beside = false;       // and then a little more, because the tangent is singular there
    bool never_ends = false;   // the path seemed to come to λ = 1 within the step and does not
    // The first step may be far too long: its length was a guess.
    const double smallest = std::min(first_, left) * (run_.steps == 0 ? kSmallest * kSmallest : kSmallest);
    for (length = std::min(length, left); length >= smallest; length *= 0.5) {
      NewtonReport report = attempt(length);
      if (stopped(report)) return report;
      if (report.status != NewtonStatus::converged) {
        failed = report;
        calm_ = 3;
        if (report.status == NewtonStatus::linear_failure && !std::exchange(beside, true)) length *= 2 * kBeside;
        continue;
      }
      PathDirections end = directions();
      const double rate = end.usable ? rate_at(end) : 0.0;
      const bool last = ends_by_displacement() && length >= left * (1 - 1e-9);
      if (last && !end.usable && ends_at_limit_point()) return accept(report, end, 0, true);
      if (!follows(end, rate)) continue;
      const double p = moved();
      const LoadCurve curve{state_.time, rate_ * p, lambda_, rate * p};
      const double s =
          ends_by_displacement() || never_ends ? 2.0 : curve.first_at(1 - 1e-6 * std::abs(curve.b - curve.a));
      if (s > 1 && !at_extremum && !has_corner() && curve.has_extremum()) {
        // A step ends there, which locates the limit point to second order; a little beyond, where the tangent is not
        // singular to rounding.
        at_extremum = true;
        if (const double e = curve.extremum(); e > 0.1 && e < 0.9) {
          length = 2 * kBeyond * e * p;
          continue;
        }
      }
      if (s > 1) return accept(report, end, rate, last);
      const bool short_of_it = lambda_ < 1;
      if (s < 1 - 1e-3) report = attempt(s * p);
      if (report.status == NewtonStatus::converged) report = attempt_end();
      if (stopped(report)) return report;
      if (report.status == NewtonStatus::converged && std::abs(moved() - s * p) < 0.5 * p) {
        lambda_ = 1;
        end = directions();
        if (end.usable) return accept(report, end, rate_at(end), true);
      }
      if (short_of_it) {
        never_ends = true;
        length *= 2;
      }
    }
    keep_failure(run_, system_);
    begin();
    const std::string why = failed.status == NewtonStatus::converged ? "steps of any length meet another path; " : "";
    give_up(failed, why + (displacement() ? "where the controlled displacement turns back (snap-back), only control = "
                                            "\"arc-length\" follows"
                                          : "the path could not be followed further; try more load_steps"));
    failed.status = NewtonStatus::limit;
    return failed;
  }

  /// Returns to the last step where the run was asked to stop; whether it was.
  bool stopped(const NewtonReport& report) {
    if (!drivers::ends_within(run_, report)) return false;
    begin();
    return true;
  }

  bool ends_by_displacement() const { return displacement() && path_.controlled->to.has_value(); }
  double to_go() const {
    if (!ends_by_displacement()) return std::numeric_limits<double>::max();
    return growth_ * (*path_.controlled->to - controlled_displacement(*path_.controlled, state_));
  }

  std::vector<double> slopes(double lambda) const {
    std::vector<double> ahead = factors_(lambda + 0.5 * kSlopeWidth);
    const std::vector<double> behind = factors_(lambda - 0.5 * kSlopeWidth);
    for (std::size_t k = 0; k < ahead.size(); ++k) ahead[k] = (ahead[k] - behind[k]) / kSlopeWidth;
    return ahead;
  }
  /// Loads change their proportions within the step: the path has a corner there.
  bool has_corner() const {
    const std::vector<double> a = slopes(state_.time), b = slopes(lambda_);
    const double product = std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
    return product < 0.999 * std::sqrt(std::inner_product(a.begin(), a.end(), a.begin(), 0.0) *
                                       std::inner_product(b.begin(), b.end(), b.begin(), 0.0));
  }

  /// dλ/dp at the end of a step: on along the step, around a corner on in λ.
  double rate_at(const PathDirections& end) const {
    const double along = has_corner() ? lambda_ - state_.time : dots_.dot(system_.step_displacement(), end.d_f);
    return path_rate(end, along < 0 ? -1 : 1);
  }

  /// A cubic through both ends with the tangents there explains the step, in displacements and in λ: it did not leave
  /// the path for another one, and is short enough to show the path's shape.
  bool follows(const PathDirections& end, double rate) const {
    if (!end.usable || !std::isfinite(rate)) return false;
    if (has_corner()) return true;  // around it they say nothing
    const double p = moved(), a = rate_ * p, b = rate * p, dlambda = lambda_ - state_.time;
    const double off = std::abs(dlambda - 0.5 * (a + b));
    if (off > kMostBent * std::max({std::abs(dlambda), std::abs(a), std::abs(b)})) return false;
    const std::span<const Vec3d> du = system_.step_displacement();
    double squared = 0;
    for (std::size_t i = 0; i < du.size(); ++i) {
      const int node = static_cast<int>(i);
      const Vec3d mean =
          dots_.translation(tangent_.d_f, node) * (0.5 * a) + dots_.translation(end.d_f, node) * (0.5 * b);
      squared += squared_norm(du[i] - mean);
    }
    return std::sqrt(squared) <= kMostBent * Translations::norm(du);
  }

  /// The tangent is singular there, and the load factor comes to it as to its extremum: half as far as it set out to.
  bool ends_at_limit_point() const {
    const double set_out = rate_ * moved(), came = lambda_ - state_.time;
    return !has_corner() && std::abs(came - 0.5 * set_out) <= kMostBent * std::max(std::abs(came), std::abs(set_out));
  }

  NewtonReport accept(NewtonReport report, PathDirections& end, double rate, bool done) {
    const double p = moved();
    if (run_.steps == 0) first_ = std::min(first_, p);
    const bool corner = has_corner();
    const LoadCurve curve{state_.time, rate_ * p, lambda_, rate * p};
    system_.keep_loads();
    system_.finish_step(lambda_, state_);
    ++run_.steps;
    run_.time = lambda_;
    run_.residual = std::max(run_.residual, report.last.relative);
    run_.residual_floor = std::max(run_.residual_floor, report.last.relative_floor);
    if (!corner) note_events(curve, end.unstable - tangent_.unstable);
    report.trouble = run_.trouble = describe(end.unstable);
    tangent_ = std::move(end);
    rate_ = rate;
    const double growth = std::sqrt(kDesiredIterations / std::max(1, effort_));
    length_ = std::min(kLongest * first_, p * std::clamp(growth, 0.5, calm_ > 0 ? 1.0 : 2.0));
    calm_ = std::max(0, calm_ - 1);
    done_ = done;
    return report;
  }

  static std::string describe(int unstable) {
    if (unstable == 0) return "";
    return "its tangent stiffness has " + std::to_string(unstable) + " negative pivot" + (unstable > 1 ? "s" : "");
  }

  /// @param more  change of the number of unstable directions
  void note_events(const LoadCurve& curve, int more) {
    const bool limit = curve.has_extremum();
    std::ostringstream text;
    if (limit)
      text << "limit point passed at load factor " << curve.value(curve.extremum()) << " (step " << run_.steps << ")";
    else if (more != 0)
      text << "bifurcation passed between load factors " << curve.a << " and " << curve.b << " (step " << run_.steps
           << "): " << std::abs(more) << (more > 0 ? " more" : " fewer")
           << " unstable directions; this is the path that goes straight on";
    if (limit || more != 0) run_.events.push_back(text.str());
  }

  double progress() const {
    if (done_) return 1;
    if (!ends_by_displacement()) return std::clamp(lambda_, 0.0, 0.999);
    return std::clamp(1 - to_go() / std::abs(*path_.controlled->to), 0.0, 0.999);
  }

  bool give_up(const NewtonReport& report, const std::string& advice) {
    std::ostringstream message;
    const std::string why = failure_sentence(report, settings_);
    message << "step " << run_.steps + 1 << " (load factor " << state_.time << "): " << why << (why.empty() ? "" : "; ")
            << advice;
    run_.message = message.str();
    run_.status = report.status == NewtonStatus::not_finite ? RunStatus::diverged : RunStatus::not_converged;
    return false;
  }

  MechanicalSystem& system_;
  State& state_;
  const FactorFunction& factors_;
  const SolverSettings& settings_;
  PathSettings path_;
  Translations dots_;
  RunReport run_;
  PathDirections tangent_;  ///< at the state of the last step
  double rate_ = 0;         ///< dλ/dp there
  double lambda_ = 0;       ///< of the present state
  double first_ = 0;        ///< length of the first step
  double length_ = 0;       ///< of the next one
  int calm_ = 0;            ///< steps that still do not grow, after one that failed
  int effort_ = 0;          ///< iterations of the present step until the residual was allowed
  double growth_ = 1;       ///< sign of the controlled displacement
  bool done_ = false;
};

}  // namespace

RunReport run_path(MechanicalSystem& system, State& state, const FactorFunction& factors,
                   const SolverSettings& settings, const PathSettings& path, const StepObserver& observe) {
  return PathFollower(system, state, factors, settings, path).run(observe);
}

}  // namespace fascia
