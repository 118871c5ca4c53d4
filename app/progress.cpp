#include "app/progress.hpp"
#include "app/messages.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace fascia::app {

Progress::Progress(bool quiet, bool verbose)
    : quiet_(quiet), verbose_(verbose), terminal_(isatty(STDERR_FILENO) != 0), start_(Clock::now()), last_(start_) {}

void Progress::update(const StepInfo& step) {
  if (quiet_) return;
  const Clock::time_point now = Clock::now();
  const double since = std::chrono::duration<double>(now - last_).count();
  if (verbose_) {
    say("step {} (t = {:.6g}): {} Newton iterations, {} linear, residual {:.2e}, {:.3f} s{}\n", step.step, step.time,
        step.newton.iterations, step.newton.linear_iterations, step.newton.last.relative, step.seconds,
        step.newton.trouble.empty() ? "" : "; " + step.newton.trouble);
    return;
  }
  if (since < (terminal_ ? 0.1 : 5.0)) return;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double left = step.progress > 0 ? elapsed * (1 - step.progress) / step.progress : 0;
  const std::string text = fmt::format(
      "{:3.0f} %  step {} (t = {:.4g})  residual {:.1e}  {:.3g} steps/s  {:.0f} s left", 100 * step.progress, step.step,
      step.time, step.newton.last.relative, (step.step - last_step_) / since, left);
  if (terminal_) {
    constexpr int kWidth = 24;
    const int full = static_cast<int>(kWidth * step.progress);
    say("\r[{:=<{}}{: <{}}] {}\x1b[K", "", full, "", kWidth - full, text);
    drawn_ = true;
  } else {
    say("{}\n", text);
  }
  std::fflush(stderr);
  last_ = now;
  last_step_ = step.step;
}

void Progress::finish() {
  if (drawn_) say("\r\x1b[K");
  drawn_ = false;
}

}  // namespace fascia::app
