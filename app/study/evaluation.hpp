#pragma once

#include "app/study/field_measure.hpp"
#include "app/study/plan.hpp"
#include "app/study/record.hpp"

#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

/// A measure of one run. The value of a field is its root mean square over the body.
struct RunMeasure {
  std::vector<double> value;    ///< empty: the run has none
  std::vector<double> times;    ///< of a curve [s]: as many blocks of `value`
  std::optional<double> error;  ///< |value − reference| / |reference|; none without either
  std::string trouble;          ///< why a field has no error
};

/// A run with its outcome.
struct StudyRun {
  PlannedRun plan;
  std::optional<RunRecord> record;   ///< none: not run (refused, left out, interrupted)
  std::vector<RunMeasure> measured;  ///< by measure
  Spread cost;                       ///< by Study::cost [s]
  std::vector<char> on_front;        ///< by measure: nothing is better and cheaper

  bool converged() const { return record && record->converged(); }
};

/// The value that errors of a measure are distances from.
struct ReferenceValue {
  RunMeasure at;
  double uncertainty = 0;           ///< relative; 0 where nothing is known of it
  std::string source;               ///< in words
  std::string trouble;              ///< why there is none; empty where there is one
  std::filesystem::path directory;  ///< of the run whose field it is, within the study's; of fields alone
};

/// A measure with the runs that share a reference: all, or those of one value of StudyMeasure::per.
struct Question {
  std::size_t measure = 0;
  std::optional<std::size_t> group;  ///< index of that value
  std::string name;                  ///< "tip", "tip, poisson 0.3"
  ReferenceValue reference;
};

/// Runs that differ in one axis alone, by which unknowns or time steps change: errors over them show an order.
struct SizeSeries {
  std::size_t axis = 0;
  std::vector<std::size_t> runs;             ///< of decreasing h
  std::vector<double> h;                     ///< of each: unknowns^(-1/dimension), or the axis's own number
  std::vector<std::optional<double>> order;  ///< by measure
};

struct StudyResult {
  Study study;
  std::vector<StudyRun> runs;
  std::vector<Question> questions;
  std::vector<SizeSeries> series;
  int dimension = 3;
  StudyCost cost = StudyCost::solve;
  bool interrupted = false;
  FieldDistances fields;  ///< that were computed
};

/// Reads what a measure of a probe asks for from a result. @param directory  of the run
RunMeasure measure_run(const StudyMeasure& measure, const RunRecord& record, const std::filesystem::path& directory);

/// Distance of two values relative to the second, both at their times: the curve of the reference is interpolated.
/// @return none where they do not fit together, or the reference is 0
std::optional<double> relative_error(const RunMeasure& value, const RunMeasure& reference);

/// The questions of a study, without their references.
std::vector<Question> questions_of(const Study& study);

/// A run is compared with the reference of a question.
bool belongs(const StudyResult& result, const Question& question, const StudyRun& run);

/// Runs of a question that have an error, in the order of the study.
std::vector<std::size_t> runs_with_error(const StudyResult& result, const Question& question);

/// Fills in measures, references, errors, fronts, series. @param directory  of the study
/// @param reference_runs  by question; none where its reference needs no run
void evaluate(StudyResult& result, const std::filesystem::path& directory,
              const std::vector<std::optional<StudyRun>>& reference_runs);

/// Runs of a question of which none is better: no other has both a cost that is lower by more than the spread and an
/// error that is not larger. Errors below the reference's uncertainty are equal.
std::vector<std::size_t> front_of(const StudyResult& result, const Question& question);

}  // namespace fascia::app
