#include "app/interruption.hpp"

#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <utility>

namespace fascia::app {
namespace {

constexpr long kPatience = 700'000'000;  // [ns]

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
}

Interruption::~Interruption() {
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
  do {
    const int second = sigtimedwait(&signals_, nullptr, &patience);
    if (over_) return;
    if (second > 0) _exit(128 + second);
  } while (noticed_ || errno == EINTR);
  const std::lock_guard lock(mutex_);
  if (abandon_) abandon_();
  _exit(128 + first);
}

}  // namespace fascia::app
