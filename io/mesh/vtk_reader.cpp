#include "io/mesh/vtk_reader.hpp"

#include "core/base/errors.hpp"
#include "io/files.hpp"
#include "io/mesh/isolated.hpp"
#include "io/mesh/obj_reader.hpp"
#include "io/mesh/off_reader.hpp"
#include "io/mesh/ply_reader.hpp"
#include "io/mesh/stl_reader.hpp"
#include "io/mesh/vtk_cells.hpp"
#include "io/vtk_errors.hpp"

#include <vtkDataSetReader.h>
#include <vtkErrorCode.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <exception>
#include <fstream>
#include <string_view>

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
  return read_with<vtkXMLPolyDataReader>(file);
}

/// The value of an attribute of an XML element's start; empty where it has none.
std::string_view attribute(std::string_view element, std::string_view name) {
  constexpr std::string_view spaces = " \t\r\n";
  for (std::size_t at = element.find(name); at != element.npos; at = element.find(name, at + 1)) {
    std::string_view rest = element.substr(at + name.size());
    rest.remove_prefix(std::min(rest.find_first_not_of(spaces), rest.size()));
    if (at == 0 || spaces.find(element[at - 1]) == spaces.npos || !rest.starts_with('=')) continue;
    rest.remove_prefix(std::min(rest.find_first_not_of(spaces, 1), rest.size()));
    if (!rest.starts_with('"') && !rest.starts_with('\'')) continue;
    return rest.substr(1, rest.find(rest[0], 1) - 1);
  }
  return {};
}

/// Files of VTK's XML formats are often called .vtk; what they hold says which of them they are.
std::string true_ending(const std::filesystem::path& path, const std::string& ending) {
  if (ending != ".vtk") return ending;
  constexpr std::size_t longest = 2000;
  std::string start(longest, '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(start.data(), static_cast<std::streamsize>(longest));
  start.resize(static_cast<std::size_t>(stream.gcount()));
  if (start.starts_with("\xEF\xBB\xBF")) start.erase(0, 3);  // a byte order mark
  const std::size_t root = start.find("<VTKFile");
  if (!start.starts_with('<') || root == start.npos) return ending;
  const std::string_view element = std::string_view(start).substr(root, start.find('>', root) - root);
  const std::string_view type = attribute(element, "type");
  if (type == "UnstructuredGrid") return ".vtu";
  return type == "PolyData" ? ".vtp" : ending;
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
  const auto parsed = [&](const auto& parse, const std::string& text, int first) {
    VtkErrors silence;
    std::vector<std::string> messages;
    Mesh mesh = mesh_of_vtk(*parse(text, file, messages), file, first, first, mid_nodes);
    mesh.messages = std::move(messages);
    return mesh;
  };
  constexpr int from_one = 1;  // the number that the format gives its first vertex
  if (ending == ".obj") return parsed(parse_obj, read_file(path), from_one);
  if (ending == ".stl") return parsed(parse_stl, read_file(path), from_one);
  if (ending == ".off") return parsed(parse_off, read_file(path), 0);
  if (ending == ".ply") return parsed(parse_ply, read_file(path), 0);
  const std::string kind = true_ending(path, ending);
  Mesh mesh = read_isolated(file, [&] { return read_by_vtk(file, kind, mid_nodes); });
  if (kind != ending) mesh.messages.push_back(file + ": holds XML, which is a " + kind + " file, and was read as one");
  return mesh;
}

}  // namespace fascia::io
