#include "io/result_reader.hpp"

#include "core/base/errors.hpp"
#include "io/result_writer.hpp"
#include "tests/unit/io/mesh_samples.hpp"
#include "tests/unit/io/volume_samples.hpp"

#include <cmath>

namespace fascia::io::result_reader_test {
namespace {

using samples::TemporaryDirectory;

TEST(ReadResultArrays, GivesBackWhatWasWritten) {
  const TemporaryDirectory directory;
  VisualMesh mesh;
  mesh.points = {{{0, 0, 0}}, {{1, 0, 0}}, {{1, 2.5, 0}}};
  mesh.triangles = {{0, 1, 2}};
  mesh.point_fields = {{"stress", 1, {1e-300, -2, 1.0 / 3}, "Pa"}};
  mesh.provenance = "{\"scene\":\"title = \\\"x\\\"\\n\"}";
  write_vtu(directory.path() / "a.vtu", mesh);
  const ResultArrays arrays = read_result_arrays(directory.path() / "a.vtu");
  EXPECT_EQ(arrays.at("stress"), mesh.point_fields[0].values);
  EXPECT_EQ(arrays.at("points"), (std::vector<double>{0, 0, 0, 1, 0, 0, 1, 2.5, 0}));
  directory.write("b.vtu", "no mesh");
  EXPECT_THROW(read_result_arrays(directory.path() / "b.vtu"), InputError);
}

TEST(ReadVtu, GivesBackWhatWasWritten) {
  const TemporaryDirectory directory;
  for (const CellType type : {CellType::tetrahedron, CellType::hexahedron})
    for (const bool quadratic : {false, true}) {
      VisualMesh mesh = samples::row_of_cubes(2, type, quadratic);
      mesh.triangles = {{0, 1, 2}};
      mesh.lines = {{0, 1}};
      mesh.vertices = {3};
      mesh.part.insert(mesh.part.end(), {0, 0, 2});
      write_vtu(directory.path() / "a.vtu", mesh);
      const VisualMesh read = read_vtu(directory.path() / "a.vtu");
      EXPECT_EQ(read.points, mesh.points);
      ASSERT_EQ(read.volumes.size(), 1u);
      EXPECT_EQ(read.volumes[0].type, type);
      EXPECT_EQ(read.volumes[0].quadratic, quadratic);
      EXPECT_EQ(read.volumes[0].nodes, mesh.volumes[0].nodes);
      EXPECT_EQ(read.triangles, mesh.triangles);
      EXPECT_EQ(read.lines, mesh.lines);
      EXPECT_EQ(read.vertices, mesh.vertices);
      EXPECT_EQ(read.part, mesh.part);
      ASSERT_EQ(read.point_fields.size(), 1u);
      EXPECT_EQ(read.point_fields[0].values, mesh.point_fields[0].values);
    }
}

TEST(ReadVtu, RefusesWhatIsDamaged) {
  const TemporaryDirectory directory;
  const auto file = [&](const std::string& nodes, const std::string& type, const std::string& value) {
    return directory.write(
        "a.vtu", R"(<VTKFile type="UnstructuredGrid" version="1.0"><UnstructuredGrid><Piece NumberOfPoints="2" )"
                 R"(NumberOfCells="1"><PointData><DataArray type="Float64" Name="s" format="ascii">)" +
                     value +
                     R"( 1</DataArray></PointData><Points><DataArray type="Float64" NumberOfComponents="3" )"
                     R"(format="ascii">0 0 0 1 0 0</DataArray></Points><Cells><DataArray type="Int64" )"
                     R"(Name="connectivity" format="ascii">)" +
                     nodes + R"(</DataArray><DataArray type="Int64" Name="offsets" format="ascii">2</DataArray>)" +
                     R"(<DataArray type="UInt8" Name="types" format="ascii">)" + type +
                     R"(</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>)");
  };
  EXPECT_EQ(read_vtu(file("0 1", "3", "1")).lines.size(), 1u);
  EXPECT_NE(samples::input_error([&] { read_vtu(file("0 7", "3", "1")); }).find("not there"), std::string::npos);
  EXPECT_NE(samples::input_error([&] { read_vtu(file("0 1", "4", "1")); }).find("of another kind"), std::string::npos);
  EXPECT_NE(samples::input_error([&] { read_vtu(file("0 1", "3", "nan")); }), "");
  EXPECT_THROW(read_vtu(directory.write("b.vtu", "no mesh")), InputError);
}

TEST(ReadCollection, GivesTimesAndFiles) {
  const TemporaryDirectory directory;
  Collection collection(directory.path() / "a.pvd");
  collection.add(0, "liver & co", "liver_00000.vtu");
  collection.add(0.04, "liver & co", "liver_00001.vtu");
  const std::vector<CollectionEntry> entries = read_collection(directory.path() / "a.pvd");
  ASSERT_EQ(entries.size(), 2u);
  EXPECT_EQ(entries[1].time, 0.04);
  EXPECT_EQ(entries[1].body, "liver & co");
  EXPECT_EQ(entries[1].file, "liver_00001.vtu");
  directory.write("b.pvd", "<VTKFile/>");
  EXPECT_THROW(read_collection(directory.path() / "b.pvd"), InputError);
}

TEST(ReadNumberTable, KnowsEmptyCellsAndRefusesWords) {
  const TemporaryDirectory directory;
  const NumberTable table = read_number_table(directory.write("a.csv", "time,tip.x\n0,1.5\n0.1,\n"));
  EXPECT_EQ(table.columns, (std::vector<std::string>{"time", "tip.x"}));
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0][1], 1.5);
  EXPECT_TRUE(std::isnan(table.rows[1][1]));
  EXPECT_THROW(read_number_table(directory.write("b.csv", "time\nnoon\n")), InputError);
  EXPECT_THROW(read_number_table(directory.write("c.csv", "time,x\n1\n")), InputError);
}

}  // namespace
}  // namespace fascia::io::result_reader_test
