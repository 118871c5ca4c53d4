// Organs: bodies immersed in a grid of frames.
#include "tests/support/paths.hpp"
#include "tests/support/solved_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

namespace fascia::test::bodies_test {
namespace {

/// Volume that the triangles of an OBJ file enclose, by the divergence theorem.
double obj_volume(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<std::array<double, 3>> points;
  double volume = 0;
  for (std::string word; file >> word;) {
    if (word == "v") {
      std::array<double, 3> p{};
      file >> p[0] >> p[1] >> p[2];
      points.push_back(p);
    } else if (word == "f") {
      std::string line;
      std::getline(file, line);
      std::vector<std::size_t> corners;
      for (std::size_t at = 0; (at = line.find_first_of("0123456789", at)) != std::string::npos;) {
        corners.push_back(std::stoul(line.substr(at)) - 1);
        at = std::min(line.find(' ', at), line.size());
      }
      for (std::size_t k = 2; k < corners.size(); ++k) {
        const auto &a = points[corners[0]], &b = points[corners[k - 1]], &c = points[corners[k]];
        volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                   a[2] * (b[0] * c[1] - b[1] * c[0])) /
                  6;
      }
    } else {
      std::getline(file, word);
    }
  }
  return std::abs(volume);
}

void report(const SolvedScene& run, double exact) {
  const nlohmann::json& liver = run.summary()["bodies"]["liver"];
  const double rest = liver["volume"].get<double>(), deformed = run.number("volume");
  std::printf("%d frames, %d points; %d Newton iterations, %d load steps\n", liver["frames"].get<int>(),
              liver["points"].get<int>(), run.newton_iterations(), run.summary().value("steps", -1));
  std::printf("rest volume %.9e m3, of the shape %.9e m3, error %.1e\n", rest, exact, std::abs(rest / exact - 1));
  std::printf("deformed volume %.6e m3 (%+.2f %%), largest displacement of a frame %.4f m\n", deformed,
              100 * (deformed / rest - 1), run.number("sag"));
  EXPECT_EQ(run.summary()["status"], "converged");
  EXPECT_NEAR(rest / exact, 1.0, 1e-6);
  EXPECT_NEAR(liver["mass"].get<double>(), 1.5, 1e-12);
  EXPECT_NEAR(deformed / rest, 1.0, 0.05);
  EXPECT_GT(run.number("sag"), 0.005);
  EXPECT_LT(run.number("sag"), 0.08);
}

TEST(Bodies, LiverFromASurfaceFile) {
  const std::filesystem::path mesh = fascia::test::shared_dir() / "meshes" / "liver_sofa_surface.obj";
  if (!std::filesystem::exists(mesh))
    GTEST_SKIP() << "the surface " << mesh << " is not part of the project and is not here";
  const SolvedScene run("liver_surface", {"bodies.liver.domain.file='" + mesh.string() + "'"});
  ASSERT_TRUE(run.ok());
  const int frames = run.summary()["bodies"]["liver"]["frames"].get<int>(),
            points = run.summary()["bodies"]["liver"]["points"].get<int>();
  EXPECT_NEAR(frames, 300, 60);
  EXPECT_NEAR(points, 3000, 600);
  report(run, obj_volume(mesh) * std::pow(0.031317, 3));
}

TEST(Bodies, LiverLikeEllipsoid) {
  const SolvedScene run("liver_like");
  ASSERT_TRUE(run.ok());
  report(run, 4.0 / 3 * std::numbers::pi * 0.1 * 0.045 * 0.075);
  EXPECT_NEAR(run.vector("support_force")[1], 1.5 * 9.81, 1e-5);
}

}  // namespace
}  // namespace fascia::test::bodies_test
