#include "tests/random/mesh_file.hpp"

#include "tests/random/twins.hpp"

#include <fmt/format.h>

#include <fstream>
#include <utility>

namespace fascia::random_scenes {
namespace {

/// The format's own number of a kind of cell.
int gmsh_type(const MeshCell& cell) {
  static const std::map<std::size_t, int> types{{1, 15}, {3, 2}, {4, 4}, {8, 5}};
  return types.at(cell.nodes.size());
}
int vtk_type(const MeshCell& cell) {
  static const std::map<std::size_t, int> types{{1, 1}, {3, 5}, {4, 10}, {8, 12}};
  return types.at(cell.nodes.size());
}

std::string point_text(const Vector& x) { return fmt::format("{:.17g} {:.17g} {:.17g}\n", x[0], x[1], x[2]); }

/// Numbers of nodes need not be consecutive.
int gmsh_number(int node) { return 3 * node + 2; }

std::string gmsh_text(const MeshFile& mesh) {
  std::string text = fmt::format("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", mesh.nodes.size());
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    text += fmt::format("{} ", gmsh_number(static_cast<int>(i))) + point_text(mesh.nodes[i]);
  text += fmt::format("$EndNodes\n$Elements\n{}\n", mesh.cells.size());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const MeshCell& cell = mesh.cells[c];
    text += fmt::format("{} {} 2 {} 1", c + 1, gmsh_type(cell), cell.group);
    for (const int node : cell.nodes) text += fmt::format(" {}", gmsh_number(node));
    text += "\n";
  }
  return text + "$EndElements\n";
}

std::string vtk_text(const MeshFile& mesh) {
  std::string text = "# vtk DataFile Version 3.0\nA random mesh\nASCII\nDATASET UNSTRUCTURED_GRID\n";
  text += fmt::format("POINTS {} double\n", mesh.nodes.size());
  for (const Vector& x : mesh.nodes) text += point_text(x);
  std::size_t size = 0;
  std::string cells, types, groups;
  for (const MeshCell& cell : mesh.cells) {
    size += cell.nodes.size() + 1;
    cells += fmt::format("{}", cell.nodes.size());
    for (const int node : cell.nodes) cells += fmt::format(" {}", node);
    cells += "\n";
    types += fmt::format("{}\n", vtk_type(cell));
    groups += fmt::format("{}\n", cell.group);
  }
  const std::size_t count = mesh.cells.size();
  return text +
         fmt::format("CELLS {} {}\n{}CELL_TYPES {}\n{}CELL_DATA {}\nSCALARS group int 1\nLOOKUP_TABLE default\n{}",
                     count, size, cells, count, types, count, groups);
}

}  // namespace

void turn_over(MeshCell& cell) {
  if (cell.nodes.size() < 3) return;
  const std::size_t pairs = cell.nodes.size() == 8 ? 4 : 1;
  for (std::size_t k = 0; k < pairs; ++k) std::swap(cell.nodes[2 * k], cell.nodes[2 * k + 1]);
}

MeshFile in_frame(const MeshFile& mesh, const Frame& frame) {
  MeshFile twin = mesh;
  for (Vector& x : twin.nodes) {
    const std::vector<double> there = frame.values({x[0], x[1], x[2]}, "position", "m");
    x = {there[0], there[1], there[2]};
  }
  if (frame.mirrored)
    for (MeshCell& cell : twin.cells) turn_over(cell);
  return twin;
}

std::string text_of(const MeshFile& mesh, const std::string& name) {
  const std::string text = name.ends_with(".msh") ? gmsh_text(mesh) : vtk_text(mesh);
  return text.substr(0, static_cast<std::size_t>(mesh.part * static_cast<double>(text.size())));
}

void write_meshes(const std::map<std::string, MeshFile>& meshes, const Frame& frame,
                  const std::filesystem::path& folder) {
  for (const auto& [name, mesh] : meshes)
    std::ofstream(folder / name, std::ios::binary) << text_of(in_frame(mesh, frame), name);
}

}  // namespace fascia::random_scenes
