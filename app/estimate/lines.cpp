#include "app/estimate/lines.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace fascia::app {
namespace {

using Json = nlohmann::ordered_json;

std::string percent(const Json& error) {
  return error.is_number() ? fmt::format("{:.2g} %", 100 * error.get<double>()) : "unknown";
}

std::string line_of(const std::string& name, const Json& e) {
  std::vector<std::string> parts;
  for (const char* part : {"discretisation", "time", "solver", "precision"})
    if (!e.at(part).is_number() || e.at(part).get<double>() > 0)
      parts.push_back(fmt::format("{} {}", part, percent(e.at(part))));
  return fmt::format("estimated error of {}: {}{}", name, percent(e.at("total")),
                     parts.empty() ? "" : fmt::format(" ({})", fmt::join(parts, ", ")));
}

}  // namespace

std::vector<std::string> estimate_lines(const Json& summary) {
  std::vector<std::string> lines;
  bool coarser = false;
  const auto add = [&](const std::string& name, const Json& error) {
    lines.push_back(line_of(name, error));
    coarser = coarser || error.value("method", "") == "coarser";
  };
  for (const auto& [name, error] : summary.at("estimated_error").items()) {
    if (name != "bodies") {
      add(name, error);
      continue;
    }
    for (const auto& [body, of_body] : error.items()) add(fmt::format("the displacement of \"{}\"", body), of_body);
  }
  if (coarser)
    lines.emplace_back(
        "estimate: by coarser twins alone, which may be wrong by a factor of three where these are too coarse to show "
        "an order; output.estimate = \"finer\" is surer and takes longer");
  for (const auto& note : summary.at("estimate").at("how"))
    if (const std::string text = note.get<std::string>();
        text.find("no estimate") != std::string::npos || text.find("gives nothing") != std::string::npos)
      lines.push_back("estimate: " + text);
  return lines;
}

}  // namespace fascia::app
