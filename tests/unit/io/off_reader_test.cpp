#include "core/geometry/surface.hpp"
#include "io/mesh/mesh_reader.hpp"
#include "tests/unit/io/mesh_samples.hpp"

#include <random>

namespace fascia::io::off_reader_test {
namespace {

using samples::input_error;
using samples::TemporaryDirectory;

const std::string kPoints = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n", kFaces = "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
const std::string kTetrahedron = "OFF\n4 4 6\n" + kPoints + kFaces;

TEST(OffReader, KindsAndSpacing) {
  const TemporaryDirectory directory;
  const std::string coloured = "0 0 0 255 0 0\n1 0 0 1 1 1\n0 1 0 9 9 9\n0 0 1 0 0 0\n";
  for (const std::string& text :
       {kTetrahedron, "OFF 4 4 6\n" + kPoints + kFaces, "OFF4 4 6\n" + kPoints + kFaces, "4 4\n" + kPoints + kFaces,
        "COFF\n4 4 0\n" + coloured + kFaces, "STCN" + kTetrahedron,
        "# of a program\n\n  OFF # text\r\n4\t4 0 #\n\n" + kPoints + "# faces\n" + kFaces,
        "OFF\n4 4 0\n" + kPoints + "3 0 2 1 0.5 0.5 0.5\n3 0 1 3 1\n3 1 2 3 # red\n3 0 3 2 1 1 1 1"}) {
    const Mesh mesh = read_mesh(directory.write("a.off", text));
    EXPECT_EQ(mesh.points.size(), 4u) << text;
    EXPECT_EQ(mesh.point_file_number[3], 3) << text;
    EXPECT_NEAR(closed_surface(mesh).volume, 1. / 6, 1e-15) << text;
    EXPECT_TRUE(mesh.messages.empty()) << text;
  }
  const std::string cube =
      "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n4 0 3 2 1\n4 4 5 6 7\n"
      "4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";
  EXPECT_NEAR(closed_surface(read_mesh(directory.write("b.OFF", cube + "\x1A"))).volume, 1, 1e-15);
}

TEST(OffReader, ErrorsNameTheLine) {
  const TemporaryDirectory directory;
  const auto error = [&](const std::string& text) {
    const auto file = directory.write("a.off", text);
    return input_error([&] { read_mesh(file); }).substr(file.string().size());
  };
  EXPECT_EQ(error("solid\n"), ":1: is no OFF mesh: found \"solid\"; must start with OFF");
  EXPECT_EQ(error("4" + kTetrahedron),
            ":1: files of the kind \"4OFF\" are not supported; save three coordinates a vertex, as OFF");
  EXPECT_EQ(error("OFF BINARY\n"), ":1: binary files are not supported; save as ASCII");
  EXPECT_EQ(error("OFF\n"), ":1: expected the number of vertices, found the end of the file; must be a whole number");
  EXPECT_EQ(error("OFF\n1\n"), ":2: expected the number of faces, found the end of the line; must be a whole number");
  EXPECT_EQ(error("OFF\n0 -1 0\n"), ":2: expected the number of faces, found \"-1\"; must be a whole number");
  EXPECT_NE(error("OFF\n4000000000 1 0\n").find(":2: the number of vertices is 4000000000, but the file has only"),
            std::string::npos);
  EXPECT_EQ(error("OFF\n1 1 0\n0 0\n"),
            ":3: expected a coordinate of vertex 0, found the end of the line; must be a finite number");
  EXPECT_EQ(error("OFF\n1 1 0\n0 0 nan\n"),
            ":3: expected a coordinate of vertex 0, found \"nan\"; must be a finite number");
  EXPECT_EQ(error("OFF\n1 1 0\n0 0 0\n"),
            ":3: expected the number of vertices of face 0, found the end of the file; must be a whole number");
  EXPECT_EQ(error("OFF\n1 1 0\n0 0 0\n2 0 0\n"), ":4: face 0 has 2 vertices; must have at least 3");
  EXPECT_EQ(error("OFF\n1 1 0\n0 0 0\n3 0 0\n"),
            ":4: expected a vertex of face 0, found the end of the line; must be a whole number");
  EXPECT_EQ(error("OFF\n1 1 0\n0 0 0\n3 0 0 1\n"),
            ":4: face 0 uses vertex 1, but there are 1, counted from 0; correct the face");
  EXPECT_EQ(error(kTetrahedron + "3 0 1 2\n"),
            ":11: found \"3\" behind the last face; correct the numbers of vertices and faces");
  EXPECT_NE(error("OFF\n1 0 0\n0 0 0\n").find("has no cells"), std::string::npos);
}

TEST(OffReader, EveryTruncationAndManyMutationsAreMeshesOrErrors) {
  const TemporaryDirectory directory;
  std::mt19937 random(5);
  const auto survive = [&](const std::string& text) {
    const auto file = directory.write("a.off", text);
    try {
      closed_surface(read_mesh(file));
    } catch (const InputError& e) {
      EXPECT_EQ(std::string(e.what()).rfind(file.string(), 0), 0u) << e.what();
    }
  };
  for (std::size_t length = 1; length < kTetrahedron.size(); ++length) survive(kTetrahedron.substr(0, length));
  for (int round = 0; round < 1000; ++round) {
    std::string mutated = kTetrahedron;
    for (int change = 0; change < 1 + round % 4; ++change)
      mutated[random() % mutated.size()] =
          round % 2 ? static_cast<char>(random() % 256) : "0123456789 -.e\n#"[random() % 16];
    survive(mutated);
  }
}

}  // namespace
}  // namespace fascia::io::off_reader_test
