#include "io/result_reader.hpp"

#include "core/model/errors.hpp"
#include "io/files.hpp"
#include "io/text_numbers.hpp"
#include "io/vtk_errors.hpp"

#include <fmt/format.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUtilities.h>

#include <cmath>
#include <cstddef>
#include <limits>

namespace fascia::io {
namespace {

std::vector<double> numbers_of(vtkDataArray& array) {
  const int components = array.GetNumberOfComponents();
  std::vector<double> numbers;
  numbers.reserve(static_cast<std::size_t>(array.GetNumberOfValues()));
  for (vtkIdType i = 0; i < array.GetNumberOfTuples(); ++i)
    for (int c = 0; c < components; ++c) numbers.push_back(array.GetComponent(i, c));
  return numbers;
}

void add_arrays(ResultArrays& arrays, vtkFieldData& data) {
  for (int a = 0; a < data.GetNumberOfArrays(); ++a)
    if (vtkDataArray* array = data.GetArray(a)) {
      const std::string name = array->GetName() != nullptr ? array->GetName() : "";
      std::vector<double>& values = arrays[name];  // of points, then of cells
      const std::vector<double> more = numbers_of(*array);
      values.insert(values.end(), more.begin(), more.end());
    }
}

std::string attribute(vtkXMLDataElement& element, const char* name) {
  const char* value = element.GetAttribute(name);
  return value == nullptr ? "" : value;
}

std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    parts.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

}  // namespace

ResultArrays read_result_arrays(const std::filesystem::path& vtu) {
  check_readable(vtu);
  const VtkErrors errors;
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(vtu.c_str());
  reader->Update();
  vtkUnstructuredGrid* grid = reader->GetOutput();
  if (!errors.first().empty() || grid == nullptr || grid->GetPoints() == nullptr)
    throw InputError(fmt::format("{}: is no readable .vtu ({})", vtu.string(), errors.first()));
  ResultArrays arrays{{"points", numbers_of(*grid->GetPoints()->GetData())}};
  add_arrays(arrays, *grid->GetPointData());
  add_arrays(arrays, *grid->GetCellData());
  return arrays;
}

std::vector<CollectionEntry> read_collection(const std::filesystem::path& pvd) {
  const VtkErrors errors;
  const std::string text = read_file(pvd);
  const vtkSmartPointer<vtkXMLDataElement> root =
      vtkSmartPointer<vtkXMLDataElement>::Take(vtkXMLUtilities::ReadElementFromString(text.c_str()));
  vtkXMLDataElement* list = root == nullptr ? nullptr : root->FindNestedElementWithName("Collection");
  if (list == nullptr) throw InputError(fmt::format("{}: is no .pvd of results", pvd.string()));
  std::vector<CollectionEntry> entries;
  for (int i = 0; i < list->GetNumberOfNestedElements(); ++i) {
    vtkXMLDataElement& element = *list->GetNestedElement(i);
    const auto time = to_number(attribute(element, "timestep"));
    if (!time) throw InputError(fmt::format("{}: entry {} has no time", pvd.string(), i));
    entries.push_back({*time, attribute(element, "name"), attribute(element, "file")});
  }
  return entries;
}

NumberTable read_number_table(const std::filesystem::path& csv) {
  const std::string text = read_file(csv);
  NumberTable table;
  int line_number = 0;
  for (const std::string_view line : split(text, '\n')) {
    ++line_number;
    if (line.empty()) continue;
    const std::vector<std::string_view> cells = split(line, ',');
    if (table.columns.empty()) {
      table.columns.assign(cells.begin(), cells.end());
      continue;
    }
    std::vector<double>& row = table.rows.emplace_back();
    for (const std::string_view cell : cells) {
      const auto number = to_number(cell);
      if (!number && !cell.empty())
        throw InputError(fmt::format("{}:{}: \"{}\" is no number", csv.string(), line_number, cell));
      row.push_back(number.value_or(std::numeric_limits<double>::quiet_NaN()));
    }
    if (row.size() != table.columns.size())
      throw InputError(fmt::format("{}:{}: has {} cells where the head has {}", csv.string(), line_number, row.size(),
                                   table.columns.size()));
  }
  return table;
}

}  // namespace fascia::io
