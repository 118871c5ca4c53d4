#include "app/results/run_text.hpp"

#include "app/estimate/lines.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace fascia::app {
namespace {

/// Numbers of one value that are printed: a matrix, or four vectors.
constexpr std::size_t kMostNumbers = 12;

std::size_t numbers_of(const nlohmann::ordered_json& value) {
  if (!value.is_array()) return 1;
  std::size_t count = 0;
  for (const auto& item : value) count += numbers_of(item);
  return count;
}

}  // namespace

std::string short_value(const nlohmann::ordered_json& value) {
  if (value.is_number()) return fmt::format("{:.6g}", value.get<double>());
  if (!value.is_array()) return value.dump();
  std::vector<std::string> shown;
  std::size_t numbers = 0;
  for (const auto& item : value) {
    numbers += numbers_of(item);
    if (numbers > kMostNumbers && !shown.empty()) break;
    shown.push_back(short_value(item));
  }
  const std::size_t left = value.size() - shown.size();
  return fmt::format("[{}{}]", fmt::join(shown, ", "),
                     left > 0 ? fmt::format(", ... {} more in probes.csv", left) : "");
}

std::string json_text(const nlohmann::ordered_json& summary) {
  return summary.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

void print_summary(const Simulation& s, const nlohmann::ordered_json& j, bool shown) {
  fmt::print("{}: {} unknowns, {} steps, {} Newton iterations, {:.2f} s\n", j["status"].get<std::string>(),
             j["dofs"].get<int>(), j["steps"].get<int>(), j["newton_iterations"].get<int>(),
             j["seconds"]["solve"].get<double>());
  for (const auto& [name, probe] : j["probes"].items())
    fmt::print("  {} ({}): {} {}\n", name, probe["quantity"].get<std::string>(), short_value(probe["value"]),
               probe["unit"].get<std::string>());
  if (j.contains("estimated_error"))
    for (const std::string& line : estimate_lines(j)) fmt::print("  {}\n", line);
  const std::filesystem::path& directory = s.scene.output.directory;
  if (!shown) {
    fmt::print("no new results: {} is as it was\n", directory.string());
    return;
  }
  const std::filesystem::path states = directory / (s.scene.path.stem().string() + ".pvd");
  std::vector<std::string> look;
  if (std::filesystem::exists(states)) look.push_back(fmt::format("open {} in ParaView", states.string()));
  if (!s.probes.empty()) look.emplace_back("read probes.csv");
  fmt::print("results in {}{}{}\n", directory.string(), look.empty() ? "" : "; ", fmt::join(look, ", or "));
}

}  // namespace fascia::app
