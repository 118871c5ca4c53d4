#pragma once

#include "app/scene/diagnostics.hpp"

#include <string_view>

namespace fascia::app {

/// Sets one value of a document: `key.path=value` from the command line.
///
/// The value is TOML, or else a bare text; none at all removes the key, or the element of a list. Tables that are
/// missing are made; elements of lists are named by their index from zero, constraints[0].fix or constraints.0.fix.
/// What is wrong is added to `diagnostics`.
void apply_override(Value& document, std::string_view text, Diagnostics& diagnostics);

}  // namespace fascia::app
