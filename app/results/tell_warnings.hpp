#pragma once

#include "assembly/specification/warnings.hpp"

#include <filesystem>

namespace fascia::app {

/// Prints the warnings that were not printed before: "FILE:LINE:COLUMN: warning: KEY: text [name]".
void tell(Warnings& warnings, const std::filesystem::path& scene);

}  // namespace fascia::app
