#include "app/extremes/map.hpp"
#include "app/extremes/twin.hpp"
#include "app/run/run_scene.hpp"
#include "app/run/temporary_folder.hpp"
#include "io/files.hpp"

#include <fmt/format.h>

#include <cctype>
#include <mutex>
#include <set>
#include <utility>

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

/// Runs a cell and what it is judged by, one after the other, in a folder of its own.
class CellJudgement {
 public:
  CellJudgement(const ExtremeCell& cell, fs::path scene, fs::path folder, const MapSettings& settings,
                const std::function<bool()>& stop)
      : cell_(cell), scene_(std::move(scene)), folder_(std::move(folder)), settings_(settings), stop_(stop) {
    fs::create_directories(folder_);
  }

  CellOutcome outcome() {
    run_ = run_own({});
    if (run_.exit_status != kDone) return judged();
    const Twin twin = twin_of(cell_);
    units_ = twin.units;
    twin_ = run_twin(twin);
    if (const CellVerdict v = judged().verdict;
        v != CellVerdict::wrong && v != CellVerdict::warned && v != CellVerdict::unconfirmed)
      return judged();
    if (const std::optional<Twin> other = disturbed_twin(cell_, run_.summary)) disturbed_ = run_twin(*other);
    sharper_ = run_own(sharper_solver());
    return judged();
  }

 private:
  CellOutcome judged() const { return judge(cell_, {&run_, &twin_, &disturbed_, &sharper_, units_}); }

  ChildResult run(ChildRun child) const {
    child.output = folder_ / "out";
    child.threads = 1;
    child.memory_limit = settings_.memory_limit;
    ChildResult result = run_child(child, stop_);
    // A result is looked at and removed: thousands of them need not fit.
    std::error_code ignored;
    fs::remove_all(child.output, ignored);
    if (result.summary.is_object()) result.summary.erase("provenance");
    leave_out(result.message, child.scene.parent_path());
    return result;
  }
  ChildResult run_own(const std::vector<std::string>& overrides) const {
    ChildRun child;
    child.scene = scene_;
    child.overrides = overrides;
    child.backend = settings_.backend;
    child.time_limit = settings_.time_limit;
    return run(child);
  }
  ChildResult run_twin(const Twin& twin) const {
    ChildRun child;
    child.scene = folder_ / "twin.toml";
    io::write_file(child.scene, twin.text);
    child.overrides = twin_solver();
    child.time_limit = 4 * settings_.time_limit;  // other solver, smaller tolerance
    return run(child);
  }

  const ExtremeCell& cell_;
  fs::path scene_, folder_;
  const MapSettings& settings_;
  const std::function<bool()>& stop_;
  ChildResult run_, twin_, disturbed_, sharper_;
  UnitFactors units_;
};

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
  map.outcomes.resize(n);
  map.ended.resize(n, 0);
  std::set<std::string> taken;
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < n; ++i) {
    std::string name = file_name(map.cells[i].name());
    if (!taken.insert(name).second) taken.insert(name += fmt::format("-{}", i));
    map.files.push_back("cells/" + name + ".toml");
    io::write_file(directory / map.files.back(), map.cells[i].text);
    if (map.ended[i] == 0) open.push_back(i);
  }
  std::mutex telling;
  std::size_t ended = n - open.size();
  at_once(
      open.size(), map.settings.jobs,
      [&](std::size_t k) {
        const std::size_t i = open[k];
        const fs::path folder = results.path() / std::to_string(i);
        const CellOutcome outcome =
            CellJudgement(map.cells[i], directory / map.files[i], folder, map.settings, stop).outcome();
        std::error_code ignored;
        fs::remove_all(folder, ignored);
        if (stop()) return;  // which may have ended its runs
        const std::lock_guard lock(telling);
        map.outcomes[i] = outcome;
        map.ended[i] = 1;
        tell(++ended, n);
      },
      stop);
}

void keep_ended(ExtremesMap& map) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    if (!map.has_ended(i)) continue;
    map.cells[kept] = map.cells[i];
    map.outcomes[kept] = map.outcomes[i];
    map.files[kept++] = map.files[i];
  }
  map.cells.resize(kept);
  map.outcomes.resize(kept);
  map.files.resize(kept);
  map.ended.assign(kept, 1);
}

}  // namespace fascia::app
