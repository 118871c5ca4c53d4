#include "app/study/finest.hpp"

#include "app/study/richardson.hpp"
#include "app/study/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

/// Size of what an axis varies in a run: its own number where unknowns stay, else by unknowns.
double size_of(const StudyResult& result, std::size_t axis, const StudyRun& run, bool by_unknowns) {
  if (by_unknowns) return std::pow(run.record->dofs, -1.0 / result.dimension);
  return result.study.axes[axis].values[run.plan.at[axis]].number.value_or(0);
}

/// A run could be the reference of a question: it has what is measured.
bool is_measured(const StudyResult& result, const Question& question, const StudyRun& run) {
  const bool field = !result.study.measures[question.measure].field.empty();
  return run.converged() && belongs(result, question, run) && (field || !run.measured[question.measure].value.empty());
}

/// The run with the most unknowns, then the most steps.
std::optional<std::size_t> finest_run(const StudyResult& result, const Question& question) {
  std::optional<std::size_t> finest;
  const auto finer = [&](const RunRecord& a, const RunRecord& b) {
    return a.dofs != b.dofs ? a.dofs > b.dofs : a.steps > b.steps;
  };
  for (std::size_t r = 0; r < result.runs.size(); ++r)
    if (is_measured(result, question, result.runs[r]) &&
        (!finest || finer(*result.runs[r].record, *result.runs[*finest].record)))
      finest = r;
  return finest;
}

/// A run's value, to which each axis that varies a size adds what Richardson's extrapolation says.
struct Extrapolated {
  ReferenceValue reference;
  bool has_order = false;  ///< along each axis that varies a size, of which there is one at least
};

Extrapolated extrapolated(const StudyResult& result, std::size_t measure, const StudyRun& run) {
  Extrapolated found;
  ReferenceValue& reference = found.reference;
  reference.at = run.measured[measure];
  reference.at.error.reset();
  reference.source = fmt::format("finest run ({})", label_of(result, run));
  if (!reference.at.times.empty()) {
    reference.source += ", as it is: a curve is not extrapolated";
    return found;
  }
  double uncertainty = 0;
  bool known = false, ordered = true;
  for (std::size_t axis = 0; axis < result.study.axes.size(); ++axis) {
    const std::optional<SizeSeries> series = series_of(result, axis, run.plan.at);
    if (!series) continue;
    std::vector<Level> levels;
    for (std::size_t i = 0; i < series->runs.size(); ++i)
      if (const RunMeasure& m = result.runs[series->runs[i]].measured[measure];
          m.value.size() == reference.at.value.size())
        levels.push_back({series->h[i], m.value});
    const std::optional<Limit> limit = limit_of(levels);
    if (!limit) continue;
    known = true;
    ordered = ordered && limit->order.has_value();
    for (std::size_t i = 0; i < limit->value.size(); ++i)
      reference.at.value[i] += limit->value[i] - run.measured[measure].value[i];
    uncertainty += limit->uncertainty;
    reference.source += limit->order
                            ? fmt::format(", extrapolated over {} with the observed order {:.2f}",
                                          result.study.axes[axis].name, *limit->order)
                            : fmt::format(", whose values over {} show no order", result.study.axes[axis].name);
  }
  const double size = norm_of(reference.at.value);
  reference.uncertainty = size > 0 ? uncertainty / size : 0;
  if (!known) reference.source += ", with nothing to extrapolate by";
  found.has_order = known && ordered;
  return found;
}

/// No other run is finer along any axis.
bool is_finest_of_its_kind(const StudyResult& result, std::size_t r) {
  for (std::size_t axis = 0; axis < result.study.axes.size(); ++axis)
    if (const auto series = series_of(result, axis, result.runs[r].plan.at); series && series->runs.back() != r)
      return false;
  return true;
}

/// A run's field. Along each axis that varies a size, the distances of coarser runs from it are c (h^p − h₀^p): their
/// limit is what it lacks itself.
Extrapolated as_it_is(StudyResult& result, const Question& question, const StudyRun& run, const fs::path& directory) {
  Extrapolated found;
  ReferenceValue& reference = found.reference;
  reference.directory = run.plan.directory;
  reference.source = fmt::format("finest run ({}), as it is: a field is not extrapolated", label_of(result, run));
  bool ordered = true, known = false;
  for (std::size_t axis = 0; axis < result.study.axes.size(); ++axis) {
    const std::optional<SizeSeries> series = series_of(result, axis, run.plan.at);
    if (!series) continue;
    std::vector<Level> levels;
    for (std::size_t i = 0; i < series->runs.size(); ++i) {
      const FieldDistance& apart =
          result.fields.at(result.study.measures[question.measure],
                           directory / result.runs[series->runs[i]].plan.directory, directory / run.plan.directory);
      if (apart.trouble.empty()) levels.push_back({series->h[i], {apart.error}});
    }
    const std::optional<Limit> limit = limit_of(levels);
    if (!limit) continue;
    known = true;
    ordered = ordered && limit->order.has_value();
    reference.uncertainty += limit->uncertainty;
    reference.source +=
        limit->order
            ? fmt::format("; its distances over {} show the order {:.2f}", result.study.axes[axis].name, *limit->order)
            : fmt::format("; its distances over {} show no order", result.study.axes[axis].name);
  }
  found.has_order = known && ordered;
  return found;
}

/// A reference that is better known: by an order where the other shows none, by less uncertainty where both do.
bool is_better(const Extrapolated& other, const Extrapolated& best) {
  return other.has_order && (!best.has_order || other.reference.uncertainty < best.reference.uncertainty);
}

}  // namespace

std::optional<SizeSeries> series_of(const StudyResult& result, std::size_t axis, const std::vector<std::size_t>& like) {
  SizeSeries series;
  series.axis = axis;
  for (std::size_t r = 0; r < result.runs.size(); ++r) {
    const StudyRun& run = result.runs[r];
    if (!run.converged() || run.record->dofs <= 0) continue;
    bool same = true;
    for (std::size_t a = 0; a < like.size(); ++a) same = same && (a == axis || run.plan.at[a] == like[a]);
    if (same) series.runs.push_back(r);
  }
  if (series.runs.size() < 2) return std::nullopt;
  const auto dofs = [&](std::size_t r) { return result.runs[r].record->dofs; };
  const bool by_unknowns = dofs(series.runs.front()) != dofs(series.runs.back());
  const StudyAxis& varied = result.study.axes[axis];
  // Numbers that are sizes of time; others, such as threads or a stiffness, say nothing of an order.
  const bool is_step = std::any_of(varied.keys.begin(), varied.keys.end(),
                                   [](const std::string& k) { return k.ends_with("time_step"); });
  // Numbers and grids are sizes; a word such as a kind of frames is another model.
  const bool sizes = std::all_of(varied.values.begin(), varied.values.end(),
                                 [](const AxisValue& v) { return v.number || v.label.starts_with('['); });
  if (!sizes || (!by_unknowns && !is_step)) return std::nullopt;
  const auto size = [&](std::size_t r) { return size_of(result, axis, result.runs[r], by_unknowns); };
  std::sort(series.runs.begin(), series.runs.end(), [&](std::size_t a, std::size_t b) { return size(a) > size(b); });
  for (const std::size_t r : series.runs) series.h.push_back(size(r));
  if (!(series.h.back() > 0) || series.h.front() <= series.h.back() * (1 + 1e-9)) return std::nullopt;
  return series;
}

ReferenceValue finest_value(const StudyResult& result, const Question& question) {
  const std::size_t measure = question.measure;
  const std::optional<std::size_t> finest = finest_run(result, question);
  if (!finest) return {{}, 0, "", "no run converged with a value", {}};
  Extrapolated best = extrapolated(result, measure, result.runs[*finest]);
  if (!best.reference.at.times.empty()) return best.reference;
  for (std::size_t r = 0; r < result.runs.size(); ++r) {
    const StudyRun& run = result.runs[r];
    if (r == *finest || !is_measured(result, question, run) || !is_finest_of_its_kind(result, r)) continue;
    Extrapolated other = extrapolated(result, measure, run);
    if (is_better(other, best)) best = std::move(other);
  }
  return best.reference;
}

ReferenceValue finest_field(StudyResult& result, const Question& question, const fs::path& directory) {
  const std::optional<std::size_t> finest = finest_run(result, question);
  if (!finest) return {{}, 0, "", "no run converged", {}};
  Extrapolated best = as_it_is(result, question, result.runs[*finest], directory);
  for (std::size_t r = 0; r < result.runs.size(); ++r) {
    if (r == *finest || !is_measured(result, question, result.runs[r]) || !is_finest_of_its_kind(result, r)) continue;
    Extrapolated other = as_it_is(result, question, result.runs[r], directory);
    if (is_better(other, best)) best = std::move(other);
  }
  return best.reference;
}

}  // namespace fascia::app
