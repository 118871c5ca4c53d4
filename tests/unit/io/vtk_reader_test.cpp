#include "core/geometry/surface.hpp"
#include "io/mesh/mesh_reader.hpp"
#include "tests/unit/io/mesh_samples.hpp"
#include "tests/unit/io/vtk_samples.hpp"

namespace fascia::io::vtk_reader_test {
namespace {

using samples::input_error;
using samples::TemporaryDirectory;

TEST(VtkReader, every_format) {
  const TemporaryDirectory directory;
  for (const samples::VtkSample& sample : samples::vtk_samples) {
    SCOPED_TRACE(sample.file);
    const ClosedSurface s = closed_surface(read_mesh(directory.write(sample.file, sample.text)));
    EXPECT_NEAR(s.volume, 1. / 6, 1e-15);
    EXPECT_EQ(s.mesh.points.size(), 4u);
    EXPECT_EQ(s.mesh.triangles.size(), 4u);
  }
}

TEST(VtkReader, xml_is_told_by_what_a_file_called_vtk_holds) {
  const TemporaryDirectory directory;
  int files = 0;
  for (const samples::VtkSample& sample : samples::vtk_samples) {
    for (const std::string kind : {"UnstructuredGrid", "PolyData"}) {
      const std::string text = sample.text, start = "<VTKFile type=\"" + kind + "\"";
      const std::size_t place = text.find(start);
      if (place == text.npos) continue;
      ++files;
      for (const std::string& other :
           {start, "<VTKFile subtype=\"x\" type = '" + kind + "'", "<VTKFile\n\ttype=\"" + kind + "\""}) {
        const std::string file = text.substr(0, place) + other + text.substr(place + start.size());
        EXPECT_NEAR(closed_surface(read_mesh(directory.write("a.vtk", file))).volume, 1. / 6, 1e-15) << other;
      }
    }
  }
  EXPECT_EQ(files, 2);
}

/// A legacy file of one cell on the points of the unit cube.
std::string one_cell(int type, const std::string& nodes, int count) {
  return "# vtk DataFile Version 3.0\nsample\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n"
         "0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\nCELLS 1 " +
         std::to_string(count + 1) + "\n" + std::to_string(count) + " " + nodes + "\nCELL_TYPES 1\n" +
         std::to_string(type) + "\n";
}

double volume_of(const TemporaryDirectory& directory, const std::string& text) {
  const ClosedSurface s = closed_surface(read_mesh(directory.write("a.vtk", text)));
  for (const std::string& message : s.messages) EXPECT_EQ(message.find("turned over"), std::string::npos) << message;
  return s.volume;
}

TEST(VtkReader, kinds_of_cells_have_their_orientation) {
  const TemporaryDirectory directory;
  EXPECT_NEAR(volume_of(directory, one_cell(12, "0 1 2 3 4 5 6 7", 8)), 1, 1e-15);
  EXPECT_NEAR(volume_of(directory, one_cell(11, "0 1 3 2 4 5 7 6", 8)), 1, 1e-15);
  EXPECT_NEAR(volume_of(directory, one_cell(13, "0 2 1 4 6 5", 6)), 0.5, 1e-15);
  EXPECT_NEAR(volume_of(directory, one_cell(14, "0 1 2 3 4", 5)), 1. / 3, 1e-15);
}

TEST(VtkReader, polygons_and_strips_become_triangles) {
  const TemporaryDirectory directory;
  const std::string text =
      "# vtk DataFile Version 3.0\nsample\nASCII\nDATASET POLYDATA\nPOINTS 12 double\n"
      "0 0 0 2 0 0 3 1 0 2 2 0 0 2 0 1 1 0  0 0 1 2 0 1 3 1 1 2 2 1 0 2 1 1 1 1\n"
      "POLYGONS 2 14\n6 0 5 4 3 2 1\n6 6 7 8 9 10 11\n"
      "TRIANGLE_STRIPS 1 15\n14 6 0 7 1 8 2 9 3 10 4 11 5 6 0\n";
  const Mesh mesh = read_mesh(directory.write("a.vtk", text));
  const ClosedSurface s = closed_surface(mesh);
  EXPECT_EQ(s.mesh.triangles.size(), 4u + 4u + 12u);
  EXPECT_NEAR(s.volume, 4, 1e-14);
}

TEST(VtkReader, quadratic_cells_keep_their_corners) {
  const TemporaryDirectory directory;
  const std::string text =
      "# vtk DataFile Version 3.0\nsample\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 10 double\n"
      "0 0 0 1 0 0 0 1 0 0 0 1 .5 0 0 .5 .5 0 0 .5 0 0 0 .5 .5 0 .5 0 .5 .5\n"
      "CELLS 1 11\n10 0 1 2 3 4 5 6 7 8 9\nCELL_TYPES 1\n24\n";
  EXPECT_EQ(read_mesh(directory.write("a.vtk", text)).points.size(), 4u);
  EXPECT_NEAR(volume_of(directory, text), 1. / 6, 1e-15);
}

TEST(VtkReader, wrong_cells_are_named) {
  const TemporaryDirectory directory;
  const auto error = [&](const std::string& text) {
    return input_error([&] { read_mesh(directory.write("a.vtk", text)); });
  };
  EXPECT_NE(error(one_cell(10, "0 1 2 9", 4)).find("cell 0 uses node 9, but the mesh has 8 nodes"), std::string::npos);
  EXPECT_NE(error(one_cell(10, "0 1 2 -1", 4)).find("cell 0 uses node -1"), std::string::npos);
  EXPECT_NE(error(one_cell(10, "0 1 2", 3)).find("cell 0 has 3 nodes; must have 4"), std::string::npos);
  EXPECT_NE(error(one_cell(41, "0 1 2 3", 4)).find("type 41, which is not supported"), std::string::npos);
  EXPECT_NE(error("# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 1 double\n0 0 0\n").find("no cells"),
            std::string::npos);
  EXPECT_NE(error("# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nORIGIN 0 0 0\n"
                  "SPACING 1 1 1\n")
                .find("must hold an unstructured grid or polygonal data"),
            std::string::npos);
}

TEST(VtkReader, obj_keeps_the_numbers_of_the_file) {
  const TemporaryDirectory directory;
  // Open at the edge between vertices 2 and 3; texture coordinates differ from corner to corner.
  const auto file = directory.write("a.obj",
                                    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\n"
                                    "f 1/1 2/2 4/3\nf 2/3 3/1 4/2\nf 1/2 4/1 3/3\n");
  const Mesh mesh = read_mesh(file);
  EXPECT_EQ(mesh.points.size(), 4u);
  const std::string e = input_error([&] { closed_surface(mesh); });
  EXPECT_NE(e.find("open: 3 edges have one triangle only, the first between nodes 1 and 2"), std::string::npos) << e;
}

TEST(ObjReader, relative_indices_and_continued_lines) {
  const TemporaryDirectory directory;
  const auto file =
      directory.write("a.obj",
                      "o thing\nv 0 0 0 1\nv 1 0 0\nv 0 1 0\nf -3 -1 -2\nv 0 0 1\ng side\nusemtl none\ns off\n"
                      "f -4 -3 -1\nf 2 \\\n3 4\nf 1 4 3 # the last\nl 1 2\n");
  EXPECT_NEAR(closed_surface(read_mesh(file)).volume, 1. / 6, 1e-15);
}

TEST(ObjReader, lines_end_as_on_any_system) {
  const TemporaryDirectory directory;
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    std::string text;
    for (const char* line : {"v 0 0 0", "v 1 0 0", "v 0 1 0", "f 1 2 3", "f 1 2 9"}) text += line + end;
    const auto file = directory.write("a.obj", text);
    EXPECT_EQ(input_error([&] { read_mesh(file); }).substr(file.string().size()).substr(0, 3), ":5:") << text;
  }
}

TEST(ObjReader, stray_bytes_around_the_text_are_left_out) {
  const TemporaryDirectory directory;
  const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  for (const std::string& stray : {std::string("\x1A"), std::string("\n\0", 2), std::string("\0\n", 2)}) {
    const auto file = directory.write("a.obj", "\xEF\xBB\xBF" + text + stray);
    const Mesh mesh = read_mesh(file);
    EXPECT_EQ(mesh.points.size(), 3u);
    EXPECT_EQ(mesh.messages, std::vector<std::string>{file.string() + ": left out 1 byte behind the last line that "
                                                                      "belongs to no text"});
  }
}

TEST(VtkReader, xml_in_a_legacy_file_is_read_as_what_it_is) {
  const TemporaryDirectory directory;
  const std::string grid =
      "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\"><UnstructuredGrid><Piece NumberOfPoints=\"3\" "
      "NumberOfCells=\"1\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 "
      "0 1 0</DataArray></Points><Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 "
      "2</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray><DataArray type=\"UInt8\" "
      "Name=\"types\" format=\"ascii\">5</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>\n";
  std::string single = grid;  // the quotes that XML has too
  std::replace(single.begin(), single.end(), '"', '\'');
  for (const std::string& text : {grid, "<?xml version=\"1.0\"?>\n" + grid, "\xEF\xBB\xBF" + grid, single}) {
    const auto file = directory.write("a.vtk", text);
    const Mesh mesh = read_mesh(file);
    EXPECT_EQ(mesh.points.size(), 3u);
    EXPECT_EQ(mesh.messages,
              std::vector<std::string>{file.string() + ": holds XML, which is a .vtu file, and was read as one"});
  }
}

/// VTK goes on with zeros where numbers are missing, and warns of it alone.
TEST(VtkReader, MissingNumbersAreNoZeros) {
  const TemporaryDirectory directory;
  const auto file = directory.write("a.vtk",
                                    "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n"
                                    "0 0 0\n1 0 0\n1 1 0\n0 1\nPOLYGONS 2 8\n3 0 1 2\n3 0 2 3\n");
  EXPECT_NE(input_error([&] { read_mesh(file); }).find("is no readable .vtk mesh (Error reading ascii data"),
            std::string::npos);
}

TEST(ObjReader, errors_name_the_line) {
  const TemporaryDirectory directory;
  const auto error = [&](const std::string& text) {
    const auto file = directory.write("a.obj", text);
    return input_error([&] { read_mesh(file); }).substr(file.string().size());
  };
  EXPECT_EQ(error("v 0 0\n"), ":1: expected a coordinate, found the end of the line; must be a finite number");
  EXPECT_EQ(error("v 0 0 nan\n"), ":1: expected a coordinate, found \"nan\"; must be a finite number");
  EXPECT_EQ(error("v 0 0 0\nf 1 1\n"), ":2: a face has 2 vertices; must have at least 3");
  EXPECT_EQ(error("v 0 0 0\n\nf 1 2 1\n"), ":3: a face uses vertex 2, but there are 1 up to here; correct the face");
  EXPECT_EQ(error("v 0 0 0\nf 1 1 0\n"), ":2: a face uses vertex 0, but there are 1 up to here; correct the face");
  EXPECT_EQ(error("v 0 0 0\nf 1 1 -2\n"), ":2: a face uses vertex -2, but there are 1 up to here; correct the face");
  EXPECT_EQ(error("v 0 0 0\nf 1 1 x\n"), ":2: expected a vertex number, found \"x\"; must be a whole number");
  EXPECT_EQ(error("v 0 0 0\nfoo 1\n"), ":2: \"foo\" is no statement of an OBJ file; write the file again");
  EXPECT_NE(error("v 0 0 0\n").find("has no cells"), std::string::npos);
}

}  // namespace
}  // namespace fascia::io::vtk_reader_test
