#include "app/study/child_run.hpp"

#include "app/results/provenance.hpp"
#include "core/base/clock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <exception>
#include <fstream>
#include <mutex>
#include <system_error>
#include <thread>

namespace fascia::app {
namespace {

/// A file without a name that takes what a child says.
class Words {
 public:
  Words() : file_(memfd_create("words", MFD_CLOEXEC)) {
    if (file_ < 0) throw std::system_error(errno, std::generic_category(), "a file for messages");
  }
  ~Words() { close(file_); }
  Words(const Words&) = delete;
  Words& operator=(const Words&) = delete;
  int descriptor() const { return file_; }

  /// The last lines, joined: errors stand at the end, behind warnings.
  std::string last_lines() const {
    constexpr off_t most = 2000;
    const off_t size = lseek(file_, 0, SEEK_END);
    std::string text(static_cast<std::size_t>(std::min(size, most)), ' ');
    const ssize_t got = pread(file_, text.data(), text.size(), std::max<off_t>(0, size - most));
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(0, got)));
    while (!text.empty() && text.back() == '\n') text.pop_back();
    const std::size_t line = text.find_last_of('\n');
    return line == std::string::npos ? text : text.substr(line + 1);
  }

 private:
  int file_;
};

std::vector<std::string> arguments_of(const ChildRun& run) {
  std::vector<std::string> words = first_words_of_command();
  words.insert(words.end(), {"run", run.scene.string(), "--quiet", "--output", run.output.string()});
  for (const std::string& change : run.overrides) {
    words.emplace_back("--set");
    words.push_back(change);
  }
  words.insert(words.end(), {"--set", "output.cache=false"});  // set-up is timed: samples are made each time
  if (run.threads) words.insert(words.end(), {"--threads", std::to_string(*run.threads)});
  if (run.backend) words.insert(words.end(), {"--backend", *run.backend});
  return words;
}

/// Between fork and exec, of a process that may have threads: nothing here takes memory or a lock.
[[noreturn]] void become(const std::vector<char*>& words, const ChildRun& run, int messages, int nothing) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  if (run.memory_limit > 0) {
    const auto bytes = static_cast<rlim_t>(run.memory_limit);
    const rlimit limit{bytes, bytes};
    setrlimit(RLIMIT_DATA, &limit);  // not of addresses: the driver of a GPU reserves more of them than there is memory
  }
  if (run.processor_limit > 0) {
    const auto seconds = static_cast<rlim_t>(std::ceil(run.processor_limit));
    const rlimit limit{seconds, seconds + 5}, no_core{0, 0};
    setrlimit(RLIMIT_CPU, &limit);
    setrlimit(RLIMIT_CORE, &no_core);
  }
  dup2(nothing, STDIN_FILENO);
  dup2(nothing, STDOUT_FILENO);
  dup2(messages, STDERR_FILENO);
  execv("/proc/self/exe", words.data());
  _exit(127);
}

double seconds_of(const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); }

nlohmann::ordered_json summary_in(const std::filesystem::path& directory) {
  std::ifstream file(directory / "summary.json");
  if (!file) return nullptr;
  auto summary = nlohmann::ordered_json::parse(file, nullptr, false);
  return summary.is_object() ? summary : nlohmann::ordered_json(nullptr);
}

}  // namespace

std::string ChildResult::status() const {
  if (timed_out) return "time limit";
  return summary.is_object() ? summary.value("status", "refused") : "refused";
}

ChildResult run_child(const ChildRun& run, const std::function<bool()>& stop) {
  const Words messages;
  std::vector<std::string> texts = arguments_of(run);
  std::vector<char*> words;
  words.reserve(texts.size() + 1);
  for (std::string& text : texts) words.push_back(text.data());
  words.push_back(nullptr);
  const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
  const Clock::time_point start = Clock::now();
  const pid_t child = fork();
  if (child == 0) become(words, run, messages.descriptor(), nothing);
  if (nothing >= 0) close(nothing);
  if (child < 0) throw std::system_error(errno, std::generic_category(), "a run cannot be started");

  ChildResult result;
  int state = 0;
  rusage used{};
  bool asked = false;
  // Looked at often at first: many runs take milliseconds.
  for (auto pause = std::chrono::microseconds(500);; pause = std::min(pause * 2, std::chrono::microseconds(20000))) {
    const pid_t ended = wait4(child, &state, WNOHANG, &used);
    if (ended == child || (ended < 0 && errno != EINTR)) break;
    const double seconds = seconds_since(start);
    result.timed_out = result.timed_out || (run.time_limit > 0 && seconds > run.time_limit);
    if (!asked && (result.timed_out || (stop && stop()))) {
      kill(child, SIGTERM);
      asked = true;
    }
    if (result.timed_out && seconds > run.time_limit + 5) kill(child, SIGKILL);
    std::this_thread::sleep_for(pause);
  }
  result.seconds = seconds_since(start);
  result.processor_seconds = seconds_of(used.ru_utime) + seconds_of(used.ru_stime);
  result.exit_status = WIFEXITED(state) ? WEXITSTATUS(state) : 128 + WTERMSIG(state);
  result.summary = summary_in(run.output);
  const bool spent = WIFSIGNALED(state) && WTERMSIG(state) == SIGXCPU;
  if (spent)
    result.message = fmt::format("took more than {:.0f} s of processor time", std::ceil(run.processor_limit));
  else if (result.timed_out)
    result.message = fmt::format("did not end within {:g} s", run.time_limit);
  else if (result.exit_status != 0) {
    if (result.summary.is_object()) result.message = result.summary.value("message", "");
    if (result.message.empty()) result.message = messages.last_lines();
    if (result.message.empty()) result.message = fmt::format("ended with status {}", result.exit_status);
  }
  result.timed_out = result.timed_out || spent;
  return result;
}

void at_once(std::size_t count, int parallel, const std::function<void(std::size_t)>& work,
             const std::function<bool()>& stop) {
  std::atomic<std::size_t> next{0};
  std::mutex failing;
  std::exception_ptr error;
  const auto take = [&] {
    for (std::size_t i = next++; i < count && !(stop && stop()); i = next++) {
      try {
        work(i);
      } catch (...) {
        const std::lock_guard lock(failing);
        if (!error) error = std::current_exception();
        next = count;
      }
    }
  };
  // The caller takes part: a child ends with the thread that started it.
  std::vector<std::thread> others;
  for (int i = 1; i < parallel; ++i) others.emplace_back(take);
  take();
  for (std::thread& other : others) other.join();
  if (error) std::rethrow_exception(error);
}

void run_children(const std::vector<ChildRun>& runs, int parallel,
                  const std::function<void(std::size_t, ChildResult)>& done, const std::function<bool()>& stop) {
  std::mutex telling;
  at_once(
      runs.size(), parallel,
      [&](std::size_t i) {
        ChildResult result = run_child(runs[i], stop);
        const std::lock_guard lock(telling);
        done(i, std::move(result));
      },
      stop);
}

}  // namespace fascia::app
