#include "app/results/picture.hpp"
#include "app/other_program.hpp"
#include "app/run/messages.hpp"
#include "core/base/index.hpp"
#include "io/picture_description.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

namespace fascia::app {

namespace {

namespace fs = std::filesystem;

// With the first two exit statuses fascia-picture has said what is wrong; the others are as shells give them.
constexpr int wrong_content = 2, wrong_file = 4, by_signal = 128;

/// Says why there is no picture, as far as the exit status tells.
std::string reason_of(int status, bool virtual_display) {
  if (status == wrong_content || status == wrong_file) return "; its message tells why";
  if (virtual_display && status < by_signal) return "; a display, or xvfb-run (Debian: xvfb, xauth), is needed";
  return fmt::format(" with exit status {}", status);
}

/// Names of the bodies that nodes of the model belong to, of shared ones the first.
std::vector<const SimulatedBody*> bodies_of_nodes(const Simulation& s) {
  std::vector<const SimulatedBody*> bodies(at(s.model.node_count()));
  for (const SimulatedBody& b : s.bodies)
    for (const int node : b.node_ids)
      if (bodies[at(node)] == nullptr) bodies[at(node)] = &b;
  return bodies;
}

void add_supports(const Simulation& s, io::PictureDescription& description) {
  const std::vector<const SimulatedBody*> bodies = bodies_of_nodes(s);
  for (const FrameConstraint& c : s.model.constraints)
    if (c.translations > 0 && bodies[at(c.node)] != nullptr)
      description.supports.push_back(
          {bodies[at(c.node)]->name, s.model.rest_position[at(c.node)], c.translations == 3});
  for (const TetheredMaterial& m : s.tethered) {
    const Tether& tether = s.model.tethers[at(m.tether)];
    if (tether.arm == Vec3d{})
      description.supports.push_back({s.bodies[at(m.body)].name, tether.X, m.axes.size() == 3});
  }
}

void add_springs(const Simulation& s, io::PictureDescription& description) {
  for (std::size_t c = 0; c < s.couplings.size(); ++c)
    for (const int spring : s.couplings[c].springs) {
      const Spring& built = s.model.points.springs[at(spring)];
      description.springs.push_back({s.scene.couplings[c].body, built.X, built.point});
    }
}

io::PictureDescription describe(const Simulation& s, const std::vector<double>& states, RunStatus status) {
  io::PictureDescription description;
  description.title = s.scene.title;
  description.up = up_of(s.scene.world);
  const SolverKind kind = s.scene.solver.kind;
  description.kind = kind == SolverKind::modes     ? io::StateKind::frequency
                     : kind == SolverKind::statics ? io::StateKind::load_factor
                                                   : io::StateKind::time;
  description.states = states;
  if (status != RunStatus::converged) description.end = status_name(status);
  add_supports(s, description);
  add_springs(s, description);
  return description;
}

/// The .vtu files of the states that the picture shows.
std::vector<std::string> files_of(const Simulation& s, const fs::path& directory, std::size_t first, std::size_t last) {
  std::vector<std::string> files;
  for (std::size_t state = first; state <= last; ++state)
    for (const SimulatedBody& b : s.bodies) files.push_back((directory / state_file(b, state)).string());
  return files;
}

}  // namespace

std::optional<Vec3d> up_of(const World& world) {
  if (world.up || norm(world.gravity) == 0) return world.up;
  return Vec3d{} - normalized(world.gravity);  // no -0
}

void make_picture(const Simulation& s, const fs::path& directory, const std::vector<double>& states, RunStatus status) {
  constexpr std::size_t most_modes = 20;  // that can be told apart on a page
  if (states.empty()) return;
  const Picture& p = *s.scene.output.picture;
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "fascia-picture";
  if (!fs::exists(program)) {
    say("no picture: there is no {} (of the package fascia-picture; in a checkout ./run builds it where VTK can "
        "render)\n",
        program.string());
    return;
  }
  io::write_description(directory, describe(s, states, status));
  std::vector<std::string> command;
  const char* display = std::getenv("DISPLAY");
  if (display == nullptr || *display == '\0') command = {"xvfb-run", "-a"};
  command.push_back(program.string());
  const bool modes = s.scene.solver.kind == SolverKind::modes;
  const std::size_t shown = modes ? std::min(states.size(), most_modes) : states.size();
  for (std::string& file : files_of(s, directory, modes ? 0 : shown - 1, shown - 1)) command.push_back(std::move(file));
  const fs::path picture = directory / (s.scene.path.stem().string() + ".png");
  command.push_back(picture.string());
  command.insert(command.end(), {fmt::format("--view={},{},{}", p.view[0], p.view[1], p.view[2]), "--size",
                                 fmt::format("{}x{}", p.size[0], p.size[1]), "--field", p.field});
  if (p.range) command.push_back(fmt::format("--range={},{}", (*p.range)[0], (*p.range)[1]));
  if (modes) command.push_back("--sheet");
  if (shown < states.size() && modes)
    say("the picture shows the first {} of {} modes; fascia-picture draws others\n", shown, states.size());
  // xvfb-run fails at times while it cleans up, after the picture is written.
  const int ended = run_other_program(command);
  if (ended != 0 && !fs::exists(picture))
    say("no picture: \"{}\" failed{}\n", command.front(), reason_of(ended, command.front() != program.string()));
}

}  // namespace fascia::app
