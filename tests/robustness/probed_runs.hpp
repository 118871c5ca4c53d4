#pragma once

#include "tests/robustness/scene_runs.hpp"

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
    const std::vector<std::string> rows = lines_of(read_text(folder_ / "out/probes.csv"));
    const auto cells = [](const std::string& row) {
      std::vector<std::string> out;
      for (std::size_t begin = 0; begin <= row.size();) {
        const std::size_t end = std::min(row.find(',', begin), row.size());
        out.push_back(row.substr(begin, end - begin));
        begin = end + 1;
      }
      return out;
    };
    const std::vector<std::string> head = cells(rows.at(0));
    const auto place = static_cast<std::size_t>(std::find(head.begin(), head.end(), name) - head.begin());
    EXPECT_LT(place, head.size()) << name;
    std::vector<double> values;
    for (std::size_t r = 1; r < rows.size() && place < head.size(); ++r)
      values.push_back(std::stod(cells(rows[r])[place]));
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
