#pragma once

#include "app/scene/document.hpp"

#include <optional>
#include <string_view>

/// Mistakes of a text that TOML's own messages do not explain.
namespace fascia::app {

/// A text is UTF-8, with or without a byte order mark.
/// @throws SyntaxError  at the first byte that is not, with the command that converts the file
void check_encoding(std::string_view text);

/// The first value of a line that has a unit and no quotes, young = 5 kPa; none where there is no such value.
/// @param line  counted from 1
std::optional<SyntaxError> unquoted_quantity(std::string_view text, int line);

}  // namespace fascia::app
