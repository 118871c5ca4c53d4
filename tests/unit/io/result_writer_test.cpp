#include "io/result_writer.hpp"

#include "core/geometry/primitives.hpp"
#include "io/files.hpp"
#include "io/mesh/mesh_reader.hpp"
#include "io/result_reader.hpp"
#include "tests/unit/io/mesh_samples.hpp"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdint>
#include <limits>

namespace fascia::io::result_writer_test {
namespace {

using samples::content;
using samples::TemporaryDirectory;

/// A small box, two lines and two lone points on it, and two fields.
VisualMesh sample(int n = 2) {
  const TriangleMesh box = box_surface({{0, 0, 0}}, {{1, 2, 3}}, n, n, n);
  VisualMesh mesh;
  mesh.points = box.points;
  mesh.triangles = box.triangles;
  mesh.lines = {{4, 1}, {1, 2}};
  mesh.vertices = {3, 0};
  mesh.part.assign(mesh.triangles.size() + mesh.lines.size(), 0);
  mesh.part.insert(mesh.part.end(), {1, 2});
  FieldArray displacement{"displacement", 3, {}}, stress{"von_mises", 1, {}};
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    for (int c = 0; c < 3; ++c) displacement.values.push_back(0.1 * mesh.points[p][c]);
    stress.values.push_back(static_cast<double>(p) / 3);
  }
  mesh.point_fields = {displacement, stress};
  return mesh;
}

TEST(WriteVtu, reads_back) {
  const TemporaryDirectory directory;
  const VisualMesh mesh = sample();
  const auto file = directory.path() / "deep" / "er" / "a.vtu";
  write_vtu(file, mesh);

  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  vtkUnstructuredGrid* grid = reader->GetOutput();
  ASSERT_EQ(grid->GetNumberOfPoints(), static_cast<vtkIdType>(mesh.points.size()));
  ASSERT_EQ(grid->GetNumberOfCells(), static_cast<vtkIdType>(mesh.triangles.size() + 4));
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    Vec3d x;
    grid->GetPoint(static_cast<vtkIdType>(p), x.v);
    EXPECT_EQ(x, mesh.points[p]);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    vtkNew<vtkIdList> ids;
    grid->GetCellPoints(static_cast<vtkIdType>(t), ids);
    EXPECT_EQ(grid->GetCellType(static_cast<vtkIdType>(t)), VTK_TRIANGLE);
    for (vtkIdType n = 0; n < 3; ++n) EXPECT_EQ(ids->GetId(n), mesh.triangles[t][static_cast<std::size_t>(n)]);
  }
  for (std::size_t l = 0; l < mesh.lines.size(); ++l) {
    const auto cell = static_cast<vtkIdType>(mesh.triangles.size() + l);
    vtkNew<vtkIdList> ids;
    grid->GetCellPoints(cell, ids);
    EXPECT_EQ(grid->GetCellType(cell), VTK_LINE);
    for (vtkIdType n = 0; n < 2; ++n) EXPECT_EQ(ids->GetId(n), mesh.lines[l][static_cast<std::size_t>(n)]);
  }
  for (const vtkIdType back : {1, 2}) EXPECT_EQ(grid->GetCellType(grid->GetNumberOfCells() - back), VTK_VERTEX);
  for (const FieldArray& field : mesh.point_fields) {
    vtkDataArray* array = grid->GetPointData()->GetArray(field.name.c_str());
    ASSERT_NE(array, nullptr);
    ASSERT_EQ(array->GetNumberOfComponents(), field.components);
    for (std::size_t i = 0; i < field.values.size(); ++i)
      EXPECT_EQ(
          array->GetComponent(static_cast<vtkIdType>(i) / field.components, static_cast<int>(i) % field.components),
          field.values[i]);
  }
  vtkDataArray* part = grid->GetCellData()->GetArray("part");
  ASSERT_NE(part, nullptr);
  for (std::size_t c = 0; c < mesh.part.size(); ++c)
    EXPECT_EQ(part->GetComponent(static_cast<vtkIdType>(c), 0), mesh.part[c]);
}

TEST(WriteVtu, of_several_blocks_of_noise_reads_back) {
  const TemporaryDirectory directory;
  VisualMesh mesh = sample(40);  // 9,602 points: fields of 75 and 225 kB, compressed in blocks of 32
  std::uint64_t state = 1;
  for (FieldArray& field : mesh.point_fields)
    for (double& value : field.values) {
      state = state * 6364136223846793005U + 1442695040888963407U;
      value = static_cast<double>(state >> 11U) * 0x1.0p-53 - 0.5;
    }
  const auto file = directory.path() / "a.vtu";
  write_vtu(file, mesh);
  EXPECT_NE(content(file).find("compressor=\"vtkZLibDataCompressor\""), std::string::npos);
  const VisualMesh read = read_vtu(file);
  EXPECT_EQ(read.points, mesh.points);
  for (const FieldArray& field : mesh.point_fields) {
    const auto same = std::find_if(read.point_fields.begin(), read.point_fields.end(),
                                   [&](const FieldArray& f) { return f.name == field.name; });
    ASSERT_NE(same, read.point_fields.end());
    EXPECT_EQ(same->values, field.values);
  }
}

/// 9,602 points are some blocks of each field, of which threads compress several ahead.
TEST(WriteVtu, is_the_same_for_any_number_of_threads) {
  const TemporaryDirectory directory;
  const VisualMesh mesh = sample(40);
  write_vtu(directory.path() / "a.vtu", mesh);
  for (const int threads : {1, 2, 3}) {
    ThreadPool pool(threads);
    write_vtu(directory.path() / "b.vtu", mesh, &pool);
    EXPECT_TRUE(content(directory.path() / "a.vtu") == content(directory.path() / "b.vtu")) << threads;
  }
}

TEST(WriteVtu, is_deterministic) {
  const TemporaryDirectory directory;
  write_vtu(directory.path() / "a.vtu", sample());
  write_vtu(directory.path() / "b.vtu", sample());
  EXPECT_EQ(content(directory.path() / "a.vtu"), content(directory.path() / "b.vtu"));
}

TEST(WriteVtu, empty_mesh) {
  const TemporaryDirectory directory;
  EXPECT_NO_THROW(write_vtu(directory.path() / "a.vtu", VisualMesh{}));
}

TEST(WriteVtu, lines_alone) {
  const TemporaryDirectory directory;
  VisualMesh mesh;
  mesh.points = {{{0, 0, 0}}, {{1, 0, 0}}, {{1, 2, 0}}};
  mesh.lines = {{0, 1}, {1, 2}};
  write_vtu(directory.path() / "a.vtu", mesh);
  const Mesh read = read_mesh(directory.path() / "a.vtu");
  EXPECT_EQ(read.points, mesh.points);
  ASSERT_EQ(read.blocks.size(), 1u);
  EXPECT_EQ(read.blocks[0].type, CellType::line);
  EXPECT_EQ(read.blocks[0].nodes, (std::vector<int>{0, 1, 1, 2}));
}

TEST(WriteVtu, refuses_what_is_not_finite) {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "a.vtu";
  VisualMesh mesh = sample();
  mesh.point_fields[1].values[4] = std::numeric_limits<double>::infinity();
  std::string e = samples::input_error([&] { write_vtu(file, mesh); });
  EXPECT_NE(e.find("\"von_mises\" is not finite at point 4"), std::string::npos) << e;
  mesh = sample();
  mesh.points[2][1] = std::numeric_limits<double>::quiet_NaN();
  e = samples::input_error([&] { write_vtu(file, mesh); });
  EXPECT_NE(e.find("\"points\" is not finite at point 2"), std::string::npos) << e;
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(WriteVtu, refuses_arrays_that_do_not_fit) {
  const TemporaryDirectory directory;
  VisualMesh mesh = sample();
  mesh.part.pop_back();
  EXPECT_THROW(write_vtu(directory.path() / "a.vtu", mesh), std::logic_error);
  mesh = sample();
  mesh.lines[1][0] = -1;
  EXPECT_THROW(write_vtu(directory.path() / "a.vtu", mesh), std::logic_error);
  mesh = sample();
  mesh.vertices[0] = static_cast<int>(mesh.points.size());
  EXPECT_THROW(write_vtu(directory.path() / "a.vtu", mesh), std::logic_error);
}

/// No file may grow beyond so many bytes while it lives: what a full disk does, for any user.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : former_handler_(signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &former_);
    const rlimit limit{bytes, former_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &former_);
    signal(SIGXFSZ, former_handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit former_{};
  void (*former_handler_)(int);
};

template <class Act>
std::string file_error(Act&& act) {
  try {
    act();
  } catch (const FileError& e) {
    return e.what();
  }
  return "no FileError";
}

TEST(FullDisk, is_noticed_by_every_writer) {
  const TemporaryDirectory directory;
  std::string vtu, text, pvd;
  {
    const FileSizeLimit limit(4096);
    vtu = file_error([&] { write_vtu(directory.path() / "a.vtu", sample(20)); });
    text = file_error([&] { replace_file(directory.path() / "a.json", std::string(5000, 'x')); });
    pvd = file_error([&] {
      Collection collection(directory.path() / "a.pvd");
      for (int k = 0; k < 200; ++k) collection.add(0.5, "beam", "beam_0001.vtu");
    });
  }
  for (const std::string& e : {vtu, text, pvd}) {
    EXPECT_EQ(e.rfind(directory.path().string(), 0), 0u) << e;
    EXPECT_NE(e.find("free space there or write elsewhere"), std::string::npos) << e;
  }
  const std::string kept = content(directory.path() / "a.pvd");
  EXPECT_TRUE(kept.ends_with("/>\n  </Collection>\n</VTKFile>\n")) << kept;
  std::filesystem::remove(directory.path() / "a.pvd");
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

TEST(FullDisk, device_that_is_always_full) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "absent: /dev/full";
  const std::string e = file_error([&] { write_file("/dev/full", "a few bytes"); });
  EXPECT_EQ(e.rfind("/dev/full: cannot be written: ", 0), 0u) << e;
}

TEST(ReplaceFile, paths_that_cannot_be_written) {
  const TemporaryDirectory directory;
  directory.write("file", "x");
  EXPECT_THROW(replace_file(directory.path() / "file" / "a.txt", "x"), FileError);
  EXPECT_THROW(replace_file(directory.path(), "x"), FileError);
}

TEST(Collection, lists_times_and_parts_and_is_complete_after_each) {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "a.pvd";
  Collection collection(file);
  const std::vector<std::array<std::string, 3>> entries{
      {"0", "beam", "beam_0.vtu"}, {"0", "a<b&\"c\"", "x.vtu"}, {"0.1", "beam", "beam_1.vtu"}};
  for (const auto& [time, body, state] : entries) {
    collection.add(std::stod(time), body, state);
    EXPECT_TRUE(content(file).ends_with("/>\n  </Collection>\n</VTKFile>\n"));
  }
  EXPECT_THROW(collection.add(NAN, "beam", "beam_2.vtu"), InputError);
  const std::string text = content(file);
  EXPECT_NE(text.find("timestep=\"0\" group=\"\" part=\"0\" name=\"beam\" file=\"beam_0.vtu\""), std::string::npos)
      << text;
  EXPECT_NE(text.find("part=\"1\" name=\"a&lt;b&amp;&quot;c&quot;\""), std::string::npos) << text;
  EXPECT_NE(text.find("timestep=\"0.1\" group=\"\" part=\"0\""), std::string::npos) << text;
}

}  // namespace
}  // namespace fascia::io::result_writer_test
