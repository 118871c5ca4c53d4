#include "app/explain/turns.hpp"

#include "app/explain/changes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace fascia::app {
namespace {

/// A change that takes this many times as long as the scene as it is, and these seconds at least, tells no more.
constexpr double kTooLong = 5, kLeastLimit = 5;

/// Gains that remain vague are measured so many times as often. The extremes of n pairs hold the median of all but once
/// in 2^(n - 1): of three pairs once in 4, of six once in 32.
constexpr int kMoreTurns = 2;

/// Pairs spread over more than half of what they gain.
bool is_vague(const Ratio& r) { return r.median < 1 && 2 * (r.high - r.low) > 1 - r.median; }

/// The two times that are compared; of runs on one thread they are those of the processor's clock.
std::pair<double, double> times_of(const RunRecord& changed, const RunRecord& before) {
  if (is_serial(changed) && is_serial(before)) return {changed.processor.median, before.processor.median};
  return {changed.solve.median, before.solve.median};
}

/// The median and the extremes of several equal runs are known.
std::vector<double> known(const Spread& s, int repeats) {
  return repeats > 1 ? std::vector<double>{s.low, s.median, s.high} : std::vector<double>{s.median};
}

}  // namespace

bool is_serial(const RunRecord& record) {
  constexpr double resolved = 0.1;  // some systems count a process's time in hundredths of a second, or not at all
  return record.threads == 1 && record.backend == "cpu" && record.processor.median >= resolved;
}

Turns::Turns(ChildRun as_it_is, ChildRun changed, const RunRecord& base, std::function<bool()> stop)
    : as_it_is_(std::move(as_it_is)),
      changed_(std::move(changed)),
      stop_(std::move(stop)),
      solve_(known(base.solve, base.repeats)),
      setup_(known(base.setup, base.repeats)),
      processor_(known(base.processor, base.repeats)),
      before_(base),
      others_(base.others) {
  changed_.processor_limit = std::max(kLeastLimit, kTooLong * base.processor_seconds);
}

std::optional<RunRecord> Turns::run_once(const ChildRun& run) {
  // A run that is refused leaves what is in its directory, which would be taken for its own.
  std::error_code none;
  std::filesystem::remove_all(run.output, none);
  std::optional<RunRecord> record = record_run(run, "", false, 0, 1, stop_);
  if (record) others_ = std::max(others_, record->others);
  return record;
}

bool Turns::run_as_it_is() {
  std::optional<RunRecord> record = run_once(as_it_is_);
  if (!record) return false;
  if (!record->converged())
    throw std::runtime_error(
        fmt::format("{}: converged before and no longer does: {}", as_it_is_.scene.string(), record->reason));
  solve_.push_back(record->solve.median);
  setup_.push_back(record->setup.median);
  processor_.push_back(record->processor.median);
  before_ = std::move(*record);
  uses_ = 0;
  return true;
}

std::optional<RunRecord> Turns::run_changed(const std::vector<std::string>& changes) {
  ChildRun run = changed_;
  run.overrides.insert(run.overrides.end(), changes.begin(), changes.end());
  std::optional<RunRecord> record = run_once(run);
  ++uses_;
  if (record && record->status == "time limit") record->reason += ", far more than the scene as it is";
  return record;
}

Timed Turns::once(const std::vector<std::string>& changes) {
  Timed result;
  if ((uses_ == 0 || uses_ >= 2) && !run_as_it_is()) return result;
  result.record = run_changed(changes);
  if (!result.record || !result.record->converged()) return result;
  const auto [time, before] = times_of(*result.record, before_);
  result.solve = ratio_of_pairs({time}, {before});
  result.setup = ratio_of_pairs({result.record->setup.median}, {before_.setup.median});
  return result;
}

Timed Turns::several(const std::vector<std::string>& changes, int turns) {
  Timed result;
  std::vector<double> time_before, time, solve, processor, setup_before, setup;
  double memory = 0, others = 0;
  for (int i = 0, all = turns; i < all; ++i) {
    if (!run_as_it_is()) {
      if (i < turns) return {};
      break;
    }
    result.record = run_changed(changes);
    if (!result.record || !result.record->converged()) return result;
    const RunRecord& record = *result.record;
    const auto [after, before] = times_of(record, before_);
    time.push_back(after);
    time_before.push_back(before);
    solve.push_back(record.solve.median);
    processor.push_back(record.processor.median);
    setup.push_back(record.setup.median);
    setup_before.push_back(before_.setup.median);
    memory = std::max(memory, record.memory);
    others = std::max(others, record.others);
    if (i + 1 == turns && is_vague(ratio_of_pairs(time, time_before))) all = kMoreTurns * turns;
  }
  result.solve = ratio_of_pairs(time, time_before);
  result.setup = ratio_of_pairs(setup, setup_before);
  result.record->solve = spread_of(std::move(solve));
  result.record->processor = spread_of(std::move(processor));
  result.record->setup = spread_of(std::move(setup));
  result.record->memory = memory;
  result.record->others = others;
  result.record->repeats = static_cast<int>(time.size());
  return result;
}

}  // namespace fascia::app
