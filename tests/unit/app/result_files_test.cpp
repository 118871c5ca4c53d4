#include "app/reader/parse.hpp"
#include "app/results/results.hpp"
#include "assembly/build/build_simulation.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <string>

// Files of states.
namespace fascia::app::result_files_test {
namespace {

/// A body of some thousand places, displaced and turned a little.
struct Bent {
  Simulation simulation;
  State state;

  Bent(const std::string& keys, int threads)
      : simulation(build_simulation(
            parse_scene_text(fmt::format("[bodies.b]\ndensity = 1000\n"
                                         "material = {{ young = 1e4, poisson = 0.3 }}\n{}\n"
                                         "[[constraints]]\nbody = \"b\"\nwhere = \"all\"\nfix = \"all\"\n"
                                         "[output]\nfields = [\"displacement\", \"rotation\", \"strain\", \"stress\", "
                                         "\"von_mises\", \"energy_density\"]\n"
                                         "[solver]\nkind = \"static\"\nthreads = {}\n",
                                         keys, threads),
                             "b.toml", {}))),
        state(simulation.initial) {
    for (std::size_t i = 0; i < state.u.size(); ++i) {
      const Vec3d& X = simulation.model.rest_position[i];
      state.u[i] = {{0.01 * X[1] * X[2], 0.02 * X[0] * X[0], -0.01 * X[0]}};
      if (simulation.model.kind(static_cast<int>(i)) != FrameKind::vertex)
        state.D[i] = rotation_increment(Vec3d{{0.01 * X[0], 0.02 * X[1], 0.03}});
    }
  }
  std::string written(const std::filesystem::path& folder) const {
    ResultFiles files(simulation, folder, "b", "");
    files.add_state(0, state);
    std::ifstream file(folder / state_file(simulation.bodies[0], 0), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

/// Frames with their points, elements of several points each, and shells.
TEST(ResultFiles, AreTheSameForAnyNumberOfThreads) {
  const std::string box = "domain = { box = { min = [0, 0, 0], max = [1, 0.8, 0.6]";
  for (const std::string& keys :
       {"model = \"meshless\"\nframes = { grid = [8, 8, 8] }\npoints = { per_cell = [3, 3, 3] }\n" + box + " } }\n",
        "model = \"hexahedra\"\n" + box + ", cells = [12, 10, 8] } }\n",
        std::string("model = \"shell\"\nthickness = 0.01\n"
                    "domain = { ellipsoid = { center = [0, 0, 0], radii = [1, 0.9, 0.8], cells = [64] } }\n")}) {
    const test::TemporaryFolder folder;
    const std::string one = Bent(keys, 1).written(folder.path);
    EXPECT_GT(one.size(), 100'000U);
    EXPECT_TRUE(Bent(keys, 3).written(folder.path) == one) << keys;
  }
}

}  // namespace
}  // namespace fascia::app::result_files_test
