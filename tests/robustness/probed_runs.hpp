#pragma once

#include "tests/robustness/scene_runs.hpp"
#include "tests/support/table.hpp"

#include <cmath>

namespace fascia::test {

/// Runs of scenes whose probes and warnings are looked at.
class ProbedRuns : public SceneRuns {
 protected:
  /// Runs a scene that must end well; what it said on standard error.
  std::string run(const std::string& text, const std::vector<std::string>& settings = {}, int status = 0) const {
    write("scene.toml", text);
    std::vector<std::string> arguments{"run", "scene.toml", "--output", "out", "--quiet"};
    for (const std::string& s : settings) arguments.insert(arguments.end(), {"--set", s});
    const ProgramResult result = fascia(arguments);
    EXPECT_EQ(result.status, status) << result.err;
    return result.err;
  }
  std::vector<double> column(const std::string& name) const {
    const Table probes = read_table(folder_ / "out/probes.csv");
    const auto found = std::find(probes.columns.begin(), probes.columns.end(), name);
    EXPECT_NE(found, probes.columns.end()) << name;
    if (found == probes.columns.end()) return {};
    const auto place = static_cast<std::size_t>(found - probes.columns.begin());
    std::vector<double> values;
    for (const std::vector<double>& row : probes.rows) values.push_back(row.at(place));
    return values;
  }
  nlohmann::json value(const std::string& probe) const { return summary("out").at("probes").at(probe).at("value"); }
  bool warns(const std::string& name) const {
    const nlohmann::json warnings = summary("out").at("warnings");
    for (const auto& w : warnings)
      if (w.get<std::string>().ends_with("[" + name + "]")) return true;
    return false;
  }
};

}  // namespace fascia::test
