#pragma once

#include "app/extremes/map.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <string>

namespace fascia::app {

/// Outcomes by the names of cells (ExtremeCell::name()).
using StoredMap = std::map<std::string, CellOutcome>;

/// An extremes.csv. @throws InputError  it is none: its line, and what is wrong
StoredMap read_stored(const std::filesystem::path& path);

/// What two maps must share for one to go on with the other.
nlohmann::ordered_json settings_json(const ExtremesMap& map);

}  // namespace fascia::app
