#include "app/run/progress.hpp"
#include "app/run/messages.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace fascia::app {
namespace {

double seconds(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

}  // namespace

Progress::Progress(bool quiet, bool verbose, bool statics, std::optional<double> every)
    : quiet_(quiet),
      verbose_(verbose),
      statics_(statics),
      terminal_(isatty(STDERR_FILENO) != 0),
      every_(every.value_or(terminal_ ? 0.1 : 5.0)),
      start_(Clock::now()),
      last_(start_),
      step_start_(start_),
      step_shown_(start_) {}

Progress::~Progress() { finish(); }

void Progress::update(const StepInfo& step) {
  if (quiet_) return;
  std::unique_lock lock(showing_, std::defer_lock);
  if (watcher_.joinable()) lock.lock();
  iteration_.reset();
  const Clock::time_point now = Clock::now();
  const double since = seconds(step_shown_, now);
  step_start_ = now;
  done_ = step.progress;
  if (verbose_) {
    clear();
    say("{}: {} Newton iterations, {} linear, residual {:.2e}, {:.3f} s{}\n", name_of(step.step, step.time),
        step.newton.iterations, step.newton.linear_iterations, step.newton.last.relative, step.seconds,
        step.newton.trouble.empty() ? "" : "; " + step.newton.trouble);
    return;
  }
  if (since < every_) return;
  const double elapsed = seconds(start_, now);
  const double left = step.progress > 0 ? elapsed * (1 - step.progress) / step.progress : 0;
  show(fmt::format("{}  residual {:.1e}  {:.3g} steps/s  {:.0f} s left", name_of(step.step, step.time),
                   step.newton.last.relative, (step.step - last_step_) / since, left));
  step_shown_ = now;
  last_step_ = step.step;
}

void Progress::update(const IterationInfo& iteration) {
  if (quiet_) return;
  const std::lock_guard lock(showing_);
  iteration_ = iteration;
  show_iteration();
  if (!watcher_.joinable()) watcher_ = std::thread([this] { watch(); });
}

void Progress::watch() {
  const std::chrono::duration<double> beat(std::max(0.2, every_ / 5));
  std::unique_lock lock(showing_);
  while (!wake_.wait_for(lock, beat, [this] { return ended_; }))
    if (iteration_) show_iteration();
}

void Progress::show_iteration() {
  const Clock::time_point now = Clock::now();
  if (seconds(std::max(last_, step_start_), now) < every_) return;
  const IterationInfo& i = *iteration_;
  show(fmt::format("{}  Newton iteration {}  residual {:.1e}, to be {:.1e}  {:.0f} s", name_of(i.step, i.time),
                   i.iteration, i.relative, i.tolerance, seconds(step_start_, now)));
  last_ = now;
}

std::string Progress::name_of(int step, double time) const {
  return statics_ ? fmt::format("load step {} (factor {:.4g})", step, time)
                  : fmt::format("step {} (t = {:.{}g})", step, time, verbose_ ? 6 : 4);
}

void Progress::show(const std::string& text) {
  if (terminal_) {
    constexpr int kWidth = 24;
    const int full = static_cast<int>(kWidth * done_);
    say("\r[{:=<{}}{: <{}}] {:3.0f} %  {}\x1b[K", "", full, "", kWidth - full, 100 * done_, text);
    drawn_ = true;
  } else {
    say("{:3.0f} %  {}\n", 100 * done_, text);
  }
  std::fflush(stderr);
}

void Progress::clear() {
  if (drawn_) say("\r\x1b[K");
  drawn_ = false;
}

void Progress::finish() {
  if (watcher_.joinable()) {
    {
      const std::lock_guard lock(showing_);
      ended_ = true;
    }
    wake_.notify_one();
    watcher_.join();
  }
  clear();
}

}  // namespace fascia::app
