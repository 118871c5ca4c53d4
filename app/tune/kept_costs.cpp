#include "app/tune/kept_costs.hpp"

#include "app/cache.hpp"
#include "app/machine.hpp"
#include "assembly/specification/readable.hpp"

#include <fmt/format.h>

#include <fstream>

namespace fascia::app {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json machine_key(const Machine& machine) {
  return {{"processor", machine.cpu}, {"threads", machine.threads}, {"version", machine.fascia}};
}

fs::path tune_file() {
  const fs::path folder = cache_folder();
  return folder.empty() ? folder : folder / "tune.json";
}

std::optional<CostModel> kept_costs(std::string& told) {
  told.clear();
  const fs::path file = tune_file();
  std::error_code none;
  if (file.empty() || !fs::exists(file, none)) return std::nullopt;
  std::ifstream stream(file);
  const Json j = Json::parse(stream, nullptr, false);
  const auto ignored = [&](const std::string& why) {
    told = fmt::format("{} {}, and is not used; fascia tune makes another", file.string(), why);
    return std::nullopt;
  };
  if (!j.is_object() || !j.contains("key") || !j.contains("kinds")) return ignored("is not what fascia tune writes");
  if (j["key"] != machine_key(this_machine())) return ignored("is of another machine or version");
  std::optional<CostModel> costs = CostModel::read(j["kinds"]);
  return costs ? costs : ignored("is damaged, or of another version");
}

std::string time_line(const Simulation& simulation) {
  std::string told;
  const std::optional<CostModel> costs = kept_costs(told);
  if (!costs) return told.empty() ? "" : "time: " + told;
  const std::optional<TimeForecast> forecast = forecast_time(simulation, *costs);
  if (!forecast) return "";
  const bool steps = simulation.scene.solver.kind == SolverKind::central_differences;
  return fmt::format("time: about {} on this machine ({:.0f} {} assumed)", time_text(forecast->seconds),
                     forecast->iterations, steps ? "steps" : "Newton iterations");
}

}  // namespace fascia::app
