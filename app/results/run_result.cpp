#include "app/results/run_result.hpp"

#include "app/results/provenance.hpp"
#include "app/results/run_text.hpp"
#include "io/files.hpp"

#include <chrono>
#include <exception>

namespace fascia::app {
namespace {

constexpr double kWriteEvery = 1;  // [s]
constexpr std::chrono::seconds kPatience{5};

io::ResultNames names_of(const Simulation& s) {
  io::ResultNames names{s.scene.path.stem().string(), {}};
  for (const SimulatedBody& b : s.bodies) names.bodies.push_back(b.name);
  return names;
}

}  // namespace

RunResult::RunResult(const Simulation& simulation)
    : running_(running_summary(simulation, provenance_of(simulation))),
      directory_(simulation.scene.output.directory, names_of(simulation)),
      files_(simulation, directory_.path(), simulation.scene.path.stem().string(), json_text(provenance())),
      started_(Clock::now()),
      written_(started_) {
  write(running_);
  files_.open();
}

void RunResult::write(const nlohmann::ordered_json& summary) const {
  io::replace_file(directory_.path() / "summary.json", json_text(summary) + "\n");
}

void RunResult::add_probes(double time, const ProbeValues& values, double time_step) {
  const std::lock_guard lock(writing_);
  files_.add_probes(time, values, time_step);
  has_rows_ = true;
}

void RunResult::add_state(double time, const State& state) {
  const std::lock_guard lock(writing_);
  files_.add_state(time, state);
  directory_.show();
}

std::vector<std::string> RunResult::add_failed(const Failure& failure) {
  const std::lock_guard lock(writing_);
  return files_.add_failed(failure);
}

void RunResult::note(const StepInfo& step) {
  steps_ = step.step;
  time_ = step.time;
  progress_ = step.progress;
  if (seconds_since(written_) < kWriteEvery) return;
  const std::lock_guard lock(writing_);
  tell_progress();
  running_["seconds_left"] = step.progress > 0 ? seconds_since(started_) * (1 - step.progress) / step.progress : 0;
  write(running_);
  files_.synchronise();
  written_ = Clock::now();
}

void RunResult::tell_progress() {
  running_["steps"] = steps_.load();
  running_["time"] = time_.load();
  running_["progress"] = progress_.load();
}

void RunResult::finish(const nlohmann::ordered_json& summary) {
  const std::lock_guard lock(writing_);
  write(summary);
  finished_ = true;
  directory_.keep();
  files_.synchronise();
}

void RunResult::end(RunStatus status, const std::string& why) noexcept {
  const std::lock_guard lock(writing_);
  end_unlocked(status, why);
}

void RunResult::end_unlocked(RunStatus status, const std::string& why) noexcept {
  if (finished_) return;
  try {
    running_["status"] = status_name(status);
    running_["message"] = why;
    tell_progress();
    running_.erase("seconds_left");
    if (has_rows_) directory_.keep();
    if (directory_.shown()) write(running_);
  } catch (const std::exception&) {  // the summary stays as it was: "running"
  }
}

bool RunResult::abandon() noexcept {
  try {
    std::unique_lock lock(writing_, kPatience);
    if (!lock) return shown();
    const bool saved = shown();
    if (!finished_) directory_.keep();
    end_unlocked(RunStatus::interrupted, "interrupted within a step");
    directory_.leave();
    lock.release();  // for good: the run, which goes on until the process ends, writes nothing more
    return saved;
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace fascia::app
