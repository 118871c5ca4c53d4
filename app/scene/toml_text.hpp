#pragma once

#include "app/scene/document.hpp"

#include <string>

namespace fascia::app {

/// A value as TOML on one line, which reads back as the same value: 0.5, "5 kPa", [1, 2], { x = 1 }.
std::string toml_text(const Value& value);

/// A key as TOML: bare where it may be, else in quotes.
std::string toml_key(std::string_view key);

}  // namespace fascia::app
