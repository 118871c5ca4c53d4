#include "app/verify/choice.hpp"

#include "app/scene/diagnostics.hpp"
#include "core/base/errors.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>

#include <algorithm>
#include <map>
#include <set>

namespace fascia::app {
namespace {

bool is_glob(const std::string& name) { return name.find_first_of("*?[") != std::string::npos; }

bool fits(const std::string& pattern, const std::string& name) {
  return pattern == name || (is_glob(pattern) && fnmatch(pattern.c_str(), name.c_str(), 0) == 0);
}

/// @throws InputError
[[noreturn]] void refuse(const Registry& registry, const std::string& name) {
  std::vector<std::string> known;
  for (const VerificationRun& run : registry) {
    known.push_back(run.topic);
    known.push_back(run.name);
    known.insert(known.end(), run.features.begin(), run.features.end());
    for (const VerificationCase& c : run.cases) known.push_back(c.name);
  }
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());
  const std::string near = nearest(name, known);
  throw InputError(fmt::format("verify: {} is no run, case, topic or feature; {}fascia verify --list lists them",
                               in_quotes(name), near.empty() ? "" : fmt::format("did you mean \"{}\"? ", near)));
}

/// What a name takes of a run.
struct Taken {
  bool run = false;             ///< with all of its cases
  bool itself = false;          ///< named so, not by a pattern or one of its features
  std::set<std::string> cases;  ///< that alone are named
};

void take(const VerificationRun& run, const std::string& name, Taken& taken) {
  const bool exact = name == run.name;
  taken.itself = taken.itself || exact;
  taken.run = taken.run || fits(name, run.name) || fits(name, run.topic) ||
              std::any_of(run.features.begin(), run.features.end(), [&](const auto& f) { return fits(name, f); });
  for (const VerificationCase& c : run.cases)
    if (fits(name, c.name)) {
      taken.cases.insert(c.name);
      taken.itself = taken.itself || name == c.name;
    }
}

}  // namespace

ChosenRuns choose(const Registry& registry, const std::vector<std::string>& names, bool full) {
  std::vector<Taken> taken(registry.size());
  for (const std::string& name : names) {
    bool known = false;
    for (std::size_t r = 0; r < registry.size(); ++r) {
      Taken by_name;
      take(registry[r], name, by_name);
      known = known || by_name.run || !by_name.cases.empty();
      taken[r].run = taken[r].run || by_name.run;
      taken[r].itself = taken[r].itself || by_name.itself;
      taken[r].cases.merge(by_name.cases);
    }
    if (!known) refuse(registry, name);
  }
  ChosenRuns chosen;
  for (std::size_t r = 0; r < registry.size(); ++r) {
    const bool all = names.empty() || taken[r].run;
    if (!all && taken[r].cases.empty()) continue;
    if (registry[r].full && !full && !taken[r].itself) {
      ++chosen.long_left;
      continue;
    }
    VerificationRun run = registry[r];
    if (!all) std::erase_if(run.cases, [&](const VerificationCase& c) { return !taken[r].cases.contains(c.name); });
    chosen.runs.push_back(std::move(run));
  }
  return chosen;
}

void print_registry(const ChosenRuns& chosen) {
  std::map<std::string, std::size_t> features;
  std::size_t cases = 0, full = 0;
  for (const VerificationRun& run : chosen.runs) {
    fmt::print("{}{}: {}\n    {}\n", run.name, run.full ? " (long)" : "", run.title, fmt::join(run.features, " "));
    for (const VerificationCase& c : run.cases) fmt::print("    {}: {}\n", c.name, c.title);
    for (const std::string& feature : run.features) features[feature] += run.cases.size();
    cases += run.cases.size();
    if (run.full) ++full;
  }
  fmt::print("features, with their cases:");
  for (const auto& [feature, count] : features) fmt::print(" {} {}", feature, count);
  fmt::print("\n{} runs, {} of them long, with {} cases\n", chosen.runs.size(), full, cases);
}

}  // namespace fascia::app
