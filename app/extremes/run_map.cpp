#include "app/extremes/map.hpp"
#include "app/extremes/twin.hpp"
#include "app/run_scene.hpp"
#include "app/temporary_folder.hpp"
#include "io/files.hpp"

#include <fmt/format.h>

#include <cctype>
#include <set>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

/// A message without the folder of the scene, which is another one the next time.
void leave_out(std::string& message, const fs::path& folder) {
  const std::string prefix = folder.string() + "/";
  for (std::size_t at = message.find(prefix); at != std::string::npos; at = message.find(prefix, at))
    message.erase(at, prefix.size());
}

/// A text as a file's name: letters, digits, dots, signs and dashes.
std::string file_name(const std::string& text) {
  std::string name;
  for (const char c : text) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '+' || c == '-';
    if (plain)
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (c != '\'' && !name.empty() && name.back() != '-')
      name += '-';
  }
  while (!name.empty() && name.back() == '-') name.pop_back();
  return name;
}

ChildRun child(const fs::path& scene, const fs::path& output, const MapSettings& settings) {
  ChildRun run;
  run.scene = scene;
  run.output = output;
  run.threads = 1;
  run.time_limit = settings.time_limit;
  run.memory_limit = settings.memory_limit;
  return run;
}

}  // namespace

std::vector<std::size_t> count(const ExtremesMap& map) {
  std::vector<std::size_t> counts(static_cast<std::size_t>(CellVerdict::crashed) + 1, 0);
  for (const CellOutcome& o : map.outcomes) ++counts[static_cast<std::size_t>(o.verdict)];
  return counts;
}

void run_map(ExtremesMap& map, const fs::path& directory, const std::function<void(std::size_t, std::size_t)>& tell,
             const std::function<bool()>& stop) {
  const TemporaryFolder results("fascia-extremes");
  const std::size_t n = map.cells.size();
  std::size_t ended = 0;
  std::vector<ChildResult> runs(n), twins(n), disturbed(n), sharper(n);
  std::vector<UnitFactors> units(n);
  std::vector<ChildRun> children;
  std::vector<std::size_t> cells;  // of the children

  const auto run_all = [&](std::vector<ChildResult>& into) {
    run_children(
        children, map.settings.jobs,
        [&](std::size_t k, ChildResult result) {
          // A result is looked at and removed: thousands of them need not fit.
          std::error_code ignored;
          fs::remove_all(children[k].output, ignored);
          if (result.summary.is_object()) result.summary.erase("provenance");
          leave_out(result.message, children[k].scene.parent_path());
          into[cells[k]] = std::move(result);
          tell(++ended, 2 * n);
        },
        stop);
    children.clear();
    cells.clear();
  };
  const auto add = [&](std::size_t i, const fs::path& scene) {
    children.push_back(child(scene, results.path() / std::to_string(i), map.settings));
    cells.push_back(i);
  };
  const auto add_twin = [&](std::size_t i, const Twin& twin) {
    const fs::path scene = results.path() / fmt::format("{}.toml", i);
    io::write_file(scene, twin.text);
    add(i, scene);
    children.back().overrides = twin_solver();
    children.back().time_limit *= 4;  // other solver, smaller tolerance
  };

  std::set<std::string> taken;
  for (std::size_t i = 0; i < n; ++i) {
    std::string name = file_name(map.cells[i].name());
    if (!taken.insert(name).second) taken.insert(name += fmt::format("-{}", i));
    map.files.push_back("cells/" + name + ".toml");
    io::write_file(directory / map.files.back(), map.cells[i].text);
    add(i, directory / map.files.back());
    children.back().backend = map.settings.backend;
  }
  run_all(runs);

  for (std::size_t i = 0; i < n; ++i) {
    if (runs[i].exit_status != kDone) {
      ++ended;
      continue;
    }
    const Twin twin = twin_of(map.cells[i]);
    units[i] = twin.units;
    add_twin(i, twin);
  }
  run_all(twins);

  const auto verdict = [&](std::size_t i) {
    return judge(map.cells[i], {&runs[i], &twins[i], &disturbed[i], &sharper[i], units[i]});
  };
  map.outcomes.resize(n);
  std::vector<std::size_t> doubted;
  for (std::size_t i = 0; i < n; ++i) {
    map.outcomes[i] = verdict(i);
    const CellVerdict v = map.outcomes[i].verdict;
    if (v == CellVerdict::wrong || v == CellVerdict::warned || v == CellVerdict::unconfirmed) doubted.push_back(i);
  }
  for (const std::size_t i : doubted)
    if (const std::optional<Twin> twin = disturbed_twin(map.cells[i], runs[i].summary)) add_twin(i, *twin);
  run_all(disturbed);
  for (const std::size_t i : doubted) {
    add(i, directory / map.files[i]);
    children.back().backend = map.settings.backend;
    children.back().overrides = sharper_solver();
  }
  run_all(sharper);
  for (const std::size_t i : doubted) map.outcomes[i] = verdict(i);
}

}  // namespace fascia::app
