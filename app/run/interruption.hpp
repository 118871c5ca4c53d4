#pragma once

#include <atomic>
#include <csignal>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace fascia::app {

/// Signals that ask a run to end: SIGINT, SIGTERM and, unless it is ignored (nohup), SIGHUP. A run looks at requested()
/// between its steps; where it does not get there within a second, a function leaves its results in order, and the
/// process ends. A second signal, later than a moment, ends it at once. The exit status is 128 + the signal's number.
class Interruption {
 public:
  /// From here on these signals wait for this object: to be made before other threads are.
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// True when the run is to end; the caller then does so in its own time.
  bool requested();
  int signal() const { return signal_; }  ///< its number, 0: none
  /// Sets what leaves the results in order, on another thread than the run's; empty: nothing is to be done.
  void on_abandon(std::function<void()> abandon);

 private:
  void watch();

  sigset_t signals_{}, before_{};
  std::atomic<int> signal_{0};
  std::atomic<bool> noticed_{false}, over_{false};
  std::mutex mutex_;
  std::function<void()> abandon_;
  std::thread watcher_;
};

/// Says what is to be done where a run is abandoned, as long as this lives.
class Abandonable {
 public:
  Abandonable(Interruption& interruption, std::function<void()> abandon) : interruption_(interruption) {
    interruption_.on_abandon(std::move(abandon));
  }
  ~Abandonable() { interruption_.on_abandon({}); }
  Abandonable(const Abandonable&) = delete;
  Abandonable& operator=(const Abandonable&) = delete;

 private:
  Interruption& interruption_;
};

}  // namespace fascia::app
