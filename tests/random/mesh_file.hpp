#pragma once

#include "tests/random/draws.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace fascia::random_scenes {

struct Frame;

/// A vertex, triangle, tetrahedron or hexahedron: the number of its nodes says which.
struct MeshCell {
  std::vector<int> nodes;  ///< from zero
  int group = 0;           ///< 0: none
};

/// A mesh in a file beside the scene.
struct MeshFile {
  std::vector<Vector> nodes;  ///< in the unit of the file
  std::vector<MeshCell> cells;
  double part = 1;  ///< of the text that is written, from its beginning
};

/// Exchanges nodes so that the cell has the other orientation.
void turn_over(MeshCell& cell);

/// The mesh in other units and axes. A reflection turns its cells over, so that they keep their orientation.
MeshFile in_frame(const MeshFile& mesh, const Frame& frame);

/// Writes Gmsh's version 2.2 or VTK's legacy format, both in ASCII, by the ending of the name.
std::string text_of(const MeshFile& mesh, const std::string& name);

void write_meshes(const std::map<std::string, MeshFile>& meshes, const Frame& frame,
                  const std::filesystem::path& folder);

}  // namespace fascia::random_scenes
