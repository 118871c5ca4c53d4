#include "io/result_writer.hpp"

#include "core/base/errors.hpp"
#include "io/files.hpp"
#include "io/vtk_deflate.hpp"
#include "io/vtk_errors.hpp"
#include "io/vtk_threads.hpp"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkErrorCode.h>
#include <vtkInformation.h>
#include <vtkInformationStringKey.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <new>
#include <span>
#include <stdexcept>
#include <utility>

namespace fascia::io {
namespace {

std::size_t volume_count(const VisualMesh& mesh) {
  std::size_t count = 0;
  for (const VisualCells& cells : mesh.volumes) count += cells.size();
  return count;
}

std::size_t cell_count(const VisualMesh& mesh) {
  return volume_count(mesh) + mesh.triangles.size() + mesh.lines.size() + mesh.vertices.size();
}

/// Sizes and indices are the caller's business: a mismatch is a bug, not input.
void check_sizes(const VisualMesh& mesh) {
  const auto n_points = static_cast<int>(mesh.points.size());
  const auto valid = [&](int node) { return node >= 0 && node < n_points; };
  bool right = mesh.part.empty() || mesh.part.size() == cell_count(mesh);
  for (const VisualCells& cells : mesh.volumes) {
    right = right &&
            (cells.type == CellType::tetrahedron || cells.type == CellType::hexahedron ||
             (cells.type == CellType::triangle && !cells.quadratic)) &&
            cells.nodes.size() % cells.nodes_per_cell() == 0;
    for (const int node : cells.nodes) right = right && valid(node);
  }
  for (const auto& triangle : mesh.triangles)
    for (const int node : triangle) right = right && valid(node);
  for (const auto& line : mesh.lines)
    for (const int node : line) right = right && valid(node);
  for (const int node : mesh.vertices) right = right && valid(node);
  const auto fits = [](const FieldArray& field, std::size_t count) {
    return field.components > 0 && field.values.size() == count * static_cast<std::size_t>(field.components);
  };
  for (const FieldArray& field : mesh.point_fields) right = right && fits(field, mesh.points.size());
  for (const FieldArray& field : mesh.cell_fields) right = right && fits(field, volume_count(mesh));
  if (!right) throw std::logic_error("write_vtu: arrays and indices do not fit the points and cells");
}

void check_finite(const std::filesystem::path& file, const VisualMesh& mesh) {
  const auto fail = [&](const std::string& name, const char* place, std::size_t index) {
    throw StateError(fmt::format("{}: \"{}\" is not finite at {} {}; the state that it shows is wrong",
                                 file.filename().string(), name, place, index));
  };
  const auto check = [&](const std::vector<FieldArray>& fields, const char* place) {
    for (const FieldArray& field : fields)
      for (std::size_t i = 0; i < field.values.size(); ++i)
        if (!std::isfinite(field.values[i])) fail(field.name, place, i / static_cast<std::size_t>(field.components));
  };
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
    for (const double x : mesh.points[p].v)
      if (!std::isfinite(x)) fail("points", "point", p);
  check(mesh.point_fields, "point");
  check(mesh.cell_fields, "cell");
}

void add_points(vtkUnstructuredGrid& grid, const VisualMesh& mesh) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(mesh.points.size()));
  for (std::size_t p = 0; p < mesh.points.size(); ++p) points->SetPoint(static_cast<vtkIdType>(p), mesh.points[p].v);
  grid.SetPoints(points);
}

int vtk_type(const VisualCells& cells) {
  if (cells.type == CellType::triangle) return VTK_TRIANGLE;
  if (cells.type == CellType::tetrahedron) return cells.quadratic ? VTK_QUADRATIC_TETRA : VTK_TETRA;
  return cells.quadratic ? VTK_QUADRATIC_HEXAHEDRON : VTK_HEXAHEDRON;
}

void add_cells(vtkUnstructuredGrid& grid, const VisualMesh& mesh) {
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkUnsignedCharArray> types;
  for (const VisualCells& block : mesh.volumes)
    for (std::size_t first = 0; first < block.nodes.size(); first += block.nodes_per_cell()) {
      cells->InsertNextCell(static_cast<int>(block.nodes_per_cell()));
      for (std::size_t n = 0; n < block.nodes_per_cell(); ++n) cells->InsertCellPoint(block.nodes[first + n]);
      types->InsertNextValue(static_cast<unsigned char>(vtk_type(block)));
    }
  for (const auto& triangle : mesh.triangles) {
    cells->InsertNextCell({triangle[0], triangle[1], triangle[2]});
    types->InsertNextValue(VTK_TRIANGLE);
  }
  for (const auto& line : mesh.lines) {
    cells->InsertNextCell({line[0], line[1]});
    types->InsertNextValue(VTK_LINE);
  }
  for (const int vertex : mesh.vertices) {
    cells->InsertNextCell({vertex});
    types->InsertNextValue(VTK_VERTEX);
  }
  grid.SetCells(types, cells);
}

/// @param count  of points or cells; those beyond the field's own get zeros
void add_field(vtkFieldData& data, const FieldArray& field, std::size_t count) {
  vtkNew<vtkDoubleArray> array;
  array->SetName(field.name.c_str());
  array->SetNumberOfComponents(field.components);
  const auto size = static_cast<vtkIdType>(count) * field.components;
  if (static_cast<std::size_t>(size) == field.values.size()) {  // as it is; VTK only reads it
    array->SetArray(const_cast<double*>(field.values.data()), size, 1);
  } else {
    array->SetNumberOfTuples(static_cast<vtkIdType>(count));
    array->Fill(0);
    for (std::size_t i = 0; i < field.values.size(); ++i) array->SetValue(static_cast<vtkIdType>(i), field.values[i]);
  }
  if (!field.unit.empty()) array->GetInformation()->Set(vtkDataArray::UNITS_LABEL(), field.unit.c_str());
  data.AddArray(array);
}

void add_fields(vtkUnstructuredGrid& grid, const VisualMesh& mesh) {
  for (const FieldArray& field : mesh.point_fields) add_field(*grid.GetPointData(), field, mesh.points.size());
  for (const FieldArray& field : mesh.cell_fields) add_field(*grid.GetCellData(), field, cell_count(mesh));
  if (mesh.part.empty()) return;
  vtkNew<vtkIntArray> part;
  part->SetName("part");
  for (const int p : mesh.part) part->InsertNextValue(p);
  grid.GetCellData()->AddArray(part);
}

void add_origin(vtkUnstructuredGrid& grid, const VisualMesh& mesh) {
  vtkNew<vtkDoubleArray> time;
  time->SetName("TimeValue");
  time->InsertNextValue(mesh.time);
  grid.GetFieldData()->AddArray(time);
  if (mesh.provenance.empty()) return;
  vtkNew<vtkStringArray> provenance;
  provenance->SetName("provenance");
  provenance->InsertNextValue(mesh.provenance);
  grid.GetFieldData()->AddArray(provenance);
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  return result;
}

void fill(vtkUnstructuredGrid& grid, const VisualMesh& mesh) {
  check_sizes(mesh);
  add_points(grid, mesh);
  add_cells(grid, mesh);
  add_fields(grid, mesh);
}

std::vector<vtkDataArray*> arrays_of(vtkUnstructuredGrid& grid) {
  std::vector<vtkDataArray*> arrays{grid.GetPoints()->GetData(), grid.GetCells()->GetConnectivityArray(),
                                    grid.GetCells()->GetOffsetsArray(), grid.GetCellTypesArray()};
  for (vtkFieldData* data :
       {static_cast<vtkFieldData*>(grid.GetPointData()), static_cast<vtkFieldData*>(grid.GetCellData())})
    for (int k = 0; k < data->GetNumberOfArrays(); ++k) arrays.push_back(data->GetArray(k));
  return arrays;
}

std::span<const unsigned char> bytes_of(vtkDataArray& array) {
  const std::size_t size =
      static_cast<std::size_t>(array.GetNumberOfValues()) * static_cast<std::size_t>(array.GetDataTypeSize());
  if (size == 0) return {};
  return {static_cast<const unsigned char*>(array.GetVoidPointer(0)), size};
}

/// Of an array: the writer compresses blocks, of which some are taken as samples, evenly spaced.
double estimated_size(vtkDataArray& array, VtkDeflate& compressor) {
  constexpr std::size_t block = 32768, most_samples = 6;  // the writer's block; enough for a few percent
  const std::span<const unsigned char> bytes = bytes_of(array);
  const std::size_t size = bytes.size();
  if (size == 0) return 0;
  const std::size_t blocks = (size + block - 1) / block, samples = std::min(blocks, most_samples);
  double taken = 0, compressed = 0;
  std::vector<unsigned char> space(compressor.GetMaximumCompressionSpace(block));
  for (std::size_t k = 0; k < samples; ++k) {
    const std::size_t begin = k * blocks / samples * block, length = std::min(block, size - begin);
    taken += static_cast<double>(length);
    compressed += static_cast<double>(compressor.Compress(bytes.data() + begin, length, space.data(), space.size()));
  }
  return compressed / taken * static_cast<double>(size) + 4 * static_cast<double>(blocks);
}

}  // namespace

double estimated_size(const VisualMesh& mesh) {
  vtkNew<vtkUnstructuredGrid> grid;
  fill(*grid, mesh);
  vtkNew<VtkDeflate> compressor;
  double size = 1000;  // the description
  for (vtkDataArray* array : arrays_of(*grid)) size += 200 + estimated_size(*array, *compressor);
  return size;
}

void write_vtu(const std::filesystem::path& file, const VisualMesh& mesh, ThreadPool* pool) {
  vtkNew<vtkUnstructuredGrid> grid;
  fill(*grid, mesh);
  add_origin(*grid, mesh);
  check_finite(file, mesh);

  // Into memory first: one place then checks that the whole file reaches the disk.
  VtkErrors errors;
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  writer->SetInputData(grid);
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  const vtkNew<VtkDeflate> compressor;
  if (pool != nullptr) {
    std::vector<std::span<const unsigned char>> arrays;
    for (vtkDataArray* array : arrays_of(*grid)) arrays.push_back(bytes_of(*array));
    compressor->look_ahead(std::move(arrays), *pool);
  }
  writer->SetCompressor(compressor);
  writer->WriteToOutputStringOn();
  int written = 0;
  without_vtk_threads([&] { written = writer->Write(); });
  // A stream into memory fails where memory ends; VTK takes it for a full disk, or says what the system said.
  const unsigned long code = writer->GetErrorCode();
  if (code == vtkErrorCode::OutOfDiskSpaceError || code == ENOMEM) throw std::bad_alloc();
  if (written == 0 || !errors.first().empty())
    throw FileError(fmt::format("{}: cannot be written: {}", file.string(), errors.first()));
  replace_file(file, writer->GetOutputString());
}

Collection::Collection(const std::filesystem::path& file)
    : path_(file),
      file_(file,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  "
            "<Collection>\n",
            "  </Collection>\n</VTKFile>\n") {}

void Collection::add(double time, const std::string& body, const std::string& state) {
  if (!std::isfinite(time)) throw InputError(fmt::format("{}: a time is not finite", path_.string()));
  const auto part = std::find(bodies_.begin(), bodies_.end(), body) - bodies_.begin();
  file_.append(fmt::format("    <DataSet timestep=\"{}\" group=\"\" part=\"{}\" name=\"{}\" file=\"{}\"/>\n", time,
                           part, escaped(body), escaped(state)));
  if (part == std::ssize(bodies_)) bodies_.push_back(body);
}

}  // namespace fascia::io
