#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fascia::app {

/// Changes that give a body of a scene another discretisation of the same domain: material, mass, loads, constraints
/// and, where both know cells, their number are kept (a grid of n frames has n − 1 cells).
/// @param scene      the scene's file  @param overrides  changes that are made before
/// @param model  "frames", "affine", "tetrahedra", "tetrahedra-2", "hexahedra", "hexahedra-2", "shell", "sheet"
/// @return "key.path=value", or "key.path=" for keys that the other model does not take
/// @throws SceneError  the scene is wrong
/// @throws InputError  no such body; a domain that this model cannot fill, with what to write instead
std::vector<std::string> model_alternative(const std::filesystem::path& scene,
                                           const std::vector<std::string>& overrides, const std::string& body,
                                           const std::string& model);

}  // namespace fascia::app
