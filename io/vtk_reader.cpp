#include "io/vtk_reader.hpp"

#include "core/model/errors.hpp"
#include "io/files.hpp"
#include "io/isolated.hpp"
#include "io/obj_reader.hpp"
#include "io/stl_reader.hpp"
#include "io/vtk_cells.hpp"
#include "io/vtk_errors.hpp"

#include <vtkDataSetReader.h>
#include <vtkErrorCode.h>
#include <vtkPLYReader.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <exception>

namespace fascia::io {
namespace {

[[noreturn]] void fail(const std::string& file, const std::string& ending, const std::string& reason) {
  throw InputError(file + ": is no readable " + ending + " mesh" + (reason.empty() ? "" : " (" + reason + ")") +
                   "; it may be cut off or of another format: write it again");
}

/// Any array of the file may number the groups.
void configure(vtkDataSetReader& reader) {
  reader.ReadAllScalarsOn();
  reader.ReadAllFieldsOn();
}
void configure(vtkAlgorithm&) {}

template <class Reader>
vtkSmartPointer<vtkDataSet> read_with(const std::string& file) {
  const auto reader = vtkSmartPointer<Reader>::New();
  configure(*reader);
  reader->SetFileName(file.c_str());
  reader->Update();
  if (reader->GetErrorCode() != vtkErrorCode::NoError) return nullptr;
  return vtkDataSet::SafeDownCast(reader->GetOutputDataObject(0));
}

vtkSmartPointer<vtkDataSet> read_data(const std::string& file, const std::string& ending) {
  if (ending == ".vtk") return read_with<vtkDataSetReader>(file);
  if (ending == ".vtu") return read_with<vtkXMLUnstructuredGridReader>(file);
  if (ending == ".vtp") return read_with<vtkXMLPolyDataReader>(file);
  return read_with<vtkPLYReader>(file);
}

Mesh read_by_vtk(const std::string& file, const std::string& ending, MidNodes mid_nodes) {
  VtkErrors errors;
  try {
    const vtkSmartPointer<vtkDataSet> data = read_data(file, ending);
    if (!data || !errors.first().empty()) fail(file, ending, errors.first());
    if (!vtkPolyData::SafeDownCast(data) && !vtkUnstructuredGrid::SafeDownCast(data))
      fail(file, ending, "must hold an unstructured grid or polygonal data");
    return mesh_of_vtk(*data, file, 0, 0, mid_nodes);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& e) {
    fail(file, ending, e.what());
  }
}

}  // namespace

Mesh read_vtk_mesh(const std::filesystem::path& path, const std::string& ending, MidNodes mid_nodes) {
  const std::string file = path.string();
  if (ending == ".obj" || ending == ".stl") {
    VtkErrors silence;
    const auto parse = ending == ".obj" ? parse_obj : parse_stl;
    return mesh_of_vtk(*parse(read_file(path), file), file, 1, 1, mid_nodes);
  }
  return read_isolated(file, [&] { return read_by_vtk(file, ending, mid_nodes); });
}

}  // namespace fascia::io
