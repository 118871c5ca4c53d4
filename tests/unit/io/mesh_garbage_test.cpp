#include "core/geometry/surface.hpp"
#include "io/mesh/mesh_reader.hpp"
#include "tests/support/cases.hpp"
#include "tests/unit/io/gmsh_samples.hpp"
#include "tests/unit/io/mesh_samples.hpp"
#include "tests/unit/io/vtk_samples.hpp"

#include <random>

/// Files that are cut off, damaged or something else altogether: an InputError each, nothing printed, no crash.
namespace fascia::io::mesh_garbage_test {
namespace {

/// Reads and makes the surface; true where both work. What VTK prints fails the test.
bool survive(const std::filesystem::path& file) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  bool read = false;
  std::string message;
  try {
    closed_surface(read_mesh(file));
    read = true;
  } catch (const InputError& e) {
    message = e.what();
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << file;
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "") << file;
  if (!read) {
    EXPECT_EQ(message.rfind(file.string(), 0), 0u) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
  return read;
}

class VtkGarbage : public testing::TestWithParam<samples::VtkSample> {
 protected:
  samples::TemporaryDirectory directory_;
};

TEST_P(VtkGarbage, truncations) {
  const std::string text = GetParam().text;
  for (std::size_t length = 1; length < text.size(); length += test::full_size() ? 3 : 13)
    survive(directory_.write(GetParam().file, text.substr(0, length)));
  EXPECT_FALSE(survive(directory_.write(GetParam().file, text.substr(0, text.size() / 2))));
}

TEST_P(VtkGarbage, mutations) {
  std::mt19937 random(11);
  const std::string text = GetParam().text;
  const int rounds = test::cases(100);
  for (int round = 0; round < rounds; ++round) {
    std::string mutated = text;
    for (int change = 0; change < 1 + round % 3; ++change)
      mutated[random() % mutated.size()] =
          round % 2 ? static_cast<char>(random() % 256) : "0123456789 -.\n"[random() % 14];
    survive(directory_.write(GetParam().file, mutated));
  }
}

TEST_P(VtkGarbage, something_else) {
  std::mt19937 random(5);
  std::string bytes(3000, ' ');
  for (char& c : bytes) c = static_cast<char>(random() % 256);
  for (const std::string& text : {bytes, std::string(2000, '\0'), std::string("hello\nworld\n"), samples::gmsh_22(),
                                  std::string(500, '\n'), std::string(100000, '9')})
    EXPECT_FALSE(survive(directory_.write(GetParam().file, text)));
}

INSTANTIATE_TEST_SUITE_P(Formats, VtkGarbage, testing::ValuesIn(samples::vtk_samples), [](const auto& sample) {
  std::string name = sample.param.file;
  name[name.find('.')] = '_';
  return name;
});

}  // namespace
}  // namespace fascia::io::mesh_garbage_test
