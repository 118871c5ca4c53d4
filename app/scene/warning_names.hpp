#pragma once

#include "app/schema/schema.hpp"

#include <vector>

namespace fascia::app {

/// Names of all warnings, which `silence` of a scene takes, with their meaning.
const std::vector<Choice>& warning_names();

}  // namespace fascia::app
