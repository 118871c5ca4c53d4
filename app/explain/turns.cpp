#include "app/explain/turns.hpp"

#include "app/explain/changes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace fascia::app {
namespace {

/// A run that is refused leaves what is in its directory, which would be taken for its own.
std::optional<RunRecord> run_once(const ChildRun& run, const std::function<bool()>& stop) {
  std::error_code none;
  std::filesystem::remove_all(run.output, none);
  return record_run(run, "", false, 0, 1, stop);
}

}  // namespace

Turns run_in_turns(const ChildRun& as_it_is, const ChildRun& changed, int turns, const std::function<bool()>& stop) {
  Turns result;
  std::vector<double> solve_before, solve, setup_before, setup;
  double memory = 0, others = 0;
  for (int i = 0; i < turns; ++i) {
    const std::optional<RunRecord> before = run_once(as_it_is, stop);
    if (!before) return {};
    if (!before->converged())
      throw std::runtime_error(
          fmt::format("{}: converged before and no longer does: {}", as_it_is.scene.string(), before->reason));
    result.record = run_once(changed, stop);
    if (!result.record || !result.record->converged()) return result;
    solve_before.push_back(before->solve.median);
    setup_before.push_back(before->setup.median);
    solve.push_back(result.record->solve.median);
    setup.push_back(result.record->setup.median);
    memory = std::max(memory, result.record->memory);
    others = std::max({others, before->others, result.record->others});
  }
  result.solve = ratio_of_pairs(solve, solve_before);
  result.setup = ratio_of_pairs(setup, setup_before);
  result.record->solve = spread_of(std::move(solve));
  result.record->setup = spread_of(std::move(setup));
  result.record->memory = memory;
  result.record->others = others;
  result.record->repeats = turns;
  return result;
}

}  // namespace fascia::app
