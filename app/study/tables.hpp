#pragma once

#include "app/study/evaluation.hpp"

#include <string>

namespace fascia::app {

/// study.csv: a row for each combination, also those that were not run or failed.
std::string csv_of(const StudyResult& result);

/// study.json: study, machine, references, every run, fronts, orders and choices.
nlohmann::ordered_json json_of(const StudyResult& result);

/// For the terminal: of each measure its reference, its front, and the smallest errors at round costs and sizes.
std::string text_of(const StudyResult& result);

/// Runs whose field has no error, each with the reason.
std::vector<std::string> troubles_of(const StudyResult& result, const Question& question);

/// The values of a run's axes: "grid [9, 3, 3], threads 1".
std::string label_of(const StudyResult& result, const StudyRun& run);

/// Runs that a reader looks for, by one question: the least cost, the least error, and the best choice, which is the
/// cheapest below Study::need or, without it, the one of the front where a further factor of error costs more than a
/// factor of time.
struct Choices {
  std::size_t fastest = 0, most_accurate = 0, chosen = 0;
};
std::optional<Choices> choices_of(const StudyResult& result, const Question& question);

/// The least error at a cost or size that is not exceeded.
struct Budget {
  double limit = 0;
  std::optional<std::size_t> best;  ///< run; none: nothing is that cheap
};
std::vector<Budget> by_cost(const StudyResult& result, const Question& question);
std::vector<Budget> by_unknowns(const StudyResult& result, const Question& question);

/// "1.2 ms", "35 s"; "3.2 %", "4e-05"
std::string seconds_text(double seconds);
std::string error_text(double error);
std::string cost_name(StudyCost cost);
/// "0.2 %", "exact", "unknown"
std::string uncertainty_text(const StudyResult& result, const Question& question);

}  // namespace fascia::app
