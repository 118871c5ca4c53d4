#include "assembly/bodies/read_files.hpp"

#include "core/base/index.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fascia {

namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const char* why) {
  throw InputError(fmt::format("{}: {}", path.string(), why));
}

bool is_finite(const Vec3d& x) { return std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]); }

void check_indices(const std::vector<int>& indices, std::size_t points, const std::filesystem::path& path) {
  if (std::any_of(indices.begin(), indices.end(), [&](int i) { return i < 0 || at(i) >= points; }))
    refuse(path, "a cell names a point that is not there");
}

}  // namespace

Mesh checked(Mesh mesh, const std::filesystem::path& path) {
  if (!std::all_of(mesh.points.begin(), mesh.points.end(), is_finite)) refuse(path, "a point is not finite");
  if (mesh.point_file_number.empty()) {
    mesh.point_file_number.resize(mesh.points.size());
    std::iota(mesh.point_file_number.begin(), mesh.point_file_number.end(), 1);
  }
  if (mesh.point_file_number.size() != mesh.points.size()) refuse(path, "points and their numbers differ in length");
  std::int64_t next = 1;
  for (CellBlock& block : mesh.blocks) {
    if (block.nodes.size() % at(node_count(block.type)) != 0) refuse(path, "a block of cells ends within a cell");
    if (block.group.empty()) block.group.assign(block.size(), -1);
    for (std::size_t c = block.file_number.size(); c < block.size(); ++c) block.file_number.push_back(next++);
    const std::size_t mid_nodes = block.size() * at(block.mid_nodes_per_cell);
    if (block.group.size() != block.size() || block.file_number.size() != block.size() ||
        block.mid_nodes.size() != mid_nodes ||
        (block.mid_nodes_per_cell != 0 && block.mid_nodes_per_cell != mid_node_count(block.type)))
      refuse(path, "groups, numbers or mid-side nodes of a block do not fit its cells");
    check_indices(block.nodes, mesh.points.size(), path);
    check_indices(block.mid_nodes, mesh.points.size(), path);
    const int groups = static_cast<int>(mesh.groups.size());
    if (std::any_of(block.group.begin(), block.group.end(), [&](int g) { return g < -1 || g >= groups; }))
      refuse(path, "a cell names a group that is not there");
  }
  return mesh;
}

PointTable checked(PointTable table, const std::filesystem::path& path) {
  const std::size_t count = table.position.size();
  if (count == 0 || !std::all_of(table.position.begin(), table.position.end(), is_finite))
    refuse(path, "there are no points, or one is not finite");
  if (!table.rotation.empty() && table.rotation.size() != count) refuse(path, "rotations do not fit the positions");
  if (!table.volume.empty() && table.volume.size() != count) refuse(path, "volumes do not fit the positions");
  return table;
}

}  // namespace fascia
