#include "app/run/interruption.hpp"

#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <ctime>
#include <utility>

namespace fascia::app {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kSameRequest{300};  // "timeout" sends one signal to a program and another to its group
constexpr long kPatience = 700'000'000;    // [ns]
constexpr time_t kForResults = 6;          // to leave results in order [s]

std::atomic<pthread_t> watcher_of_all{};

/// On a thread that is older than main, which libraries may start: passes the signal on.
void pass_on(int signal) { pthread_kill(watcher_of_all, signal); }

bool is_ignored(int signal) {
  struct sigaction action {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

}  // namespace

Interruption::Interruption() {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGINT);
  sigaddset(&signals_, SIGTERM);
  if (!is_ignored(SIGHUP)) sigaddset(&signals_, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &signals_, &before_);
  watcher_ = std::thread([this] { watch(); });
  watcher_of_all = watcher_.native_handle();
  struct sigaction action {};
  action.sa_handler = pass_on;
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    if (sigismember(&signals_, signal) == 1) sigaction(signal, &action, nullptr);
}

Interruption::~Interruption() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    if (sigismember(&signals_, signal) == 1) std::signal(signal, SIG_DFL);
  over_ = true;
  pthread_kill(watcher_.native_handle(), SIGINT);
  watcher_.join();
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

bool Interruption::requested() {
  if (signal_ == 0) return false;
  noticed_ = true;
  return true;
}

void Interruption::on_abandon(std::function<void()> abandon) {
  const std::lock_guard lock(mutex_);
  abandon_ = std::move(abandon);
}

void Interruption::watch() {
  int first = 0;
  if (sigwait(&signals_, &first) != 0 || over_) return;
  signal_ = first;
  const timespec patience{0, kPatience};
  const steady_clock::time_point asked = steady_clock::now();
  for (bool waits = true; waits;) {
    const int next = sigtimedwait(&signals_, nullptr, &patience);
    waits = next > 0 || noticed_ || errno == EINTR;
    if (over_) return;
    if (next > 0 && steady_clock::now() - asked > kSameRequest) _exit(128 + next);
  }
  // On another thread, so that a second signal, or a disk that does not answer, ends the process all the same.
  std::thread([this, first] {
    const std::lock_guard lock(mutex_);
    if (abandon_) abandon_();
    _exit(128 + first);
  }).detach();
  const timespec rest{kForResults, 0};
  const int second = sigtimedwait(&signals_, nullptr, &rest);
  _exit(128 + (second > 0 ? second : first));
}

}  // namespace fascia::app
