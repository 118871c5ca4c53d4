#include "app/extremes/map.hpp"
#include "app/extremes/stored_map.hpp"
#include "app/version.hpp"
#include "core/base/errors.hpp"

#include <fmt/format.h>

#include <fstream>

namespace fascia::app {

nlohmann::ordered_json settings_json(const ExtremesMap& map) {
  return {{"fascia", FASCIA_VERSION},
          {"title", map.title},
          {"time_limit", map.settings.time_limit},
          {"memory_limit", map.settings.memory_limit},
          {"backend", map.settings.backend.value_or("as the scene says")}};
}

void resume(ExtremesMap& map, const std::filesystem::path& directory) {
  std::ifstream file(directory / "extremes.json");
  if (!file)
    throw InputError(fmt::format("extremes: --resume: {} holds no map; leave it out to begin one", directory.string()));
  const auto older = nlohmann::ordered_json::parse(file, nullptr, false);
  const nlohmann::ordered_json wanted = settings_json(map);
  for (const auto& [key, value] : wanted.items()) {
    const nlohmann::ordered_json before = older.is_object() ? older.value(key, nlohmann::ordered_json()) : older;
    if (before != value)
      throw InputError(
          fmt::format("extremes: --resume: {}/extremes.json has {} = {}, and now it is {}; go on with the "
                      "same, or leave --resume out",
                      directory.string(), key, before.dump(), value.dump()));
  }
  map.outcomes.resize(map.cells.size());
  map.ended.resize(map.cells.size(), 0);
  if (!std::filesystem::exists(directory / "extremes.csv")) return;
  const StoredMap stored = read_stored(directory / "extremes.csv");
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    const auto found = stored.find(map.cells[i].name());
    if (found == stored.end()) continue;
    map.outcomes[i] = found->second;
    map.ended[i] = 1;
  }
}

}  // namespace fascia::app
