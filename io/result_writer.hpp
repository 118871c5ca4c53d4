#pragma once

#include "core/geometry/mesh.hpp"
#include "core/math/vec3.hpp"

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
  std::vector<int> part;  ///< cell array "part", one a cell (volumes, triangles, lines, vertices); may be empty
};

/// Writes an unstructured grid (XML, appended and compressed).
/// @throws FileError   where it cannot be written in whole
/// @throws InputError  where a value is not finite (names the array)
void write_vtu(const std::filesystem::path& file, const VisualMesh& mesh);

struct PvdEntry {
  double time = 0;
  std::string body;  ///< part name
  std::string file;  ///< relative to the .pvd
};

/// Writes a ParaView collection. @throws FileError
void write_pvd(const std::filesystem::path& file, const std::vector<PvdEntry>& entries);

/// Writes a whole text file, or throws FileError.
void write_text(const std::filesystem::path& file, const std::string& text);

/// A directory of results that appears whole or not at all: everything is written into a hidden sibling, which
/// commit() puts in the place of an older result. Without commit() the older result stays as it was.
class ResultDirectory {
 public:
  /// Creates the hidden sibling.
  /// @throws FileError  where it cannot be made, or where `target` exists and is no result of this program
  ///                    (a directory that is empty or holds a summary.json with a "fascia" key is)
  explicit ResultDirectory(const std::filesystem::path& target);
  ~ResultDirectory();
  ResultDirectory(const ResultDirectory&) = delete;
  ResultDirectory& operator=(const ResultDirectory&) = delete;

  const std::filesystem::path& path() const { return work_; }  ///< write here
  void commit();  ///< @throws FileError; the older result is then still there

 private:
  std::filesystem::path target_, work_;
  bool done_ = false;
};

}  // namespace fascia::io
