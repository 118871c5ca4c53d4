#pragma once

#include "core/base/errors.hpp"
#include "core/geometry/mesh.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <unistd.h>

/// Small meshes and files for the tests of this folder.
namespace fascia::samples {

/// A mesh of one block, numbered from 1.
inline Mesh mesh_of(CellType type, std::vector<Vec3d> points, std::vector<int> nodes) {
  Mesh mesh;
  mesh.file = "sample.msh";
  mesh.points = std::move(points);
  for (std::size_t i = 0; i < mesh.points.size(); ++i) mesh.point_file_number.push_back(static_cast<int>(i) + 1);
  CellBlock block{type, std::move(nodes), {}, {}};
  block.group.assign(block.size(), -1);
  for (std::size_t c = 0; c < block.size(); ++c) block.file_number.push_back(static_cast<int>(c) + 1);
  mesh.blocks.push_back(std::move(block));
  return mesh;
}

inline Mesh mesh_of(const TriangleMesh& surface) {
  std::vector<int> nodes;
  for (const auto& t : surface.triangles) nodes.insert(nodes.end(), t.begin(), t.end());
  return mesh_of(CellType::triangle, surface.points, nodes);
}

/// Corners of the unit cube in the order of a hexahedron.
inline std::vector<Vec3d> cube_points() {
  return {{{0, 0, 0}}, {{1, 0, 0}}, {{1, 1, 0}}, {{0, 1, 0}}, {{0, 0, 1}}, {{1, 0, 1}}, {{1, 1, 1}}, {{0, 1, 1}}};
}

/// The message of the InputError or StateError that `act` throws; fails the test where it throws none.
template <class Act>
std::string input_error(Act&& act) {
  try {
    act();
  } catch (const InputError& e) {
    return e.what();
  } catch (const StateError& e) {
    return e.what();
  }
  ADD_FAILURE() << "no InputError";
  return {};
}

/// A fresh directory, removed with the object.
class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    std::string name = (std::filesystem::temp_directory_path() / "fascia-test-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no temporary directory");
    path_ = name;
  }
  ~TemporaryDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  const std::filesystem::path& path() const { return path_; }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

inline std::string content(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace fascia::samples
