#pragma once

#include "app/results/results.hpp"
#include "assembly/simulation/simulation.hpp"

#include <filesystem>
#include <optional>
#include <vector>

namespace fascia::app {

/// Returns the direction that points up in pictures: the scene's own, or the one against gravity.
std::optional<Vec3d> up_of(const World& world);

/// Draws the last saved state, of modes each of the first ones, into SCENE.png with the program fascia-picture beside
/// this one, under a virtual display where there is none; picture.json beside it has what else the program shows. Where
/// that cannot be, it says so on standard error and goes on.
/// @param states  of each saved state its time [s], load factor or frequency [1/s]
void make_picture(const Simulation& simulation, const std::filesystem::path& directory,
                  const std::vector<double>& states, RunStatus status);

}  // namespace fascia::app
