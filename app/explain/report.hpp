#pragma once

#include "app/explain/explanation.hpp"

#include <nlohmann/json.hpp>

#include <string>

namespace fascia::app {

/// Tables and sentences for the terminal.
std::string text_of(const Explanation& explanation);

/// explain.json: everything that was measured, with the changes of the scene that repeat it.
nlohmann::ordered_json json_of(const Explanation& explanation);

/// A variant as a row of a list: what it is about, and the change where that does not say it.
std::string label_of(const Variant& variant);

}  // namespace fascia::app
