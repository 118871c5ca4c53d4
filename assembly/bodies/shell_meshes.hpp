#pragma once

#include "assembly/specification/scene.hpp"
#include "shells/shell_mesh.hpp"

#include <vector>

/// Bodies of shells: the surface of a domain, and what its triangles are made of.
namespace fascia {

/// Generated or read, then transformed. Its messages say what was repaired and what looks bad.
/// @throws SceneError, InputError, FileError
ShellMesh shell_mesh_of(const Body& body);

/// Of each triangle [m]: the first entry that selects its centre or, by a group, the triangle.
/// @throws SceneError  an entry that selects nothing, a triangle that none selects
std::vector<double> shell_thickness(const Body& body, const ShellMesh& mesh);

/// Of each triangle, in the same way; they point into the body.
/// @throws SceneError  as above
std::vector<const MaterialUse*> shell_materials(const Body& body, const ShellMesh& mesh);

}  // namespace fascia
