#pragma once

#include "core/geometry/mesh.hpp"

#include <map>
#include <string>
#include <utility>
#include <vector>

class vtkDataArray;
class vtkDataSet;

namespace fascia::io {

/// Groups of a VTK file, numbered by an array of cells (read_mesh says which). Without such an array no cell has one.
class VtkGroups {
 public:
  VtkGroups() = default;

  /// @param file        for messages
  /// @param first_cell  the file's own number of its first cell
  VtkGroups(vtkDataSet& data, std::string file, int first_cell);

  /// Index of a cell's group, −1 for none.
  /// @param dimension    of the cell
  /// @throws InputError  where the number is out of range
  int of(long long cell, int dimension);

  /// The groups met so far, in the order of their first cells.
  std::vector<MeshGroup> take() { return std::move(groups_); }

 private:
  vtkDataArray* numbers_ = nullptr;
  std::string file_;
  int first_cell_ = 0;
  std::map<std::pair<int, int>, int> index_;  ///< by dimension and number
  std::vector<MeshGroup> groups_;
};

}  // namespace fascia::io
