#pragma once

#include <string>

namespace fascia::app {

/// The program and its backends, for --version:
///
///     fascia 0.1.0
///     backends: cpu, cuda (toolkit 13.0, for 90-real)
std::string version_text();

/// Its second half: "cpu, cuda (toolkit 13.0, for 90-real)".
std::string backend_list();

}  // namespace fascia::app
