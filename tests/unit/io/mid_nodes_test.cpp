#include "core/base/index.hpp"
#include "io/gmsh/gmsh.hpp"
#include "io/mesh/mesh_reader.hpp"
#include "tests/unit/io/mesh_samples.hpp"

#include <vtkCell.h>
#include <vtkCellType.h>
#include <vtkGenericCell.h>
#include <vtkHigherOrderHexahedron.h>
#include <vtkHigherOrderQuadrilateral.h>
#include <vtkIdList.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>

#include <sstream>

// Mid-side nodes of quadratic cells: each must lie half-way between the corners of its edge.
namespace fascia::io::mid_nodes_test {
namespace {

using samples::input_error;
using samples::TemporaryDirectory;
using Edges = std::vector<std::array<int, 2>>;

/// Edges in the order that CellBlock promises.
Edges edges_of(CellType type) {
  switch (type) {
    case CellType::line:
      return {{0, 1}};
    case CellType::triangle:
      return {{0, 1}, {1, 2}, {2, 0}};
    case CellType::quadrilateral:
      return {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
    case CellType::tetrahedron:
      return {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
    default:
      return {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
  }
}

void expect_half_way(const Mesh& mesh, const CellBlock& block) {
  const Edges edges = edges_of(block.type);
  ASSERT_EQ(at(block.mid_nodes_per_cell), edges.size());
  ASSERT_EQ(block.mid_nodes.size(), edges.size() * block.size());
  for (std::size_t c = 0; c < block.size(); ++c)
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const auto corner = [&](int n) {
        return mesh.points[at(block.nodes[c * at(node_count(block.type)) + at(edges[e][at(n)])])];
      };
      const Vec3d middle = 0.5 * (corner(0) + corner(1));
      EXPECT_LT(norm(mesh.points[at(block.mid_nodes[c * edges.size() + e])] - middle), 1e-14) << c << " " << e;
    }
}

// ------------------------------------------------------------------------------------------------------------- Gmsh

/// A kind of Gmsh: its edges in the order of Gmsh's manual, and the number of nodes behind them.
struct GmshKind {
  int number;
  CellType type;
  std::vector<Vec3d> corners;
  Edges edges;
  int inner;
};

std::vector<GmshKind> gmsh_kinds() {
  const std::vector<Vec3d> cube = samples::cube_points();
  const std::vector<Vec3d> tetrahedron{{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}};
  const std::vector<Vec3d> square(cube.begin(), cube.begin() + 4), triangle(cube.begin(), cube.begin() + 3);
  const std::vector<Vec3d> line(cube.begin(), cube.begin() + 2);
  const Edges around{{0, 1}, {1, 2}, {2, 3}, {3, 0}};
  const Edges of_hexahedron{{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3},
                            {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}};
  return {{8, CellType::line, line, {{0, 1}}, 0},
          {9, CellType::triangle, triangle, {{0, 1}, {1, 2}, {2, 0}}, 0},
          {10, CellType::quadrilateral, square, around, 1},
          {16, CellType::quadrilateral, square, around, 0},
          {11, CellType::tetrahedron, tetrahedron, {{0, 1}, {1, 2}, {2, 0}, {3, 0}, {3, 2}, {3, 1}}, 0},
          {12, CellType::hexahedron, cube, of_hexahedron, 7},
          {17, CellType::hexahedron, cube, of_hexahedron, 0}};
}

/// One cell, with its inner nodes far away.
std::string gmsh_file(const GmshKind& kind) {
  std::vector<Vec3d> points = kind.corners;
  for (const auto& edge : kind.edges) points.push_back(0.5 * (points[at(edge[0])] + points[at(edge[1])]));
  for (int n = 0; n < kind.inner; ++n) points.push_back({{9, 9, 9}});
  std::ostringstream text;
  text << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" << points.size() << "\n";
  for (std::size_t p = 0; p < points.size(); ++p)
    text << p + 1 << " " << points[p][0] << " " << points[p][1] << " " << points[p][2] << "\n";
  text << "$EndNodes\n$Elements\n1\n1 " << kind.number << " 0";
  for (std::size_t p = 0; p < points.size(); ++p) text << " " << p + 1;
  text << "\n$EndElements\n";
  return text.str();
}

TEST(MidNodes, of_every_quadratic_kind_of_gmsh) {
  for (const GmshKind& kind : gmsh_kinds()) {
    SCOPED_TRACE(kind.number);
    const Mesh mesh = parse_gmsh(gmsh_file(kind), "a.msh", MidNodes::keep);
    ASSERT_EQ(mesh.blocks.size(), 1u);
    EXPECT_EQ(mesh.blocks[0].type, kind.type);
    EXPECT_EQ(mesh.points.size(), kind.corners.size() + kind.edges.size());
    expect_half_way(mesh, mesh.blocks[0]);
    const Mesh linear = parse_gmsh(gmsh_file(kind), "a.msh");
    EXPECT_EQ(linear.points.size(), kind.corners.size());
    EXPECT_EQ(linear.blocks[0].mid_nodes_per_cell, 0);
    EXPECT_TRUE(linear.blocks[0].mid_nodes.empty());
  }
}

TEST(MidNodes, linear_and_quadratic_cells_lie_in_separate_blocks) {
  const std::string text =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n7\n"
      "1 0 0 0\n2 1 0 0\n3 0 1 0\n4 .5 0 0\n5 .5 .5 0\n6 0 .5 0\n7 1 1 0\n"
      "$EndNodes\n$Elements\n3\n1 9 0 1 2 3 4 5 6\n2 2 0 2 7 3\n3 2 0 1 2 3\n$EndElements\n";
  const Mesh mesh = parse_gmsh(text, "a.msh", MidNodes::keep);
  ASSERT_EQ(mesh.blocks.size(), 2u);
  EXPECT_EQ(mesh.blocks[0].file_number, std::vector<std::int64_t>{1});
  EXPECT_EQ(mesh.blocks[0].mid_nodes, (std::vector<int>{3, 4, 5}));
  EXPECT_EQ(mesh.blocks[1].file_number, (std::vector<std::int64_t>{2, 3}));
  EXPECT_EQ(mesh.blocks[1].mid_nodes_per_cell, 0);
  EXPECT_EQ(parse_gmsh(text, "a.msh").blocks.size(), 1u);
}

TEST(MidNodes, of_a_wedge_are_dropped) {
  std::ostringstream text;
  text << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n15\n";
  for (int n = 1; n <= 15; ++n) text << n << " " << n << " " << n * n << " 0\n";
  text << "$EndNodes\n$Elements\n1\n1 18 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15\n$EndElements\n";
  const Mesh mesh = parse_gmsh(text.str(), "a.msh", MidNodes::keep);
  EXPECT_EQ(mesh.points.size(), 6u);
  EXPECT_EQ(mesh.blocks[0].mid_nodes_per_cell, 0);
}

// -------------------------------------------------------------------------------------------------------------- VTK

/// One cell of a VTK type at its parametric coordinates, as VTK itself orders them.
std::string vtk_file(int type, int size) {
  const auto cell = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(type));
  cell->PointIds->SetNumberOfIds(size);
  cell->Points->SetNumberOfPoints(size);
  if (auto* quadrilateral = vtkHigherOrderQuadrilateral::SafeDownCast(cell)) quadrilateral->SetOrder(2, 2);
  if (auto* hexahedron = vtkHigherOrderHexahedron::SafeDownCast(cell)) hexahedron->SetOrder(2, 2, 2);
  cell->Initialize();
  const double* x = cell->GetParametricCoords();
  std::ostringstream text;
  text << "# vtk DataFile Version 3.0\nsample\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " << size << " double\n";
  for (int c = 0; c < 3 * size; ++c) text << x[c] << " ";
  text << "\nCELLS 1 " << size + 1 << "\n" << size;
  for (int n = 0; n < size; ++n) text << " " << n;
  text << "\nCELL_TYPES 1\n" << type << "\n";
  return text.str();
}

struct VtkCase {
  int type, size;
  CellType kind;
};

TEST(MidNodes, of_every_quadratic_kind_of_vtk) {
  const TemporaryDirectory directory;
  const std::vector<VtkCase> cases{{VTK_QUADRATIC_EDGE, 3, CellType::line},
                                   {VTK_LAGRANGE_CURVE, 3, CellType::line},
                                   {VTK_QUADRATIC_TRIANGLE, 6, CellType::triangle},
                                   {VTK_BIQUADRATIC_TRIANGLE, 7, CellType::triangle},
                                   {VTK_LAGRANGE_TRIANGLE, 6, CellType::triangle},
                                   {VTK_QUADRATIC_QUAD, 8, CellType::quadrilateral},
                                   {VTK_BIQUADRATIC_QUAD, 9, CellType::quadrilateral},
                                   {VTK_LAGRANGE_QUADRILATERAL, 9, CellType::quadrilateral},
                                   {VTK_QUADRATIC_TETRA, 10, CellType::tetrahedron},
                                   {VTK_LAGRANGE_TETRAHEDRON, 10, CellType::tetrahedron},
                                   {VTK_QUADRATIC_HEXAHEDRON, 20, CellType::hexahedron},
                                   {VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON, 24, CellType::hexahedron},
                                   {VTK_TRIQUADRATIC_HEXAHEDRON, 27, CellType::hexahedron}};
  for (const VtkCase& c : cases) {
    SCOPED_TRACE(c.type);
    const auto file = directory.write("a.vtk", vtk_file(c.type, c.size));
    const Mesh mesh = read_mesh(file, MidNodes::keep);
    ASSERT_EQ(mesh.blocks.size(), 1u);
    EXPECT_EQ(mesh.blocks[0].type, c.kind);
    EXPECT_EQ(mesh.points.size(), at(node_count(c.kind) + mid_node_count(c.kind)));
    expect_half_way(mesh, mesh.blocks[0]);
    EXPECT_EQ(read_mesh(file).points.size(), at(node_count(c.kind)));
  }
}

TEST(MidNodes, of_other_orders_and_lagrange_hexahedra_are_dropped) {
  const TemporaryDirectory directory;
  for (const VtkCase& c :
       {VtkCase{VTK_LAGRANGE_TETRAHEDRON, 20, CellType::tetrahedron}, VtkCase{VTK_CUBIC_LINE, 4, CellType::line},
        VtkCase{VTK_LAGRANGE_HEXAHEDRON, 27, CellType::hexahedron},
        VtkCase{VTK_QUADRATIC_WEDGE, 15, CellType::wedge}}) {
    SCOPED_TRACE(c.type);
    const Mesh mesh = read_mesh(directory.write("a.vtk", vtk_file(c.type, c.size)), MidNodes::keep);
    EXPECT_EQ(mesh.points.size(), at(node_count(c.kind)));
    EXPECT_EQ(mesh.blocks[0].mid_nodes_per_cell, 0);
  }
}

TEST(MidNodes, of_a_cell_with_too_few_nodes) {
  const TemporaryDirectory directory;
  const auto file = directory.write("a.vtk",
                                    "# vtk DataFile Version 3.0\nsample\nASCII\nDATASET UNSTRUCTURED_GRID\n"
                                    "POINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\n"
                                    "CELL_TYPES 1\n24\n");
  const std::string e = input_error([&] { read_mesh(file, MidNodes::keep); });
  EXPECT_NE(e.find("cell 0 has 4 nodes; must have 10"), std::string::npos) << e;
}

}  // namespace
}  // namespace fascia::io::mid_nodes_test
