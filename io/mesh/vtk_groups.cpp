#include "io/mesh/vtk_groups.hpp"

#include "core/base/errors.hpp"

#include <fmt/format.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDataSet.h>

#include <array>
#include <limits>

namespace fascia::io {
namespace {

/// This program's own name, then those of meshio and other converters (Gmsh, Medit, MED) and of Gmsh itself.
constexpr std::array<const char*, 6> array_names{"group",     "gmsh:physical", "PhysicalGroup",
                                                 "medit:ref", "cell_tags",     "CellEntityIds"};

bool holds_integers(const vtkDataArray& array) {
  const int type = array.GetDataType();
  return type != VTK_FLOAT && type != VTK_DOUBLE && type != VTK_BIT;
}

vtkDataArray* find_numbers(vtkDataSet& data) {
  for (const char* name : array_names) {
    vtkDataArray* array = data.GetCellData()->GetArray(name);
    if (array && holds_integers(*array) && array->GetNumberOfComponents() == 1) return array;
  }
  return nullptr;
}

}  // namespace

VtkGroups::VtkGroups(vtkDataSet& data, std::string file, int first_cell)
    : numbers_(find_numbers(data)), file_(std::move(file)), first_cell_(first_cell) {
  if (numbers_ && numbers_->GetNumberOfTuples() != data.GetNumberOfCells())
    throw InputError(file_ + ": the array \"" + numbers_->GetName() + "\" has " +
                     std::to_string(numbers_->GetNumberOfTuples()) + " values for " +
                     std::to_string(data.GetNumberOfCells()) + " cells; must have one a cell");
}

int VtkGroups::of(long long cell, int dimension) {
  if (!numbers_) return -1;
  const double value = numbers_->GetComponent(cell, 0);
  constexpr int largest = std::numeric_limits<int>::max();
  if (value > largest || value < -largest)
    throw InputError(fmt::format("{}: cell {} has the number {:.0f} in the array \"{}\"; must be from {} to {}", file_,
                                 cell + first_cell_, value, numbers_->GetName(), -largest, largest));
  const int number = static_cast<int>(value);
  if (number == 0) return -1;
  const auto [entry, fresh] = index_.try_emplace({dimension, number}, static_cast<int>(groups_.size()));
  if (fresh) groups_.push_back({std::to_string(number), number, dimension});
  return entry->second;
}

}  // namespace fascia::io
