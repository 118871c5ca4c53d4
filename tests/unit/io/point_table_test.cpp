#include "io/mesh/point_table.hpp"

#include "core/base/errors.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

namespace fascia::io::point_table_test {
namespace {

std::string error_of(const std::string& text) {
  try {
    parse_point_table(text, "f.csv");
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(PointTable, ReadsNamedColumnsInAnyOrder) {
  const PointTable table = parse_point_table("volume,z,x,y\n0.5,3,1,2\n1e-3,-3,+1.5,2e2\n", "f.csv");
  ASSERT_EQ(table.position.size(), 2u);
  EXPECT_EQ(table.position[0], (Vec3d{{1, 2, 3}}));
  EXPECT_EQ(table.position[1], (Vec3d{{1.5, 200, -3}}));
  EXPECT_EQ(table.volume, (std::vector{0.5, 1e-3}));
  EXPECT_TRUE(table.rotation.empty());
}

TEST(PointTable, ReadsRotations) {
  const PointTable table = parse_point_table("rz,ry,rx,x,y,z\n6,5,4,1,2,3\n", "f.csv");
  ASSERT_EQ(table.rotation.size(), 1u);
  EXPECT_EQ(table.rotation[0], (Vec3d{{4, 5, 6}}));
  EXPECT_TRUE(table.volume.empty());
}

TEST(PointTable, ReadsFilesWithoutHeader) {
  const PointTable three = parse_point_table("1,2,3\n4,5,6", "f.csv");
  ASSERT_EQ(three.position.size(), 2u);
  EXPECT_EQ(three.position[1], (Vec3d{{4, 5, 6}}));
  EXPECT_TRUE(three.rotation.empty());
  const PointTable six = parse_point_table("1,2,3,4,5,6\n", "f.csv");
  EXPECT_EQ(six.position.at(0), (Vec3d{{1, 2, 3}}));
  EXPECT_EQ(six.rotation.at(0), (Vec3d{{4, 5, 6}}));
}

TEST(PointTable, CommentsBlanksAndLineEndsDoNotCount) {
  const PointTable table = parse_point_table(
      "\xEF\xBB\xBF# frames\r\n\r\n \"x\" ,\"y\",\tz \r\n  # none\n 1 , 2,3 # first\r\n   \n4,5,6", "f.csv");
  ASSERT_EQ(table.position.size(), 2u);
  EXPECT_EQ(table.position[0], (Vec3d{{1, 2, 3}}));
  EXPECT_EQ(table.position[1], (Vec3d{{4, 5, 6}}));
}

TEST(PointTable, ErrorsOfTheHeader) {
  EXPECT_EQ(error_of("x,y\n1,2\n"), "f.csv:1:1: column z is missing; must have x, y and z");
  EXPECT_EQ(error_of("# a\nx,y,z,rx\n"), "f.csv:2:1: column ry is missing; rotation vectors need rx, ry and rz");
  EXPECT_EQ(error_of("x, y, Z\n"),
            "f.csv:1:7: \"Z\" is no known column; must be x, y, z, rx, ry, rz or volume, separated by commas");
  EXPECT_EQ(error_of("x;y;z\n"),
            "f.csv:1:1: \"x;y;z\" is no known column; must be x, y, z, rx, ry, rz or volume, separated by commas");
  EXPECT_EQ(error_of("x,y,z,x\n"), "f.csv:1:7: column x appears twice; remove one");
  EXPECT_EQ(
      error_of("1,2,3,4\n"),
      "f.csv:1:1: has 4 columns and no header; must have 3 (x, y, z) or 6 (with rx, ry, rz), or a first line that "
      "names them");
}

TEST(PointTable, ErrorsOfCells) {
  EXPECT_EQ(error_of("x,y,z\n1,2,3\n1, two,3\n"), "f.csv:3:4: y is \"two\"; must be a finite number");
  EXPECT_EQ(error_of("x,y,z\n1,,3\n"), "f.csv:2:3: y is \"\"; must be a finite number");
  EXPECT_EQ(error_of("nan,2,3\n"), "f.csv:1:1: x is \"nan\"; must be a finite number");
  EXPECT_EQ(error_of("1,2,-inf\n"), "f.csv:1:5: z is \"-inf\"; must be a finite number");
  EXPECT_EQ(error_of("1,2,1e999\n"), "f.csv:1:5: z is \"1e999\"; must be a finite number");
  EXPECT_EQ(error_of("1,2,3 mm\n"), "f.csv:1:5: z is \"3 mm\"; must be a finite number");
  EXPECT_EQ(error_of("1,2,3\n1,2\n"), "f.csv:2:3: the line ends after 2 cells; must have 3, separated by commas");
  EXPECT_EQ(error_of("1,2,3\n1,2,3,\n"), "f.csv:2:7: the line ends after 4 cells; must have 3, separated by commas");
  EXPECT_EQ(error_of("x,y,z,volume\n1,2,3,0\n"), "f.csv:2:7: volume is 0; must be above 0");
  EXPECT_EQ(error_of("x,y,z,volume\n1,2,3,1\n1,2,3,-1e-9\n"), "f.csv:3:7: volume is -1e-9; must be above 0");
}

TEST(PointTable, FilesWithoutPoints) {
  EXPECT_EQ(error_of(""), "f.csv: holds no points; must have a line for each");
  EXPECT_EQ(error_of("\n# x\n"), "f.csv: holds no points; must have a line for each");
  EXPECT_EQ(error_of("x,y,z\n"), "f.csv: holds no points below its header; must have a line for each");
}

TEST(PointTable, ReadsFromDisk) {
  const std::filesystem::path path = std::filesystem::path(::testing::TempDir()) / "point_table_test.csv";
  std::ofstream(path) << "x,y,z\n1,2,3\n";
  EXPECT_EQ(read_point_table(path).position.at(0), (Vec3d{{1, 2, 3}}));
  std::ofstream(path, std::ios::trunc).close();
  EXPECT_THROW(read_point_table(path), InputError);
  std::filesystem::remove(path);
  EXPECT_THROW(read_point_table(path), FileError);
  EXPECT_THROW(read_point_table(::testing::TempDir()), FileError);
}

TEST(PointTable, GarbageIsRefusedInOneLine) {
  std::mt19937 random(1);
  const std::string letters("0123456789.,,,,\n\n-+e#\"xyzr \t\r\0\xff", 31);
  for (int trial = 0; trial < 20000; ++trial) {
    std::string text = trial % 2 == 0 ? "x,y,z\n" : "";
    for (std::size_t length = random() % 60; length > 0; --length) text += letters[random() % letters.size()];
    const std::string error = error_of(text);
    EXPECT_EQ(error.find('\n'), std::string::npos);
    if (error.empty()) {
      EXPECT_FALSE(parse_point_table(text, "f.csv").position.empty());
    }
  }
}

}  // namespace
}  // namespace fascia::io::point_table_test
