#include "app/study/evaluation.hpp"

#include "app/study/finest.hpp"
#include "app/study/richardson.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

Spread sum_of(const Spread& a, const Spread& b) { return {a.median + b.median, a.low + b.low, a.high + b.high}; }

Spread cost_of(const RunRecord& record, StudyCost cost) {
  switch (cost) {
    case StudyCost::step:
      return record.step;
    case StudyCost::total:
      return sum_of(record.setup, record.solve);
    default:
      return record.solve;
  }
}

RunMeasure measure_field(const FieldDistance& distance) {
  if (!distance.trouble.empty()) return {{}, {}, {}, distance.trouble};
  return {{distance.root_mean}, {}, distance.error, ""};
}

void find_reference(StudyResult& result, Question& question, const fs::path& directory,
                    const std::optional<StudyRun>& run) {
  const StudyMeasure& wanted = result.study.measures[question.measure];
  ReferenceValue& reference = question.reference;
  reference = {};
  switch (wanted.reference.kind) {
    case StudyReference::Kind::none:
      reference.trouble = "the study names none";
      break;
    case StudyReference::Kind::value:
      reference.at.value = wanted.reference.value;
      reference.uncertainty = wanted.reference.uncertainty;
      reference.source = wanted.reference.source;
      break;
    case StudyReference::Kind::finest:
      reference = wanted.field.empty() ? finest_value(result, question) : finest_field(result, question, directory);
      break;
    case StudyReference::Kind::scene:
      if (!run || !run->converged()) {
        reference.trouble = "its scene did not converge: " + (run && run->record ? run->record->reason : "not run");
        break;
      }
      reference.source = wanted.reference.scene.empty() ? "the base scene" : wanted.reference.scene.string();
      for (const std::string& change : wanted.reference.overrides) reference.source += ", " + change;
      if (!wanted.field.empty()) {
        reference.directory = run->plan.directory;
        break;
      }
      reference.at = measure_run(wanted, *run->record, directory / run->plan.directory);
      if (reference.at.value.empty()) reference.trouble = fmt::format("its scene has no probe \"{}\"", wanted.probe);
      break;
  }
  if (reference.trouble.empty() && !wanted.field.empty()) {
    const fs::path there = directory / reference.directory;
    const FieldDistance& itself = result.fields.at(wanted, there, there);
    reference.trouble = itself.trouble;
    reference.at.value = {itself.root_mean};
  }
  if (reference.trouble.empty() && !(norm_of(reference.at.value) > 0))
    reference.trouble = "it is 0, of which no error is a part";
}

double uncertainty_of(const StudyResult& result, std::size_t measure, const StudyRun& run) {
  for (const Question& question : result.questions)
    if (question.measure == measure && belongs(result, question, run)) return question.reference.uncertainty;
  return 0;
}

void find_series(StudyResult& result) {
  std::vector<char> seen;
  for (std::size_t axis = 0; axis < result.study.axes.size(); ++axis) {
    seen.assign(result.runs.size(), 0);
    for (std::size_t r = 0; r < result.runs.size(); ++r) {
      if (seen[r]) continue;
      std::optional<SizeSeries> series = series_of(result, axis, result.runs[r].plan.at);
      if (!series) continue;
      for (const std::size_t other : series->runs) seen[other] = 1;
      for (std::size_t m = 0; m < result.study.measures.size(); ++m) {
        std::vector<double> h, errors;
        for (std::size_t i = 0; i < series->runs.size(); ++i) {
          const std::optional<double> error = result.runs[series->runs[i]].measured[m].error;
          // Errors near the reference's own uncertainty tell of the reference.
          if (!error || *error < 3 * uncertainty_of(result, m, result.runs[series->runs[i]])) continue;
          h.push_back(series->h[i]);
          errors.push_back(*error);
        }
        series->order.push_back(fitted_order(h, errors));
      }
      result.series.push_back(std::move(*series));
    }
  }
}

}  // namespace

std::vector<Question> questions_of(const Study& study) {
  std::vector<Question> questions;
  for (std::size_t m = 0; m < study.measures.size(); ++m) {
    const StudyMeasure& measure = study.measures[m];
    if (!measure.per) {
      questions.push_back({m, {}, measure.name, {}});
      continue;
    }
    const StudyAxis& axis = study.axes[*measure.per];
    for (std::size_t v = 0; v < axis.values.size(); ++v)
      questions.push_back({m, v, fmt::format("{}, {} {}", measure.name, axis.name, axis.values[v].label), {}});
  }
  return questions;
}

bool belongs(const StudyResult& result, const Question& question, const StudyRun& run) {
  return !question.group || run.plan.at[*result.study.measures[question.measure].per] == *question.group;
}

std::vector<std::size_t> runs_with_error(const StudyResult& result, const Question& question) {
  std::vector<std::size_t> runs;
  for (std::size_t r = 0; r < result.runs.size(); ++r)
    if (belongs(result, question, result.runs[r]) && result.runs[r].measured[question.measure].error) runs.push_back(r);
  return runs;
}

std::vector<std::size_t> front_of(const StudyResult& result, const Question& question) {
  const std::vector<std::size_t> runs = runs_with_error(result, question);
  const auto error = [&](std::size_t r) {
    return std::max(question.reference.uncertainty, *result.runs[r].measured[question.measure].error);
  };
  const auto faster = [&](std::size_t a, std::size_t b) { return result.runs[a].cost.high < result.runs[b].cost.low; };
  std::vector<std::size_t> front;
  for (const std::size_t r : runs) {
    const bool beaten = std::any_of(runs.begin(), runs.end(), [&](std::size_t other) {
      return (faster(other, r) && error(other) <= error(r)) || (!faster(r, other) && error(other) < error(r));
    });
    if (!beaten) front.push_back(r);
  }
  return front;
}

void evaluate(StudyResult& result, const fs::path& directory,
              const std::vector<std::optional<StudyRun>>& reference_runs) {
  const std::size_t measures = result.study.measures.size();
  for (StudyRun& run : result.runs) {
    run.measured.assign(measures, {});
    run.on_front.assign(measures, 0);
    if (!run.converged()) continue;
    run.cost = cost_of(*run.record, result.cost);
    for (std::size_t m = 0; m < measures; ++m)
      run.measured[m] = measure_run(result.study.measures[m], *run.record, directory / run.plan.directory);
  }
  result.series.clear();
  for (std::size_t q = 0; q < result.questions.size(); ++q) {
    Question& question = result.questions[q];
    find_reference(result, question, directory, reference_runs[q]);
    if (!question.reference.trouble.empty()) continue;
    for (StudyRun& run : result.runs) {
      if (!run.converged() || !belongs(result, question, run)) continue;
      RunMeasure& m = run.measured[question.measure];
      const StudyMeasure& wanted = result.study.measures[question.measure];
      if (wanted.field.empty())
        m.error = relative_error(m, question.reference.at);
      else
        m = measure_field(
            result.fields.at(wanted, directory / run.plan.directory, directory / question.reference.directory));
    }
    for (const std::size_t r : front_of(result, question)) result.runs[r].on_front[question.measure] = 1;
  }
  find_series(result);
}

}  // namespace fascia::app
