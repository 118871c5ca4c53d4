#include "core/geometry/surface.hpp"
#include "io/mesh/mesh_reader.hpp"
#include "tests/unit/io/mesh_samples.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

namespace fascia::io::ply_reader_test {
namespace {

using samples::input_error;
using samples::TemporaryDirectory;

const std::string kVertices = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n",
                  kFaces = "element face 4\nproperty list uchar int vertex_indices\n",
                  kPoints = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n", kCorners = "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
const std::string kTetrahedron = "ply\nformat ascii 1.0\n" + kVertices + kFaces + "end_header\n" + kPoints + kCorners;

TEST(PlyReader, PropertiesAndElementsOfOthersAreLeftOut) {
  const TemporaryDirectory directory;
  const std::string coloured =
      "ply\nformat ascii 1.0\ncomment made by hand\nobj_info of nothing\nelement vertex 4\nproperty uchar red\n"
      "property list uchar float ring\nproperty double z\nproperty double x\nproperty double y\n"
      "element face 4\nproperty list uchar uint vertex_index\nproperty float quality\n"
      "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n"
      "9 0 0 0 0\n9 1 5 0 1 0\n9 2 5 6 0 0 1\n\n9 0 1 0 0\n3 0 2 1 .5\n3 0 1 3 .5\n3 1 2 3 .5\n3 0 3 2 .5\n0 1\n";
  for (const std::string& text : {kTetrahedron, coloured, "\xEF\xBB\xBF" + kTetrahedron}) {
    const Mesh mesh = read_mesh(directory.write("a.ply", text));
    EXPECT_EQ(mesh.points.size(), 4u) << text;
    EXPECT_EQ(mesh.point_file_number[3], 3) << text;
    EXPECT_NEAR(closed_surface(mesh).volume, 1. / 6, 1e-15) << text;
  }
}

/// A reader that takes what is no number for zero makes another body of the mesh, without a word.
TEST(PlyReader, ErrorsNameTheLine) {
  const TemporaryDirectory directory;
  const auto error = [&](const std::string& what, const std::string& by) {
    std::string text = kTetrahedron;
    text.replace(text.find(what), what.size(), by);
    const auto file = directory.write("a.ply", text);
    return input_error([&] { read_mesh(file); }).substr(file.string().size());
  };
  EXPECT_EQ(error("0 1 0\n", "0 1q 0\n"), ":12: expected y of vertex 2, found \"1q\"; must be a finite number");
  EXPECT_EQ(error("0 1 0\n", "0 1\n"),
            ":12: expected z of vertex 2, found the end of the line; must be a finite number");
  EXPECT_EQ(error("0 1 0\n", "0 1 0 7\n"), ":12: found \"7\" behind the last property of vertex 2; correct the line");
  EXPECT_EQ(error("3 1 2 3\n", "3 1 2\n"), ":16: vertex_indices of face 2 has 2 values, and says 3; correct the line");
  EXPECT_EQ(error("3 1 2 3\n", "3 1 2 4\n"),
            ":16: face 2 uses vertex 4, but there are 4, counted from 0; correct the face");
  EXPECT_EQ(error("3 1 2 3\n", "3 1 1.5 3\n"),
            ":16: face 2 uses vertex 1.5, but there are 4, counted from 0; correct the face");
  EXPECT_EQ(error("3 1 2 3\n", "2 1 2\n"), ":16: face 2 has 2 vertices; must have at least 3");
  EXPECT_EQ(error("3 1 2 3\n", "x 1 2 3\n"),
            ":16: expected the length of vertex_indices of face 2, found \"x\"; must be a whole number");
  EXPECT_EQ(error("3 0 3 2\n", "3 0 3 2\n1\n"),
            ":18: found \"1\" behind the last element; correct the numbers of the header");
  EXPECT_EQ(error("3 0 3 2\n", ""),
            ":16: expected the length of vertex_indices of face 3, found the end of the file; must be a whole number");
  EXPECT_EQ(error("element vertex 4", "element vertex many"),
            ":3: expected the number of vertices, found \"many\"; must be a whole number");
  EXPECT_NE(error("element face 4", "element face 4000000000").find(":7: the number of faces is 4000000000, but"),
            std::string::npos);
  EXPECT_EQ(error("property float z\n", ""), ":8: the header gives a vertex no property z; write the file again");
  EXPECT_EQ(error("property float z", "property real z"),
            ":6: expected a type of numbers, found \"real\"; must be float, double, int, uchar or the like");
  EXPECT_EQ(error("ascii", "text"),
            ":2: expected a format, found \"text\"; must be ascii, binary_little_endian or binary_big_endian");
  EXPECT_EQ(error("end_header\n", "end\n"), ":9: \"end\" is no line of a PLY header; write the file again");
  EXPECT_EQ(error(kVertices, "property float x\n"),
            ":3: a property comes before the first element; write the file again");
}

template <class T>
void put(std::string& bytes, T value, bool little) {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), &value, sizeof(T));
  if (!little) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

/// The tetrahedron with a colour at vertices, its places of 64 bits.
std::string binary_tetrahedron(bool little) {
  std::string bytes = std::string("ply\nformat ") + (little ? "binary_little_endian" : "binary_big_endian") +
                      " 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
                      "property uchar red\nelement face 4\nproperty list uchar uint vertex_index\nend_header\n";
  for (int v = 0; v < 4; ++v) {
    for (int c = 0; c < 3; ++c) put(bytes, v == c + 1 ? 1.0 : 0.0, little);
    put(bytes, static_cast<std::uint8_t>(10 + v), little);
  }
  for (const std::array<std::uint32_t, 3>& face :
       {std::array{0U, 2U, 1U}, std::array{0U, 1U, 3U}, std::array{1U, 2U, 3U}, std::array{0U, 3U, 2U}}) {
    put(bytes, std::uint8_t{3}, little);
    for (const std::uint32_t corner : face) put(bytes, corner, little);
  }
  return bytes;
}

TEST(PlyReader, BinaryOfBothKindsOfBytes) {
  const TemporaryDirectory directory;
  for (const bool little : {true, false}) {
    const std::string text = binary_tetrahedron(little);
    const Mesh mesh = read_mesh(directory.write("a.ply", text));
    EXPECT_NEAR(closed_surface(mesh).volume, 1. / 6, 1e-15);
    EXPECT_TRUE(mesh.messages.empty());
    const auto more = directory.write("b.ply", text + std::string(2, '\0'));
    EXPECT_EQ(read_mesh(more).messages,
              std::vector<std::string>{more.string() + ": left out 2 bytes behind the last element"});
  }
}

TEST(PlyReader, LengthsOfListsAreWhole) {
  const TemporaryDirectory directory;
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list float uchar vertex_index\nend_header\n";
  put(text, 2.5F, true);
  const auto file = directory.write("a.ply", text + std::string(8, '\0'));
  EXPECT_EQ(input_error([&] { read_mesh(file); }),
            file.string() +
                ": vertex_index of face 0 has a length that the file does not hold; it is damaged: write it again");
}

/// A last number that is cut off is not another vertex.
TEST(PlyReader, EveryTruncationOfABinaryFileIsAnError) {
  const TemporaryDirectory directory;
  const std::string text = binary_tetrahedron(true);
  for (std::size_t length = 0; length < text.size(); ++length) {
    const auto file = directory.write("a.ply", text.substr(0, length));
    const std::string error = input_error([&] { read_mesh(file); });
    EXPECT_EQ(error.rfind(file.string(), 0), 0u) << length;
    if (length + 1 == text.size()) {
      EXPECT_EQ(error, file.string() + ": ends within face 3; it is cut off: write it again");
    }
  }
}

TEST(PlyReader, EveryTruncationAndManyMutationsAreMeshesOrErrors) {
  const TemporaryDirectory directory;
  std::mt19937 random(5);
  const auto survive = [&](const std::string& text) {
    const auto file = directory.write("a.ply", text);
    try {
      closed_surface(read_mesh(file));
    } catch (const InputError& e) {
      EXPECT_EQ(std::string(e.what()).rfind(file.string(), 0), 0u) << e.what();
    }
  };
  for (std::size_t length = 1; length < kTetrahedron.size(); ++length) survive(kTetrahedron.substr(0, length));
  for (int round = 0; round < 300; ++round) {
    std::string mutated = round % 3 == 0 ? binary_tetrahedron(true) : kTetrahedron;
    for (int change = 0; change < 1 + round % 4; ++change)
      mutated[random() % mutated.size()] =
          round % 2 ? static_cast<char>(random() % 256) : "0123456789 -.e\n"[random() % 15];
    survive(mutated);
  }
}

}  // namespace
}  // namespace fascia::io::ply_reader_test
