#include "app/bench/report_parts.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>

namespace fascia::app {

std::string aligned(const std::vector<TableRow>& rows, std::size_t left) {
  std::vector<std::size_t> width(rows.front().size());
  for (const TableRow& r : rows)
    for (std::size_t c = 0; c < r.size(); ++c) width[c] = std::max(width[c], r[c].size());
  std::string text;
  for (const TableRow& r : rows) {
    std::string line;
    for (std::size_t c = 0; c < r.size(); ++c)
      line += c < left ? fmt::format("{:<{}}  ", r[c], width[c]) : fmt::format("{:>{}}  ", r[c], width[c]);
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

std::string machine_lines(const Machine& m) {
  std::string text = fmt::format("{}, {} threads, {:.3g} GB; {}\n", m.cpu, m.threads, m.memory / 1e9, m.system);
  for (const std::string& gpu : m.gpu) text += fmt::format("{}, driver {}\n", gpu, m.driver);
  text += fmt::format("fascia {} ({}), {}, {}", m.fascia, m.backends, m.compiler, m.build);
  for (const auto& [name, version] : m.libraries) text += fmt::format(", {} {}", name, version);
  return text + fmt::format("; {}\n", m.date);
}

std::string skipped_lines(const std::vector<SkippedCase>& skipped) {
  std::map<std::string, std::string> names_of;
  for (const SkippedCase& s : skipped) names_of[s.reason] += " " + s.name;
  std::string text;
  for (const auto& [reason, names] : names_of) text += fmt::format("not timed, {}:{}\n", reason, names);
  return text;
}

std::string field(const std::optional<double>& value) { return value ? fmt::format("{}", *value) : ""; }

nlohmann::ordered_json number(double v) {
  return std::isfinite(v) ? nlohmann::ordered_json(v) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json number(const std::optional<double>& v) {
  return v ? number(*v) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json json_head(const std::string& name, const std::string& title, const std::string& notes,
                                 const Machine& machine) {
  nlohmann::ordered_json j;
  j["benchmark"] = name;
  j["title"] = title;
  j["notes"] = notes;
  j["date"] = machine.date;
  j["machine"] = {{"system", machine.system},       {"cpu", machine.cpu}, {"threads", machine.threads},
                  {"memory_bytes", machine.memory}, {"gpu", machine.gpu}, {"driver", machine.driver}};
  j["build"] = {{"fascia", machine.fascia},
                {"backends", machine.backends},
                {"compiler", machine.compiler},
                {"type", machine.build}};
  j["build"]["libraries"] = nlohmann::ordered_json::object();
  for (const auto& [library, version] : machine.libraries) j["build"]["libraries"][library] = version;
  return j;
}

nlohmann::ordered_json json_of(const std::vector<SkippedCase>& skipped) {
  nlohmann::ordered_json j = nlohmann::ordered_json::array();
  for (const SkippedCase& s : skipped) j.push_back({{"case", s.name}, {"reason", s.reason}});
  return j;
}

}  // namespace fascia::app
