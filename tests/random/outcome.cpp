#include "tests/random/outcome.hpp"

#include "tests/support/paths.hpp"
#include "tests/support/run_program.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <regex>

namespace fascia::random_scenes {
namespace {

std::string content_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    fields.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return fields;
}

/// Processor time of all processes that this one started and that have ended [s].
double seconds_of_children() {
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

/// Columns "tip.x", "tip.y" … belong to the probe "tip".
void read_table(Outcome& out) {
  const std::vector<std::string> lines = test::lines_of(out.csv);
  if (lines.empty()) return;
  const std::vector<std::string> head = fields_of(lines[0]);
  for (std::size_t k = 1; k < lines.size(); ++k) {
    const std::vector<std::string> row = fields_of(lines[k]);
    out.times.push_back(std::strtod(row[0].c_str(), nullptr));
    std::map<std::string, std::vector<double>> values;
    for (std::size_t c = 1; c < std::min(row.size(), head.size()); ++c)
      values[head[c].substr(0, head[c].find('.'))].push_back(std::strtod(row[c].c_str(), nullptr));
    for (auto& [name, v] : values) {
      const auto probe = out.probes.find(name);
      if (probe != out.probes.end()) probe->second.rows.push_back(v);
    }
  }
}

}  // namespace

double Outcome::residual() const {
  if (!summary.is_object()) return 0;
  const double said = std::max(summary.value("residual", 0.0), summary.value("residual_floor", 0.0));
  static const std::regex of_loads("([0-9.e+-]+) of the loads");  // on a soft part, or where the residual stands still
  std::smatch found;
  const std::string convergence = summary.value("convergence", "");
  return std::regex_search(convergence, found, of_loads) ? std::max(said, std::stod(found[1])) : said;
}

bool Outcome::says_several_ends() const {
  if (!summary.is_object()) return false;
  if (status() == "unstable" || status() == "inverted") return true;
  for (const Json& warning : summary["warnings"]) {
    const std::string text = warning.dump();
    if (text.find("several solutions") != std::string::npos) return true;
    if (text.find("of a frequency open") != std::string::npos || text.find("told from 0") != std::string::npos)
      return true;
    if (text.find("taken in parts") != std::string::npos) return true;  // another error of time
    for (const char* name : {"stability", "snap", "solver", "inverted", "resolution"})
      if (text.find(std::string("[") + name + "]") != std::string::npos) return true;
  }
  return false;
}

bool Outcome::doubts_its_end() const {
  return summary.is_object() && summary.contains("doubts") && !summary["doubts"].empty();
}

double Outcome::largest(const std::string& unit) const {
  double most = 0;
  for (const auto& [name, probe] : probes)
    if (probe.unit == unit)
      for (const std::vector<double>& row : probe.rows)
        for (const double v : row) most = std::max(most, std::abs(v));
  return most;
}

Outcome run(const std::string& scene, const std::filesystem::path& folder) {
  std::ofstream(folder / "scene.toml", std::ios::binary) << scene;
  std::filesystem::remove_all(folder / "out");
  test::ProgramOptions options;
  options.directory = folder;
  options.timeout = std::chrono::seconds(300);  // on a machine that does much else
  const double before = seconds_of_children();
  const test::ProgramResult result = test::run_program(
      {test::program(), "run", "scene.toml", "--output", "out", "--threads", "1", "--quiet"}, options);
  Outcome out;
  out.seconds = seconds_of_children() - before;
  out.exit_status = result.status;
  out.timed_out = result.timed_out;
  out.message = result.err;
  out.csv = content_of(folder / "out" / "probes.csv");
  out.summary = Json::parse(content_of(folder / "out" / "summary.json"), nullptr, false);
  if (out.summary.is_discarded()) out.summary = nullptr;
  if (!out.summary.is_object()) return out;
  if (out.summary.contains("probes"))
    for (const auto& [name, probe] : out.summary["probes"].items())
      out.probes[name] = {probe["quantity"], probe["unit"], {}};
  read_table(out);
  return out;
}

}  // namespace fascia::random_scenes
