#pragma once

#include "app/scene/diagnostics.hpp"
#include "app/schema/schema.hpp"

namespace fascia::app {

/// Checks a document against the schema: known and missing keys, types, units, ranges, what is not supported yet.
///
/// Quantities with a unit become SI numbers. What is wrong is reported and marked as not usable, so that later checks
/// do not complain about it again.
void validate(Value& document, const Shape& schema, Diagnostics& diagnostics);

}  // namespace fascia::app
