#include "io/mesh/mesh_edit.hpp"

#include <cassert>
#include <cstddef>

namespace fascia::io {

void keep_points(Mesh& mesh, const std::vector<bool>& keep) {
  assert(keep.size() == mesh.points.size());
  std::vector<int> number(mesh.points.size(), -1);
  std::size_t next = 0;
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (!keep[i]) continue;
    number[i] = static_cast<int>(next);
    mesh.points[next] = mesh.points[i];
    mesh.point_file_number[next] = mesh.point_file_number[i];
    ++next;
  }
  mesh.points.resize(next);
  mesh.point_file_number.resize(next);
  for (CellBlock& block : mesh.blocks)
    for (std::vector<int>* nodes : {&block.nodes, &block.mid_nodes})
      for (int& node : *nodes) node = number[static_cast<std::size_t>(node)];
}

}  // namespace fascia::io
