#include "core/geometry/surface.hpp"
#include "io/mesh/mesh_reader.hpp"
#include "tests/unit/io/mesh_samples.hpp"

#include <cstring>
#include <limits>

namespace fascia::io::stl_reader_test {
namespace {

using samples::input_error;
using samples::TemporaryDirectory;
using Triangles = std::vector<std::array<float, 9>>;

std::string facet(const std::string& a, const std::string& b, const std::string& c) {
  return "facet normal 0 0 0\nouter loop\nvertex " + a + "\nvertex " + b + "\nvertex " + c + "\nendloop\nendfacet\n";
}

/// Faces of the unit tetrahedron, outward.
const Triangles tetrahedron{
    {0, 0, 0, 0, 1, 0, 1, 0, 0}, {0, 0, 0, 1, 0, 0, 0, 0, 1}, {0, 0, 0, 0, 0, 1, 0, 1, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};

std::string binary(const Triangles& triangles, std::string header = "solid of a program that says so in binary files") {
  header.resize(80, ' ');
  const auto count = static_cast<std::uint32_t>(triangles.size());
  std::string bytes = header + std::string(reinterpret_cast<const char*>(&count), 4);
  for (const auto& t : triangles)
    bytes += std::string(12, '\0') + std::string(reinterpret_cast<const char*>(t.data()), sizeof t) + "  ";
  return bytes;
}

TEST(StlReader, TextKeepsDoublePrecisionWhateverItsCaseAndSpacing) {
  const TemporaryDirectory directory;
  const Mesh mesh = read_mesh(directory.write(
      "a.stl",
      "SOLID two words\r\n  FACET NORMAL 0 0 1 OUTER LOOP\n\tVertex 0.1 0 0\nVERTEX 1 0 0 vertex 0 1 0\n"
      "ENDLOOP ENDFACET\nENDSOLID two words\nsolid\n" +
          facet("0 0 0", "0 0 1", "0 1e-3 0") + "endsolid\n"));
  ASSERT_EQ(mesh.points.size(), 6u);
  EXPECT_EQ(mesh.points[0][0], 0.1);
  EXPECT_EQ(mesh.points[5][1], 1e-3);
}

TEST(StlReader, EndsInTwoWordsAndStrayBytesAreRead) {
  const TemporaryDirectory directory;
  std::string text = "solid a\n" + facet("0 0 0", "0 0 1", "0 1e-3 0");
  for (const std::string word : {"loop", "facet"}) text.replace(text.find("end" + word), 3, "END ");
  for (const std::string stray : {std::string("exported by hand\n"), std::string("\0\n", 2)}) {
    const auto file = directory.write("a.stl", stray + text + "endsolid\n");
    EXPECT_NE(input_error([&] { read_mesh(file); }).find("a.stl:1: found "), std::string::npos)
        << input_error([&] { read_mesh(file); });
  }
  for (const char* end : {"end solid", "end solid a\n", "End  Solid\n\x1A"}) {
    const Mesh mesh = read_mesh(directory.write("a.stl", text + end));
    EXPECT_EQ(mesh.points.size(), 3u) << end;
    EXPECT_EQ(mesh.messages.size(), std::string(end).find('\x1A') == std::string::npos ? 0u : 1u) << end;
  }
  const Mesh mesh = read_mesh(directory.write("a.stl", text + "endsolid" + std::string(2, '\0')));
  ASSERT_EQ(mesh.messages.size(), 1u);
  EXPECT_NE(mesh.messages[0].find("a.stl: left out 2 bytes behind the last line"), std::string::npos);
}

TEST(StlReader, BinaryFilesMayBeginWithSolid) {
  const TemporaryDirectory directory;
  for (const char* header : {"solid", "", "made by hand"})
    EXPECT_NEAR(closed_surface(read_mesh(directory.write("a.stl", binary(tetrahedron, header)))).volume, 1. / 6, 1e-15);
  const std::string more = binary(tetrahedron, "solid with more behind") + "attributes";
  EXPECT_NEAR(closed_surface(read_mesh(directory.write("a.stl", more))).volume, 1. / 6, 1e-15);
}

TEST(StlReader, ErrorsNameTheLineOrTheTriangle) {
  const TemporaryDirectory directory;
  const auto error = [&](const std::string& text) {
    const auto file = directory.write("a.stl", text);
    return input_error([&] { read_mesh(file); }).substr(file.string().size());
  };
  EXPECT_EQ(error("solid a\nfacet normal 0 0 0\nouter loop\nvertex 0 0 nan\n"),
            ":4: expected a coordinate, found \"nan\"; must be a finite number");
  EXPECT_EQ(error("solid a\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n"),
            ":6: found \"endloop\"; must be vertex");
  EXPECT_EQ(error("solid a\nfacet normal 0 0 0 outer"), ":2: found the end of the file; must be loop");
  EXPECT_EQ(error("solid a\nfacets\n"), ":2: found \"facets\"; must be facet or endsolid");
  EXPECT_EQ(error("solid a\nend of it\n"), ":2: found \"end\" and then \"of\"; must be endsolid, endfacet or endloop");
  EXPECT_NE(error("solid a\nendsolid a\n").find("has no cells"), std::string::npos);
  const std::string whole = binary(tetrahedron, "cut");
  EXPECT_EQ(
      error(whole.substr(0, 150)),
      ": is no readable .stl mesh (it should hold 4 triangles and holds 1); it may be cut off or of another format: "
      "write it again");
  std::string more = whole + std::string(50, ' ');
  EXPECT_NE(error(more).find("should hold 4 triangles and holds 5"), std::string::npos) << "the count may be wrong";
  EXPECT_EQ(error("solid a\n" + facet("0 0 0", "1 0 0", "0 1 0")),
            ":9: the file ends without endsolid: it may be cut off; write it again");
  Triangles wrong = tetrahedron;
  wrong[2][4] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(error(binary(wrong)), ": a coordinate of triangle 3 is not finite; write the file again");
}

}  // namespace
}  // namespace fascia::io::stl_reader_test
