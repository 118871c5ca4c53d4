#include "core/geometry/mesh_parts.hpp"

#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "core/geometry/surface_parts.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace fascia {
namespace {

using namespace surface_parts;

bool is_line(CellType type) { return type == CellType::line; }
bool is_part(CellType type) { return type != CellType::vertex; }

std::vector<Cell> cells_of(const Solid& all, bool (*wanted)(CellType)) {
  std::vector<Cell> cells;
  for (const Cell& cell : all.cells)
    if (wanted(cell.type)) cells.push_back(cell);
  return cells;
}

ClosedSurface solid_of(const Solid& all, std::vector<std::string>& messages) {
  const Solid solid = with_cells(all, cells_of(all, is_volume));
  const std::vector<Triangle> triangles = boundary_of_cells(solid, messages);
  check_closed(solid, triangles, messages);
  return enclose(solid, triangles);
}

TriangleMesh sheet_of(const Solid& all, std::vector<std::string>& messages) {
  const Solid sheet = with_cells(all, cells_off_volumes(all));
  std::vector<Triangle> triangles = triangles_of_cells(sheet, Surface::of_sheet, messages);
  orient_sheet(sheet, triangles, messages);
  return compact(sheet, triangles);
}

/// For each line cell whether a former one has the same nodes.
std::vector<bool> repeated(const std::vector<Cell>& cells) {
  std::vector<std::pair<std::array<int, 2>, std::size_t>> keys;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto [low, high] = std::minmax(cells[c].nodes[0], cells[c].nodes[1]);
    keys.push_back({{low, high}, c});
  }
  std::sort(keys.begin(), keys.end());
  std::vector<bool> result(cells.size(), false);
  for (std::size_t k = 1; k < keys.size(); ++k) result[keys[k].second] = keys[k].first == keys[k - 1].first;
  return result;
}

/// Segments longer than zero, each once, on their own points.
void add_lines(const Solid& all, MeshParts& parts) {
  const std::vector<Cell> cells = cells_of(all, is_line);
  const std::vector<bool> again = repeated(cells);
  std::vector<int> number(all.points.size(), -1);
  std::vector<std::int64_t> points, repeats;  // file numbers of what is left out
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const std::array<int, 2> ends{cells[c].nodes[0], cells[c].nodes[1]};
    if (ends[0] == ends[1] || again[c]) {
      (ends[0] == ends[1] ? points : repeats).push_back(cells[c].file_number);
      continue;
    }
    for (const int node : ends) number[at(node)] = 0;
    parts.segments.push_back(ends);
  }
  for (std::size_t i = 0; i < number.size(); ++i)
    if (number[i] == 0) {
      number[i] = static_cast<int>(parts.line_points.size());
      parts.line_points.push_back(all.points[i]);
    }
  for (auto& segment : parts.segments)
    for (int& node : segment) node = number[at(node)];
  const auto report = [&](const std::vector<std::int64_t>& left_out, const std::string& why) {
    if (left_out.empty()) return;
    parts.messages.push_back(all.file + ": left out " + std::to_string(left_out.size()) + " line cells " + why +
                             " (the first: cell " + std::to_string(left_out.front()) + ")");
  };
  report(points, "of zero length");
  report(repeats, "that repeat others");
}

}  // namespace

MeshParts mesh_parts(const Mesh& mesh) {
  check_points(mesh);
  const std::string remedy = "; give a mesh of a solid, of a sheet or of lines";
  if (count_cells(mesh, is_part) == 0)
    throw InputError(mesh.file + ": has neither volume cells, triangles nor lines" + remedy);
  MeshParts parts;
  parts.messages = mesh.messages;
  report_unused(mesh, parts.messages);
  const Solid all = make_solid(mesh, is_part, parts.messages);
  if (count_cells(mesh, is_volume) > 0) parts.solid = solid_of(all, parts.messages);
  if (count_cells(mesh, is_surface) > 0) parts.sheet = sheet_of(all, parts.messages);
  add_lines(all, parts);
  if (!parts.solid && parts.sheet.triangles.empty() && parts.segments.empty())
    throw InputError(mesh.file + ": all its lines have zero length" + remedy);
  return parts;
}

}  // namespace fascia
