// What a scene does not name is never entered: the program runs under callgrind, which tells every function that was
// called, and none is of the files of a feature that the scene has no use for.
#include "tests/robustness/scene_runs.hpp"

#include <regex>
#include <set>
#include <sstream>

namespace fascia::idle_features_test {
namespace {

using namespace fascia::test;
namespace fs = std::filesystem;

/// Files of the build that hold a feature: "shells" for all of a folder, "core/cpu/shell_executor" for one.
using Files = std::vector<std::string>;

const Files kShells{"shells", "core/cpu/shell_executor", "core/model/shell_block", "app/shell_meshes"};
const Files kElements{"fem",
                      "core/cpu/element_assembly",
                      "core/cpu/element_average",
                      "core/cpu/element_forces",
                      "core/cpu/element_tangent",
                      "core/model/element_block",
                      "app/element_bodies"};
const Files kMeshless{"meshless"};
const Files kCouplings{"coupling",
                       "core/solver/dependents",
                       "core/cpu/spring_forces",
                       "core/model/dependent_inertia",
                       "app/couplings",
                       "app/carried_surface",
                       "app/tethers"};
const Files kSurfaceLoads{"core/model/surface_load", "core/model/face_rule", "core/cpu/surface_tangent",
                          "core/solver/surface_loads", "app/surface_loads"};
const Files kPaths{"core/solver/path_following", "core/solver/path_system", "core/solver/limit_point",
                   "app/imperfection"};
const Files kDynamics{"core/solver/explicit_dynamics",
                      "core/solver/explicit_mode",
                      "core/solver/explicit_nodes",
                      "core/solver/explicit_plan",
                      "core/solver/explicit_step",
                      "core/solver/stable_step",
                      "core/solver/modes",
                      "core/solver/boundary_motion"};
const Files kGpu{"gpu", "app/gpu_run"};
const Files kTools{"app/bench",  "app/study",  "app/explain", "app/estimate",
                   "app/verify", "app/report", "app/rerun",   "app/picture"};

struct Called {
  double instructions = 0;
  std::set<std::string> functions;  ///< as the linker knows them
};

/// Numbers stand for names that were told before: "fn=(12) name", later "fn=(12)".
Called read_callgrind(const fs::path& file) {
  Called called;
  std::istringstream text(read_text(file));
  const std::regex name(R"(^c?fn=\(\d+\) (\S+))");
  std::smatch found;
  for (std::string line; std::getline(text, line);) {
    if (std::regex_search(line, found, name)) called.functions.insert(found[1]);
    if (line.starts_with("summary: ") || line.starts_with("totals: "))
      called.instructions = std::stod(line.substr(line.find(' ')));
  }
  return called;
}

/// Object files of a feature.
std::vector<std::string> objects_of(const std::string& files) {
  std::vector<std::string> objects;
  for (const auto& entry : fs::recursive_directory_iterator(build_dir() / files.substr(0, files.find('/')))) {
    const std::string path = entry.path().string();
    // core/CMakeFiles/fascia_core.dir/cpu/shell_executor.cpp.o is core/cpu/shell_executor.
    static const std::regex between(R"(/CMakeFiles/[^/]*\.dir)");
    const std::string source = std::regex_replace(fs::relative(entry.path(), build_dir()).string(), between, "");
    if (path.ends_with(".cpp.o") && (source == files + ".cpp.o" || source.starts_with(files + "/")))
      objects.push_back(path);
  }
  return objects;
}

/// Functions that these files alone define: not templates and inline functions, which others have too, nor what is
/// called when the program is loaded.
std::set<std::string> functions_of(const Files& feature) {
  std::set<std::string> functions;
  for (const std::string& files : feature) {
    std::vector<std::string> command{"nm", "--defined-only"};
    const std::vector<std::string> objects = objects_of(files);
    EXPECT_FALSE(objects.empty()) << files << " is no longer built";
    command.insert(command.end(), objects.begin(), objects.end());
    for (const std::string& line : lines_of(run_program(command).out)) {
      std::istringstream words(line);
      std::string address, kind, name;
      if (words >> address >> kind >> name && (kind == "T" || kind == "t") && !name.starts_with("_GLOBAL__sub_I"))
        functions.insert(name);
    }
  }
  return functions;
}

class IdleFeatures : public SceneRuns {
 protected:
  void SetUp() override {
    SceneRuns::SetUp();
    const ProgramResult version = run_program({fascia::test::program(), "--version"});
    if (version.out.find("native") != std::string::npos)
      GTEST_SKIP() << "built for this very processor, of which valgrind does not know all: -DFASCIA_LEVEL=x86-64-v3";
    try {
      run_program({"valgrind", "--version"});
    } catch (const std::runtime_error&) {
      GTEST_SKIP() << "there is no valgrind";
    }
  }

  Called run_counted(const std::string& scene, const std::vector<std::string>& settings) const {
    std::vector<std::string> command{"valgrind",
                                     "--tool=callgrind",
                                     "--demangle=no",
                                     "--callgrind-out-file=counts",
                                     fascia::test::program(),
                                     "run",
                                     (source_dir() / "scenes" / scene).string(),
                                     "--threads",
                                     "1",
                                     "--quiet",
                                     "--output",
                                     "out"};
    for (const std::string& setting : settings) command.insert(command.end(), {"--set", setting});
    ProgramOptions options;
    options.directory = folder_;
    options.environment = {"OPENBLAS_NUM_THREADS=1"};
    options.timeout = std::chrono::minutes(10);
    const ProgramResult result = run_program(command, options);
    EXPECT_EQ(result.status, 0) << result.err;
    return read_callgrind(folder_ / "counts");
  }

  static void expect_idle(const Called& called, const std::vector<Files>& features) {
    for (const Files& feature : features)
      for (const std::string& function : functions_of(feature))
        EXPECT_FALSE(called.functions.contains(function)) << function << " of " << feature[0];
  }
};

TEST_F(IdleFeatures, OfFramesOnAGrid) {
  const Called called = run_counted("soft_cantilever.toml", {});
  std::printf("soft cantilever: %.0f instructions\n", called.instructions);
  ASSERT_GT(called.functions.size(), 1000u);
  expect_idle(called, {kShells, kElements, kCouplings, kSurfaceLoads, kPaths, kDynamics, kGpu, kTools});
}

TEST_F(IdleFeatures, OfTetrahedra) {
  const Called called =
      run_counted("tetrahedra_block.toml", {"bodies.block.domain.box.cells=[1, 1, 1]", "solver.duration=0.05"});
  std::printf("smallest tetrahedra: %.0f instructions\n", called.instructions);
  ASSERT_GT(called.functions.size(), 1000u);
  expect_idle(called, {kShells, kMeshless, kCouplings, kSurfaceLoads, kPaths, kDynamics, kGpu, kTools});
}

TEST_F(IdleFeatures, OfAShell) {
  const Called called = run_counted("shell_roof.toml", {});
  std::printf("shell roof: %.0f instructions\n", called.instructions);
  ASSERT_GT(called.functions.size(), 1000u);
  expect_idle(called, {kElements, kMeshless, kCouplings, kSurfaceLoads, kPaths, kDynamics, kGpu, kTools});
}

}  // namespace
}  // namespace fascia::idle_features_test
