#include "app/estimate/measure.hpp"

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

/// Of a scheme's error over the time step.
double order_of(SolverKind kind) { return kind == SolverKind::implicit_euler ? 1 : 2; }

class Measurement {
 public:
  explicit Measurement(const Measured& q) : q_(q), solved_(q.cut ? q.twin(TwinRole::exact) : std::optional(q.own)) {}

  EstimatedError errors(SolverKind kind, bool has_precision) {
    EstimatedError e;
    const bool relative = q_.norm == SeriesNorm::largest_relative;
    e.scale = relative ? 1 : q_.own.largest();
    std::optional<Extrapolation> space = discretisation();
    if (space) {
      e.order = space->order;
      e.order_measured = space->measured;
      e.by_finer = space->by_finer;
      if (!relative && nearest_)
        e.scale = std::max(e.scale, mixed(*against_, *nearest_, space->factor * (space->by_finer ? 1 : -1)).largest());
    }
    const auto part = [&](double error) -> std::optional<double> {
      if (error <= q_.rounding) return 0;
      return e.scale > 0 ? std::optional(error / e.scale) : std::nullopt;
    };
    if (space) e.discretisation = part(space->error);
    if (space && nearest_) add_last_difference(*against_, *nearest_, space->factor, e.components);
    const auto add_components = [&](const std::optional<Series>& from, TwinRole role, double factor) {
      const std::optional<Series> other = q_.twin(role);
      if (from && other) add_last_difference(*from, *other, factor, e.components);
    };
    e.time = 0;
    if (is_dynamic(kind)) {
      const std::optional<Extrapolation> steps = time(kind);
      e.time = steps ? part(steps->error) : std::nullopt;
      if (steps) add_components(solved_, TwinRole::shorter_step, steps->factor);
    }
    e.solver = 0;
    if (kind != SolverKind::central_differences && kind != SolverKind::modes) {
      const std::optional<double> far = apart(q_.own, TwinRole::exact);
      e.solver = far ? part(*far) : std::nullopt;
      add_components(q_.own, TwinRole::exact, 1);
    }
    e.precision = 0;
    if (has_precision) {
      const std::optional<double> far = apart(solved_, TwinRole::in_double);
      e.precision = far ? part(*far) : std::nullopt;
      add_components(solved_, TwinRole::in_double, 1);
    }
    return e;
  }

 private:
  std::optional<double> apart(const std::optional<Series>& from, TwinRole role) const {
    const std::optional<Series> other = q_.twin(role);
    return from && other ? distance(*from, *other, q_.norm) : std::nullopt;
  }

  std::optional<Extrapolation> discretisation() {
    const std::optional<Series> finer = q_.twin(TwinRole::finer), coarser = q_.twin(TwinRole::coarser),
                                coarsest = q_.twin(TwinRole::coarsest);
    against_ = q_.halved_finer ? q_.twin(TwinRole::shorter_step) : solved_;
    LevelDifferences levels;
    if (finer && against_) levels.finer = distance(*against_, *finer, q_.norm);
    if (coarser && solved_) levels.coarser = distance(*solved_, *coarser, q_.norm);
    if (coarser && coarsest) levels.coarsest = distance(*coarser, *coarsest, q_.norm);
    nearest_ = levels.finer ? finer : coarser;
    if (!levels.finer) against_ = solved_;
    return extrapolated(levels, q_.order);
  }

  std::optional<Extrapolation> time(SolverKind kind) const {
    return extrapolated({{}, {}, apart(solved_, TwinRole::shorter_step)}, {order_of(kind)});
  }

  const Measured& q_;
  std::optional<Series> solved_;             ///< the run, every step of it to its end
  std::optional<Series> against_, nearest_;  ///< of the discretisation: what is compared with what
};

}  // namespace

std::optional<double> EstimatedError::total() const {
  if (!discretisation || !time || !solver || !precision) return std::nullopt;
  return *discretisation + *time + *solver + *precision;
}

EstimatedError measured(const Measured& quantity, SolverKind kind, bool has_precision) {
  return Measurement(quantity).errors(kind, has_precision);
}

}  // namespace fascia::app
