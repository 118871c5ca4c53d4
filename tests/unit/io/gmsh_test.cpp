#include "io/gmsh/gmsh.hpp"

#include "core/geometry/surface.hpp"
#include "io/mesh/mesh_reader.hpp"
#include "tests/unit/io/gmsh_samples.hpp"
#include "tests/unit/io/mesh_samples.hpp"

namespace fascia::io::gmsh_test {
namespace {

const CellBlock& block_of(const Mesh& mesh, CellType type) {
  for (const CellBlock& block : mesh.blocks)
    if (block.type == type) return block;
  throw std::runtime_error("no such block");
}

class GmshKinds : public testing::TestWithParam<std::string (*)()> {};

TEST_P(GmshKinds, hold_the_same_mesh) {
  const Mesh mesh = parse_gmsh(GetParam()(), "a.msh");
  EXPECT_EQ(mesh.file, "a.msh");
  const std::vector<Vec3d> points{{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}};
  EXPECT_EQ(mesh.points, points);
  EXPECT_EQ(mesh.point_file_number, (std::vector<std::int64_t>{10, 20, 30, 40}));

  ASSERT_EQ(mesh.groups.size(), 2u);
  EXPECT_EQ(mesh.groups[0].name, GetParam() == &samples::gmsh_1 ? "3" : "skin of it");
  EXPECT_EQ(mesh.groups[0].number, 3);
  EXPECT_EQ(mesh.groups[0].dimension, 2);
  EXPECT_EQ(mesh.groups[1].name, "7");
  EXPECT_EQ(mesh.groups[1].dimension, 3);

  const CellBlock& triangles = block_of(mesh, CellType::triangle);
  EXPECT_EQ(triangles.nodes, (std::vector<int>{0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2}));
  EXPECT_EQ(triangles.group, (std::vector<int>{0, 0, 0, 0}));
  EXPECT_EQ(triangles.file_number, (std::vector<std::int64_t>{1, 2, 3, 4}));
  const CellBlock& tetrahedra = block_of(mesh, CellType::tetrahedron);
  EXPECT_EQ(tetrahedra.nodes, (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(tetrahedra.group, std::vector<int>{1});
  EXPECT_EQ(tetrahedra.file_number, std::vector<std::int64_t>{5});
  EXPECT_EQ(block_of(mesh, CellType::vertex).group, std::vector<int>{-1});

  EXPECT_NEAR(closed_surface(mesh).volume, 1. / 6, 1e-15);
}

INSTANTIATE_TEST_SUITE_P(All, GmshKinds,
                         testing::Values(&samples::gmsh_1, &samples::gmsh_22, &samples::gmsh_41,
                                         &samples::gmsh_22_binary, &samples::gmsh_41_binary));

TEST(Gmsh, older_versions_of_2_are_read_alike) {
  for (const char* version : {"2 0 8", "2.0 0 8", "2.1 0 8"}) {
    std::string text = samples::gmsh_22();
    text.replace(text.find("2.2 0 8"), 7, version);
    EXPECT_EQ(parse_gmsh(text, "a.msh").groups[0].name, "skin of it") << version;
  }
}

TEST(Gmsh, stray_bytes_around_the_text_are_left_out) {
  const Mesh mesh = parse_gmsh("\xEF\xBB\xBF" + samples::gmsh_1() + "\x1A", "a.msh");
  EXPECT_EQ(mesh.points.size(), 4u);
  EXPECT_EQ(mesh.messages, std::vector<std::string>{"a.msh: left out 1 byte behind the last line that belongs to no "
                                                    "text"});
  EXPECT_TRUE(parse_gmsh(samples::gmsh_1() + "\n \n", "a.msh").messages.empty());
}

TEST(Gmsh, windows_line_ends) {
  std::string text;
  for (const char c : samples::gmsh_22()) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  const Mesh mesh = parse_gmsh(text, "a.msh");
  EXPECT_EQ(mesh.points.size(), 4u);
  EXPECT_EQ(mesh.groups[0].name, "skin of it");
}

TEST(Gmsh, quadratic_cells_keep_their_corners) {
  const Mesh mesh = parse_gmsh(
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n11\n"
      "1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 .5 0 0\n6 .5 .5 0\n7 0 .5 0\n8 0 0 .5\n9 0 .5 .5\n10 .5 0 .5\n11 9 9 9\n"
      "$EndNodes\n$Elements\n2\n1 11 0 1 2 3 4 5 6 7 8 9 10\n2 9 0 1 3 2 7 6 5\n$EndElements\n",
      "a.msh");
  EXPECT_EQ(mesh.point_file_number, (std::vector<std::int64_t>{1, 2, 3, 4, 11}));
  EXPECT_EQ(block_of(mesh, CellType::tetrahedron).nodes, (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(block_of(mesh, CellType::triangle).nodes, (std::vector<int>{0, 2, 1}));
  EXPECT_NEAR(closed_surface(mesh).volume, 1. / 6, 1e-15);
}

TEST(Gmsh, entity_in_two_groups_repeats_its_cells) {
  std::string text = samples::gmsh_41();
  const std::string one = "1 0 0 0 1 1 1 1 7 1 1\n";
  text.replace(text.find(one), one.size(), "1 0 0 0 1 1 1 2 7 -8 1 1\n");
  const Mesh mesh = parse_gmsh(text, "a.msh");
  const CellBlock& tetrahedra = block_of(mesh, CellType::tetrahedron);
  ASSERT_EQ(tetrahedra.size(), 2u);
  EXPECT_EQ(mesh.groups[static_cast<std::size_t>(tetrahedra.group[0])].number, 7);
  EXPECT_EQ(mesh.groups[static_cast<std::size_t>(tetrahedra.group[1])].number, 8);
  EXPECT_NEAR(closed_surface(mesh).volume, 1. / 6, 1e-15);
}

TEST(Gmsh, file_without_entities) {
  std::string text = samples::gmsh_41();
  const std::size_t begin = text.find("$Entities"), end = text.find("$Nodes");
  text.erase(begin, end - begin);
  EXPECT_EQ(block_of(parse_gmsh(text, "a.msh"), CellType::tetrahedron).group, std::vector<int>{-1});
}

TEST(ReadMesh, chooses_by_the_ending) {
  const samples::TemporaryDirectory directory;
  EXPECT_EQ(read_mesh(directory.write("a.MSH", samples::gmsh_22_binary())).points.size(), 4u);
  const std::string e = samples::input_error([&] { read_mesh(directory.write("a.stp", "x")); });
  EXPECT_NE(e.find("must be .msh, .vtk"), std::string::npos) << e;
}

TEST(ReadMesh, files_that_cannot_be_opened) {
  const samples::TemporaryDirectory directory;
  for (const char* name : {"absent.msh", "absent.vtu", "absent.stl"})
    EXPECT_THROW(read_mesh(directory.path() / name), FileError) << name;
  std::filesystem::create_directory(directory.path() / "folder.msh");
  EXPECT_THROW(read_mesh(directory.path() / "folder.msh"), FileError);
}

TEST(ReadMesh, empty_and_huge_files) {
  const samples::TemporaryDirectory directory;
  for (const char* name : {"a.msh", "a.vtk", "a.vtu", "a.vtp", "a.stl", "a.obj", "a.ply"})
    EXPECT_THROW(read_mesh(directory.write(name, "")), InputError) << name;
  const auto huge = directory.write("huge.msh", "$");
  std::filesystem::resize_file(huge, (std::uintmax_t{2} << 30) + 1);  // sparse
  const std::string e = samples::input_error([&] { read_mesh(huge); });
  EXPECT_NE(e.find("2 GiB"), std::string::npos) << e;
}

}  // namespace
}  // namespace fascia::io::gmsh_test
