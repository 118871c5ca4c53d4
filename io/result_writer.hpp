#pragma once

#include "core/base/thread_pool.hpp"
#include "core/geometry/mesh.hpp"
#include "core/math/vec3.hpp"
#include "io/growing_file.hpp"

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace fascia::io {

/// A named array on points or cells: `components` values each.
struct FieldArray {
  std::string name;
  int components = 1;
  std::vector<double> values;
  std::string unit = {};  ///< "Pa", "m"; empty: none
};

/// Cells of one type and order that fields belong to.
struct VisualCells {
  CellType type = CellType::tetrahedron;  ///< tetrahedron, hexahedron or triangle
  bool quadratic = false;
  std::vector<int> nodes;  ///< point indices, cell by cell: corners, then mid-side nodes in the order of CellBlock

  std::size_t nodes_per_cell() const {
    const int mid_nodes = quadratic ? mid_node_count(type) : 0;
    return static_cast<std::size_t>(node_count(type)) + static_cast<std::size_t>(mid_nodes);
  }
  std::size_t size() const { return nodes.size() / nodes_per_cell(); }
};

/// What one .vtu holds: volume cells first, then triangles, lines and single points ("vertices").
struct VisualMesh {
  std::vector<Vec3d> points;
  std::vector<VisualCells> volumes;
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::array<int, 2>> lines;
  std::vector<int> vertices;  ///< point indices, one vertex cell each
  std::vector<FieldArray> point_fields;
  std::vector<FieldArray> cell_fields;  ///< values for the volume cells only; the file has zeros for the other cells
  double time = 0;                      ///< as the .pvd says it: the file's "TimeValue"
  std::string provenance;               ///< the file's text of that name; none where empty
  std::vector<int> part;  ///< cell array "part", one a cell (volumes, triangles, lines, vertices); may be empty
};

/// Writes an unstructured grid (XML, appended and compressed), by the threads of a pool where there is one: the same
/// file, whatever their number.
/// @throws FileError   where it cannot be written in whole
/// @throws InputError  where a value is not finite (names the array)
void write_vtu(const std::filesystem::path& file, const VisualMesh& mesh, ThreadPool* pool = nullptr);

/// Bytes of what write_vtu would write, by compressing samples of its arrays.
double estimated_size(const VisualMesh& mesh);

/// A ParaView collection of the states of several bodies, complete after each of them.
class Collection {
 public:
  /// @throws FileError
  explicit Collection(const std::filesystem::path& file);
  /// @param body  part name
  /// @param state  its .vtu, relative to the collection
  /// @throws FileError, InputError where the time is not finite; the collection is then as it was
  void add(double time, const std::string& body, const std::string& state);
  void synchronise() const { file_.synchronise(); }

 private:
  std::filesystem::path path_;
  std::vector<std::string> bodies_;
  GrowingFile file_;
};

}  // namespace fascia::io
