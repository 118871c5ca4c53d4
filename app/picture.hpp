#pragma once

#include "app/simulation.hpp"

#include <filesystem>
#include <string>

namespace fascia::app {

/// Draws the last saved state into NAME.png with the program fascia-picture beside this one, under a virtual display
/// where there is none. Where that cannot be, it says so on standard error and goes on.
void make_picture(const Simulation& simulation, const std::filesystem::path& directory, const std::string& name);

}  // namespace fascia::app
