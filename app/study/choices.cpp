#include "app/study/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

/// Decades that lie within the range of some values; where none does, the one above the least.
std::vector<double> decades(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !(v > 0); });
  if (values.empty()) return {};
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  std::vector<double> found;
  for (double d = std::pow(10, std::ceil(std::log10(*low))); d <= *high * (1 + 1e-9); d *= 10) found.push_back(d);
  if (found.empty()) found.push_back(std::pow(10, std::ceil(std::log10(*low))));
  return found;
}

template <class Amount>
std::vector<Budget> budgets_of(const StudyResult& result, const Question& question, std::vector<double> limits,
                               const Amount& amount) {
  const std::vector<std::size_t> runs = runs_with_error(result, question);
  const auto error = [&](std::size_t r) { return *result.runs[r].measured[question.measure].error; };
  std::vector<double> amounts;
  amounts.reserve(runs.size());
  for (const std::size_t r : runs) amounts.push_back(amount(result.runs[r]));
  if (limits.empty()) limits = decades(amounts);
  std::sort(limits.begin(), limits.end());
  std::vector<Budget> budgets;
  for (const double limit : limits) {
    Budget& budget = budgets.emplace_back();
    budget.limit = limit;
    for (const std::size_t r : runs)
      if (amount(result.runs[r]) <= limit && (!budget.best || error(r) < error(*budget.best))) budget.best = r;
  }
  return budgets;
}

}  // namespace

std::optional<Choices> choices_of(const StudyResult& result, const Question& question) {
  const std::vector<std::size_t> runs = runs_with_error(result, question);
  if (runs.empty()) return std::nullopt;
  const auto cost = [&](std::size_t r) { return result.runs[r].cost.median; };
  const auto error = [&](std::size_t r) { return *result.runs[r].measured[question.measure].error; };
  const auto cheaper = [&](std::size_t a, std::size_t b) { return cost(a) < cost(b); };
  Choices choices;
  choices.fastest = *std::min_element(runs.begin(), runs.end(), cheaper);
  choices.most_accurate =
      *std::min_element(runs.begin(), runs.end(), [&](std::size_t a, std::size_t b) { return error(a) < error(b); });
  if (result.study.need) {
    std::vector<std::size_t> enough;
    std::copy_if(runs.begin(), runs.end(), std::back_inserter(enough),
                 [&](std::size_t r) { return error(r) <= *result.study.need; });
    choices.chosen = enough.empty() ? choices.most_accurate : *std::min_element(enough.begin(), enough.end(), cheaper);
    return choices;
  }
  // log(time) + log(error) is least where the front has the slope −1: beyond, a factor of error costs more of time.
  const double floor = std::max(question.reference.uncertainty, 1e-12);
  const auto weight = [&](std::size_t r) {
    return std::log(std::max(cost(r), 1e-9)) + std::log(std::max(error(r), floor));
  };
  choices.chosen =
      *std::min_element(runs.begin(), runs.end(), [&](std::size_t a, std::size_t b) { return weight(a) < weight(b); });
  return choices;
}

std::vector<Budget> by_cost(const StudyResult& result, const Question& question) {
  return budgets_of(result, question, result.study.budgets, [](const StudyRun& run) { return run.cost.median; });
}

std::vector<Budget> by_unknowns(const StudyResult& result, const Question& question) {
  return budgets_of(result, question, result.study.sizes,
                    [](const StudyRun& run) { return static_cast<double>(run.record->dofs); });
}

std::string seconds_text(double seconds) {
  if (seconds >= 100) return fmt::format("{:.0f} s", seconds);
  if (seconds >= 1) return fmt::format("{:.3g} s", seconds);
  if (seconds >= 1e-3) return fmt::format("{:.3g} ms", 1e3 * seconds);
  return fmt::format("{:.3g} µs", 1e6 * seconds);
}

std::string error_text(double error) {
  return error >= 1e-4 ? fmt::format("{:.2g} %", 100 * error) : fmt::format("{:.1e}", error);
}

std::string uncertainty_text(const StudyResult& result, const Question& question) {
  if (question.reference.uncertainty > 0) return error_text(question.reference.uncertainty);
  const bool given = result.study.measures[question.measure].reference.kind == StudyReference::Kind::value;
  return given ? "exact" : "unknown";
}

std::string cost_name(StudyCost cost) {
  switch (cost) {
    case StudyCost::step:
      return "median step";
    case StudyCost::total:
      return "set-up and solve";
    default:
      return "solve";
  }
}

std::string label_of(const StudyResult& result, const StudyRun& run) {
  std::string label;
  for (std::size_t a = 0; a < run.plan.at.size(); ++a)
    label += fmt::format("{}{} {}", a == 0 ? "" : ", ", result.study.axes[a].name,
                         result.study.axes[a].values[run.plan.at[a]].label);
  return label;
}

}  // namespace fascia::app
