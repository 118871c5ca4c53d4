#pragma once

#include <string>

namespace fascia::app {

/// The reference page of the manual: every key of a scene, its type, default and meaning.
std::string schema_as_markdown();

/// A JSON Schema (draft 2020-12) of what this version takes, for editors that know TOML.
std::string schema_as_json_schema();

}  // namespace fascia::app
