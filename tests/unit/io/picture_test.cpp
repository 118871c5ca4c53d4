#include "io/picture/results.hpp"
#include "tests/unit/io/mesh_samples.hpp"
#include "tests/unit/io/volume_samples.hpp"

#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>

#include <tuple>

// What a picture shows of a result; no display is needed for it.
namespace fascia::io::picture_test {
namespace {

using samples::row_of_cubes;
using samples::TemporaryDirectory;

/// Area of the polygons [m²].
double area_of(vtkPolyData& data) {
  double area = 0;
  for (vtkIdType c = 0; c < data.GetNumberOfCells(); ++c) {
    vtkCell* cell = data.GetCell(c);
    const auto point = [&](int n) {
      Vec3d x;
      data.GetPoint(cell->GetPointId(n), x.v);
      return x;
    };
    for (int n = 2; n < static_cast<int>(cell->GetNumberOfPoints()); ++n)
      area += 0.5 * norm(cross(point(n - 1) - point(0), point(n) - point(0)));
  }
  return area;
}

PictureBody body_of(const VisualMesh& mesh, const std::string& field) {
  const TemporaryDirectory directory;
  write_vtu(directory.path() / "a.vtu", mesh);
  return read_picture_body(directory.path() / "a.vtu", field);
}

struct PictureCase {
  CellType type;
  bool quadratic;
  vtkIdType faces, edges;
};

TEST(PictureBody, outer_faces_of_volume_cells) {
  for (const PictureCase& c :
       {PictureCase{CellType::tetrahedron, false, 28, 42}, PictureCase{CellType::tetrahedron, true, 4 * 28, 42},
        PictureCase{CellType::hexahedron, false, 14, 28}, PictureCase{CellType::hexahedron, true, 6 * 14, 28}}) {
    SCOPED_TRACE(testing::Message() << static_cast<int>(c.type) << " " << c.quadratic);
    const PictureBody body = body_of(row_of_cubes(3, c.type, c.quadratic), "height");
    EXPECT_EQ(body.surface->GetNumberOfCells(), c.faces);
    EXPECT_NEAR(area_of(*body.surface), 14, 1e-12);
    EXPECT_EQ(body.edges->GetNumberOfCells(), c.edges);
    EXPECT_EQ(body.edges->GetNumberOfPoints(), 16 + (c.quadratic ? c.edges : 0));  // corners, middles
    EXPECT_EQ(body.lines->GetNumberOfCells(), 0);
    EXPECT_EQ(body.shown_on, ShownOn::points);
    vtkDataArray* shown = body.surface->GetPointData()->GetScalars();
    ASSERT_NE(shown, nullptr);
    EXPECT_STREQ(shown->GetName(), shown_array);
    for (vtkIdType p = 0; p < body.surface->GetNumberOfPoints(); ++p)
      EXPECT_NEAR(shown->GetComponent(p, 0), body.surface->GetPoint(p)[2], 1e-7);
  }
}

TEST(PictureBody, cell_field_where_no_point_field_has_the_name) {
  for (const bool quadratic : {false, true}) {
    VisualMesh mesh = row_of_cubes(3, CellType::hexahedron, quadratic);
    mesh.lines = {{0, 1}};
    mesh.part.push_back(0);
    const PictureBody body = body_of(mesh, "number");
    EXPECT_EQ(body.shown_on, ShownOn::cells);
    EXPECT_EQ(body.lines->GetNumberOfCells(), 1);
    vtkDataArray* shown = body.surface->GetCellData()->GetScalars();
    ASSERT_NE(shown, nullptr);
    for (vtkIdType c = 0; c < body.surface->GetNumberOfCells(); ++c) {
      double bounds[6];
      body.surface->GetCell(c)->GetBounds(bounds);
      const double middle = 0.5 * (bounds[0] + bounds[1]);
      const double cube = shown->GetComponent(c, 0) - 1;
      EXPECT_GE(middle, cube);
      EXPECT_LE(middle, cube + 1);
    }
  }
}

TEST(PictureBody, triangles_beside_volume_cells) {
  VisualMesh mesh = row_of_cubes(1, CellType::hexahedron, false);
  const int first = static_cast<int>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), {{{3, 0, 0}}, {{5, 0, 0}}, {{3, 1, 0}}});
  mesh.triangles = {{first, first + 1, first + 2}};
  mesh.point_fields[0].values.insert(mesh.point_fields[0].values.end(), {0, 0, 0});
  mesh.part.push_back(0);
  for (const char* field : {"height", "number", ""}) {
    const PictureBody body = body_of(mesh, field);
    EXPECT_EQ(body.surface->GetNumberOfCells(), 7) << field;
    EXPECT_NEAR(area_of(*body.surface), 7, 1e-12) << field;
  }
}

TEST(PictureBody, name_and_number_of_the_state) {
  const TemporaryDirectory directory;
  for (const auto& [file, name, state] :
       {std::tuple{"left_beam_00012.vtu", "left_beam", 12}, {"beam_3.vtu", "beam_3", -1}, {"00001.vtu", "00001", -1}}) {
    write_vtu(directory.path() / file, row_of_cubes(1, CellType::hexahedron, false));
    const PictureBody body = read_picture_body(directory.path() / file, "");
    EXPECT_EQ(body.name, name);
    EXPECT_EQ(body.state, state);
  }
}

TEST(PictureBody, shape_at_rest) {
  VisualMesh mesh = row_of_cubes(2, CellType::hexahedron, false);
  EXPECT_EQ(body_of(mesh, "").rest, nullptr);
  FieldArray rest{"rest_position", 3, {}};
  for (Vec3d& x : mesh.points) {
    rest.values.insert(rest.values.end(), x.v, x.v + 3);
    x = x * 2.0;
  }
  mesh.point_fields.push_back(rest);
  const PictureBody body = body_of(mesh, "");
  EXPECT_NEAR(area_of(*body.surface), 40, 1e-12);
  EXPECT_NEAR(area_of(*body.rest_surface), 10, 1e-12);
}

TEST(PictureBody, without_the_field_is_drawn_plain_beside_one_that_has_it) {
  VisualMesh other = row_of_cubes(2, CellType::hexahedron, false);
  other.point_fields[0].name = "depth";
  const PictureBody with = body_of(row_of_cubes(1, CellType::hexahedron, false), "height");
  const PictureBody without = body_of(other, "height");
  EXPECT_EQ(without.shown_on, ShownOn::nothing);
  EXPECT_EQ(without.surface->GetNumberOfCells(), 10);
  EXPECT_EQ(without.surface->GetPointData()->GetScalars(), nullptr);
  EXPECT_NO_THROW(check_field({without, with}, "height"));
  EXPECT_NO_THROW(check_field({without}, ""));
  EXPECT_EQ(samples::input_error([&] {
              check_field({without, without}, "height");
            }),
            "the results have no field \"height\"; they have depth, number, part");
}

/// A tetrahedron as text.
std::string vtu_text(const std::string& nodes, const std::string& type, const std::string& heights) {
  const auto array = [](const std::string& attributes, const std::string& values) {
    return "<DataArray " + attributes + " format=\"ascii\">" + values + "</DataArray>";
  };
  return "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"><UnstructuredGrid>"
         "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><PointData>" +
         array("type=\"Float64\" Name=\"height\"", heights) + "</PointData><Points>" +
         array("type=\"Float64\" NumberOfComponents=\"3\"", "0 0 0 1 0 0 0 1 0 0 0 1") + "</Points><Cells>" +
         array("type=\"Int64\" Name=\"connectivity\"", nodes) + array("type=\"Int64\" Name=\"offsets\"", "4") +
         array("type=\"UInt8\" Name=\"types\"", type) + "</Cells></Piece></UnstructuredGrid></VTKFile>";
}

TEST(PictureBody, damaged_files_are_named) {
  const TemporaryDirectory directory;
  const auto read = [&](const std::string& text) {
    return read_picture_body(directory.write("a.vtu", text), "height");
  };
  EXPECT_EQ(read(vtu_text("0 1 2 3", "10", "0 0 0 1")).surface->GetNumberOfCells(), 4);
  for (const std::string& text :
       {vtu_text("0 1 2 4", "10", "0 0 0 1"), vtu_text("0 1 2 99999999", "10", "0 0 0 1"),
        vtu_text("0 1 2 -1", "10", "0 0 0 1"), vtu_text("0 1 2 3", "12", "0 0 0 1"),
        vtu_text("0 1 2 3", "5", "0 0 0 1"), vtu_text("0 1 2 3", "10", "0 0"), std::string("no XML")}) {
    const std::string e = samples::input_error([&] { read(text); });
    EXPECT_NE(e.find("a.vtu: is no readable .vtu result"), std::string::npos) << text << "\n" << e;
  }
}

}  // namespace
}  // namespace fascia::io::picture_test
