#include "io/mesh/mesh_reader.hpp"
#include "tests/unit/io/mesh_samples.hpp"
#include "tests/unit/io/volume_samples.hpp"

#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <cmath>
#include <limits>

namespace fascia::io::result_volumes_test {
namespace {

using samples::row_of_cubes;
using samples::TemporaryDirectory;

vtkSmartPointer<vtkUnstructuredGrid> read_back(const std::filesystem::path& file) {
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  return reader->GetOutput();
}

/// The Jacobian's determinant at a cell's centre, from VTK's own shape functions.
double jacobian_at_centre(vtkCell& cell) {
  double centre[3], weights[3 * 27];
  cell.GetParametricCenter(centre);
  const auto n = static_cast<std::size_t>(cell.GetNumberOfPoints());
  cell.InterpolateDerivs(centre, weights);
  Vec3d column[3];
  for (std::size_t i = 0; i < n; ++i) {
    Vec3d x;
    cell.GetPoints()->GetPoint(static_cast<vtkIdType>(i), x.v);
    for (std::size_t c = 0; c < 3; ++c) column[c] += weights[c * n + i] * x;
  }
  return dot(column[0], cross(column[1], column[2]));
}

struct VolumeCase {
  CellType type;
  bool quadratic;
  int vtk_type;
  double jacobian;
};

TEST(WriteVolumes, every_kind_is_what_vtk_takes_it_for) {
  const TemporaryDirectory directory;
  for (const VolumeCase& c : {VolumeCase{CellType::tetrahedron, false, VTK_TETRA, 1},
                              VolumeCase{CellType::tetrahedron, true, VTK_QUADRATIC_TETRA, 1},
                              VolumeCase{CellType::hexahedron, false, VTK_HEXAHEDRON, 1},
                              VolumeCase{CellType::hexahedron, true, VTK_QUADRATIC_HEXAHEDRON, 1}}) {
    SCOPED_TRACE(c.vtk_type);
    const VisualMesh mesh = row_of_cubes(2, c.type, c.quadratic);
    const auto file = directory.path() / "a.vtu";
    write_vtu(file, mesh);
    const auto grid = read_back(file);
    ASSERT_EQ(grid->GetNumberOfCells(), static_cast<vtkIdType>(mesh.volumes[0].size()));
    vtkDataArray* number = grid->GetCellData()->GetArray("number");
    ASSERT_NE(number, nullptr);
    for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell) {
      EXPECT_EQ(grid->GetCellType(cell), c.vtk_type);
      EXPECT_NEAR(jacobian_at_centre(*grid->GetCell(cell)), c.jacobian, 1e-14);
      EXPECT_EQ(number->GetComponent(cell, 0), static_cast<double>(cell) + 1);
    }

    const Mesh read = read_mesh(file, MidNodes::keep);
    ASSERT_EQ(read.blocks.size(), 1u);
    const CellBlock& block = read.blocks[0];
    EXPECT_EQ(block.type, c.type);
    const VisualCells& written = mesh.volumes[0];
    std::vector<int> nodes;
    const std::size_t corners = at(node_count(c.type)), mid_nodes = at(block.mid_nodes_per_cell);
    for (std::size_t k = 0; k < block.size(); ++k) {
      for (std::size_t n = 0; n < corners; ++n) nodes.push_back(block.nodes[corners * k + n]);
      for (std::size_t n = 0; n < mid_nodes; ++n) nodes.push_back(block.mid_nodes[mid_nodes * k + n]);
    }
    EXPECT_EQ(nodes, written.nodes);
    EXPECT_EQ(read.points, mesh.points);
  }
}

TEST(WriteVolumes, come_before_other_cells) {
  const TemporaryDirectory directory;
  VisualMesh mesh = row_of_cubes(2, CellType::hexahedron, false);
  mesh.volumes.push_back({CellType::tetrahedron, false, {0, 1, 2, 5}});
  mesh.cell_fields = {{"number", 1, {1, 2, 3}}, {"axis", 3, {1, 0, 0, 0, 1, 0, 0, 0, 1}}};
  mesh.triangles = {{0, 1, 2}};
  mesh.lines = {{0, 1}};
  mesh.vertices = {4};
  mesh.part = {0, 0, 3, 4, 5, 1};
  write_vtu(directory.path() / "a.vtu", mesh);
  const auto grid = read_back(directory.path() / "a.vtu");
  const std::vector<int> types{VTK_HEXAHEDRON, VTK_HEXAHEDRON, VTK_TETRA, VTK_TRIANGLE, VTK_LINE, VTK_VERTEX};
  ASSERT_EQ(grid->GetNumberOfCells(), 6);
  const std::vector<double> numbers{1, 2, 3, 0, 0, 0}, axes_z{0, 0, 1, 0, 0, 0};
  for (vtkIdType c = 0; c < 6; ++c) {
    const auto i = static_cast<std::size_t>(c);
    EXPECT_EQ(grid->GetCellType(c), types[i]);
    EXPECT_EQ(grid->GetCellData()->GetArray("part")->GetComponent(c, 0), mesh.part[i]);
    EXPECT_EQ(grid->GetCellData()->GetArray("number")->GetComponent(c, 0), numbers[i]);
    EXPECT_EQ(grid->GetCellData()->GetArray("axis")->GetComponent(c, 2), axes_z[i]);
  }
}

TEST(WriteVolumes, refuses_what_is_wrong) {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "a.vtu";
  const VisualMesh good = row_of_cubes(2, CellType::hexahedron, true);
  VisualMesh mesh = good;
  mesh.volumes[0].nodes.pop_back();
  EXPECT_THROW(write_vtu(file, mesh), std::logic_error);
  mesh = good;
  mesh.volumes[0].nodes[7] = -1;
  EXPECT_THROW(write_vtu(file, mesh), std::logic_error);
  mesh = good;
  mesh.volumes[0].type = CellType::wedge;
  EXPECT_THROW(write_vtu(file, mesh), std::logic_error);
  mesh = good;
  mesh.cell_fields[0].values.push_back(1);
  EXPECT_THROW(write_vtu(file, mesh), std::logic_error);
  mesh = good;
  mesh.part.pop_back();
  EXPECT_THROW(write_vtu(file, mesh), std::logic_error);
  mesh = good;
  mesh.cell_fields[0].values[1] = std::numeric_limits<double>::quiet_NaN();
  const std::string e = samples::input_error([&] { write_vtu(file, mesh); });
  EXPECT_NE(e.find("\"number\" is not finite at cell 1"), std::string::npos) << e;
  EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace fascia::io::result_volumes_test
