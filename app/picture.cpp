#include "app/picture.hpp"
#include "app/messages.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

extern char** environ;

namespace fascia::app {

namespace {

namespace fs = std::filesystem;

int run(const std::vector<std::string>& arguments) {
  std::vector<char*> argv;
  argv.reserve(arguments.size() + 1);
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  pid_t pid = 0;
  posix_spawnattr_t attributes;  // signals that wait for this process end that one
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setsigmask(&attributes, &none);
  sigset_t usual = none;
  for (const int signal : {SIGPIPE, SIGXFSZ}) sigaddset(&usual, signal);
  posix_spawnattr_setsigdefault(&attributes, &usual);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  const int error = posix_spawnp(&pid, argv[0], nullptr, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  if (error != 0) return 127;
  int status = 0;
  waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

/// The last saved .vtu of each body.
std::vector<std::string> last_states(const Simulation& s, const fs::path& directory) {
  std::vector<std::string> files;
  for (const SimulatedBody& b : s.bodies) {
    std::string last;
    for (const fs::directory_entry& entry : fs::directory_iterator(directory)) {
      const std::string file = entry.path().filename().string();
      if (file.size() == b.name.size() + 10 && file.starts_with(b.name + "_") && file.ends_with(".vtu"))
        last = std::max(last, entry.path().string());
    }
    if (!last.empty()) files.push_back(last);
  }
  return files;
}

}  // namespace

void make_picture(const Simulation& s, const fs::path& directory, const std::string& name) {
  const Picture& p = *s.scene.output.picture;
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "fascia-picture";
  if (!fs::exists(program)) {
    say("no picture: there is no {} (of the package fascia-picture; in a checkout ./run builds it where VTK can "
        "render)\n",
        program.string());
    return;
  }
  std::vector<std::string> command;
  const char* display = std::getenv("DISPLAY");
  if (display == nullptr || *display == '\0') command = {"xvfb-run", "-a"};
  command.push_back(program.string());
  for (const std::string& file : last_states(s, directory)) command.push_back(file);
  command.push_back((directory / (name + ".png")).string());
  command.insert(command.end(), {"--view", fmt::format("{},{},{}", p.view[0], p.view[1], p.view[2]), "--size",
                                 fmt::format("{}x{}", p.size[0], p.size[1]), "--field", p.field});
  const Vec3d& g = s.scene.world.gravity;
  const bool upright = norm(cross(g, p.view)) > 0.05 * norm(g) * norm(p.view);
  if (upright) command.push_back(fmt::format("--up={},{},{}", 0 - g[0], 0 - g[1], 0 - g[2]));
  // xvfb-run fails at times while it cleans up, after the picture is written.
  if (run(command) != 0 && !fs::exists(directory / (name + ".png")))
    say("no picture: \"{}\" failed; a display, or xvfb-run (Debian: xvfb, xauth), is needed\n", command.front());
}

}  // namespace fascia::app
