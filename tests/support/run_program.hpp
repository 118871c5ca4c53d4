#pragma once

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace fascia::test {

/// How a program ended and what it said.
struct ProgramResult {
  int status = -1;  ///< exit status; 128 + number of the signal that ended it
  std::string out, err;
  bool timed_out = false;  ///< it was killed at the time limit
};

struct ProgramOptions {
  std::filesystem::path directory = ".";  ///< working directory
  std::vector<std::string> environment;   ///< "NAME=value", beside what this process has; wins over it
  std::chrono::milliseconds timeout{60'000};
  int signal = 0;  ///< sent once after `signal_after`; 0: none
  std::chrono::milliseconds signal_after{0};
};

namespace detail {

/// Both ends of a pipe, closed on exec and on leaving the scope.
struct Pipe {
  std::array<int, 2> ends{-1, -1};
  Pipe() {
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("pipe: " + std::string(std::strerror(errno)));
  }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void close_end(std::size_t end) {
    if (ends[end] >= 0) close(ends[end]);
    ends[end] = -1;
  }
};

/// Appends what the pipe holds; closes it at its end.
inline void drain(Pipe& pipe, std::string& text) {
  std::array<char, 4096> buffer;
  const ssize_t count = read(pipe.ends[0], buffer.data(), buffer.size());
  if (count > 0) {
    text.append(buffer.data(), static_cast<std::size_t>(count));
  } else if (count == 0 || errno != EINTR) {
    pipe.close_end(0);
  }
}

/// This process's environment with `extra` in front, so that its values are found first.
inline std::vector<std::string> merged_environment(const std::vector<std::string>& extra) {
  std::vector<std::string> merged = extra;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    const std::string name = text.substr(0, text.find('=') + 1);
    bool replaced = false;
    for (const std::string& other : extra) replaced = replaced || other.starts_with(name);
    if (!replaced) merged.push_back(text);
  }
  return merged;
}

/// The array of pointers that exec wants; valid as long as `texts` is.
inline std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  for (std::string& text : texts) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

/// Starts args[0] (looked up in PATH) with no standard input, in its directory, writing into the pipes.
inline pid_t start(std::vector<std::string> args, const ProgramOptions& options, const Pipe& out, const Pipe& err) {
  std::vector<std::string> environment = merged_environment(options.environment);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out.ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err.ends[1], STDERR_FILENO);
  posix_spawn_file_actions_addchdir_np(&actions, options.directory.c_str());
  pid_t child = 0;
  const int error =
      posix_spawnp(&child, args[0].c_str(), &actions, nullptr, pointers(args).data(), pointers(environment).data());
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::runtime_error("run_program: cannot start " + args[0] + ": " + std::strerror(error));
  return child;
}

}  // namespace detail

/// Runs a program to its end, collecting standard output and standard error.
/// @param args  program (a path, or a name looked up in PATH) and its arguments
/// @throws std::runtime_error  where it cannot be started
inline ProgramResult run_program(const std::vector<std::string>& args, const ProgramOptions& options = {}) {
  using Clock = std::chrono::steady_clock;
  detail::Pipe out, err;
  const auto started = Clock::now();
  const pid_t child = detail::start(args, options, out, err);
  out.close_end(1);
  err.close_end(1);

  ProgramResult result;
  bool signalled = options.signal == 0;
  int wait_status = 0;
  bool ended = false;
  while (!ended || out.ends[0] >= 0 || err.ends[0] >= 0) {
    const auto elapsed = Clock::now() - started;
    if (!ended && !signalled && elapsed >= options.signal_after) {
      kill(child, options.signal);
      signalled = true;
    }
    if (!ended && !result.timed_out && elapsed >= options.timeout) {
      kill(child, SIGKILL);
      result.timed_out = true;
    }
    std::array<pollfd, 2> watched{pollfd{out.ends[0], POLLIN, 0}, pollfd{err.ends[0], POLLIN, 0}};  // poll skips -1
    poll(watched.data(), watched.size(), 10);
    if (watched[0].revents != 0) detail::drain(out, result.out);
    if (watched[1].revents != 0) detail::drain(err, result.err);
    ended = ended || waitpid(child, &wait_status, WNOHANG) == child;
    // A grandchild that outlives a killed program would hold the pipes open.
    if (ended && result.timed_out) break;
  }
  result.status = WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : 128 + WTERMSIG(wait_status);
  return result;
}

/// Text split at line ends; no empty last line.
inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

}  // namespace fascia::test
