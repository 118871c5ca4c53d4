#include "core/base/index.hpp"
#include "io/mesh/mesh_reader.hpp"
#include "tests/unit/io/mesh_samples.hpp"

namespace fascia::io::vtk_groups_test {
namespace {

using samples::input_error;
using samples::TemporaryDirectory;

/// Two tetrahedra and a triangle, with the given arrays of cells.
std::string legacy(const std::string& cell_data) {
  return "# vtk DataFile Version 3.0\nsample\nASCII\nDATASET UNSTRUCTURED_GRID\n"
         "POINTS 5 double\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\n"
         "CELLS 3 14\n4 0 1 2 3\n4 1 2 3 4\n3 0 2 1\nCELL_TYPES 3\n10\n10\n5\n" +
         (cell_data.empty() ? "" : "CELL_DATA 3\n" + cell_data);
}

std::string scalars(const std::string& name, const std::string& type, const std::string& values) {
  return "SCALARS " + name + " " + type + " 1\nLOOKUP_TABLE default\n" + values + "\n";
}

/// The number of each cell's group, 0 for none, in the order of the blocks.
std::vector<int> numbers(const Mesh& mesh) {
  std::vector<int> result;
  for (const CellBlock& block : mesh.blocks)
    for (const int group : block.group) result.push_back(group < 0 ? 0 : mesh.groups[at(group)].number);
  return result;
}

Mesh read(const std::string& cell_data) {
  const TemporaryDirectory directory;
  return read_mesh(directory.write("a.vtk", legacy(cell_data)));
}

TEST(VtkGroups, are_the_numbers_of_each_dimension) {
  const Mesh mesh = read(scalars("group", "int", "4 7 4"));
  EXPECT_EQ(numbers(mesh), (std::vector<int>{4, 7, 4}));
  ASSERT_EQ(mesh.groups.size(), 3u);
  EXPECT_EQ(mesh.groups[0].name, "4");
  EXPECT_EQ(mesh.groups[0].dimension, 3);
  EXPECT_EQ(mesh.groups[1].name, "7");
  EXPECT_EQ(mesh.groups[2].name, "4");
  EXPECT_EQ(mesh.groups[2].dimension, 2);
}

TEST(VtkGroups, known_names) {
  for (const char* name : {"group", "gmsh:physical", "PhysicalGroup", "medit:ref", "cell_tags", "CellEntityIds"})
    EXPECT_EQ(numbers(read(scalars(name, "int", "1 2 3"))), (std::vector<int>{1, 2, 3})) << name;
  EXPECT_TRUE(read(scalars("stress", "int", "1 2 3")).groups.empty());
  EXPECT_TRUE(read("").groups.empty());
}

TEST(VtkGroups, zero_is_none_and_negative_numbers_stay) {
  const Mesh mesh = read(scalars("cell_tags", "long", "0 -6 0"));
  EXPECT_EQ(numbers(mesh), (std::vector<int>{0, -6, 0}));
  ASSERT_EQ(mesh.groups.size(), 1u);
  EXPECT_EQ(mesh.groups[0].name, "-6");
}

TEST(VtkGroups, first_name_of_the_list_wins_among_many_arrays) {
  const std::string text = scalars("temperature", "double", "1.5 2 3") + scalars("medit:ref", "int", "5 5 5") +
                           "FIELD more 1\ngmsh:physical 1 3 int\n8 9 0\n";
  EXPECT_EQ(numbers(read(text)), (std::vector<int>{8, 9, 0}));
}

TEST(VtkGroups, arrays_of_reals_or_vectors_are_none) {
  EXPECT_TRUE(read(scalars("group", "double", "1 2 3")).groups.empty());
  EXPECT_TRUE(read("FIELD more 1\ngroup 2 3 int\n1 2 3 4 5 6\n").groups.empty());
}

TEST(VtkGroups, number_out_of_range) {
  const std::string e = input_error([] { read(scalars("group", "vtktypeint64", "1 3000000000 3")); });
  EXPECT_NE(e.find("cell 1 has the number 3000000000 in the array \"group\""), std::string::npos) << e;
}

TEST(VtkGroups, of_xml_files) {
  const TemporaryDirectory directory;
  const Mesh mesh = read_mesh(directory.write(
      "a.vtu",
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "<UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"2\">\n"
      "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 "
      "1</DataArray></Points>\n"
      "<Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 3 0 2 1</DataArray>\n"
      "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">4 7</DataArray>\n"
      "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10 5</DataArray></Cells>\n"
      "<CellData><DataArray type=\"UInt8\" Name=\"gmsh:physical\" format=\"ascii\">200 3</DataArray></CellData>\n"
      "</Piece></UnstructuredGrid></VTKFile>\n"));
  EXPECT_EQ(numbers(mesh), (std::vector<int>{200, 3}));
}

}  // namespace
}  // namespace fascia::io::vtk_groups_test
