#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fascia::app {

/// The scenes that come with the program. @throws FileError  they are not where the program looks for them
std::filesystem::path scenes_folder();

/// What `fascia list` can list.
std::vector<std::string> listed_things();

/// Prints scenes that come with the program, quantities that probes take, or units; one a line.
/// @param what  of listed_things()
/// @throws FileError  the scenes are not where the program looks for them
int list_things(const std::string& what);

}  // namespace fascia::app
