// A feature that a scene does not name is not entered: the program runs under callgrind, which tells every function
// that was called and its instructions. Of a feature that the scene has no use for there may be those alone that ask
// whether there is something to do.
#include "tests/robustness/scene_runs.hpp"

#include <cctype>
#include <map>
#include <regex>
#include <set>
#include <sstream>

namespace fascia::idle_features_test {
namespace {

using namespace fascia::test;
namespace fs = std::filesystem;

struct Feature {
  const char* name;
  std::vector<std::string> files;  ///< "shells/": all of a folder; "core/executor/shell_executor": what begins so
  std::vector<std::string> doors;  ///< parts of the names of functions that ask whether there is something to do
  /// Likewise of functions of headers that others inline, and these files alone do not.
  std::vector<std::string> of_headers = {};
};

const Feature kShells{
    "shells",
    {"shells/", "core/executor/shell_executor", "core/structure/shell_block", "assembly/bodies/shell_meshes"},
    {}};
const Feature kElements{
    "elements",
    {"fem/", "core/executor/element_", "core/structure/element_block", "assembly/bodies/element_bodies"},
    {}};
const Feature kMeshless{"meshless bodies", {"meshless/"}, {}};
const Feature kCouplings{
    "couplings",
    {"coupling/", "core/step/dependents", "core/tangent/condensation", "core/executor/spring_executor",
     "core/structure/dependent_inertia", "assembly/actions/couplings", "assembly/bodies/carried_surface",
     "app/results/coupling_report"},
    {"Dependents", "place_dependents", "place_dependent_rates", "forces_turn_hosts", "Condensation", "SpringExecutor",
     "add_couplings", "move_inertia_to_hosts", "move_idle_inertia_to_hosts", "coupling_report"}};
const Feature kTethers{"tethers", {"assembly/actions/tethers"}, {}};
const Feature kSurfaces{"fluids and pressure",
                        {"core/structure/surface_load", "core/structure/face_rule", "core/executor/surface_blocks",
                         "core/step/surface", "assembly/actions/surface_loads"},
                        {"Surfaces", "add_fluids"}};
const Feature kPaths{"paths and imperfections",
                     {"core/solver/path_", "core/run/path_", "core/run/limit_point", "assembly/actions/imperfection"},
                     {"largest_rotation_in", "add_imperfection"}};
const Feature kExplicit{"explicit dynamics", {"core/run/explicit_", "core/run/stable_step"}, {}};
const Feature kModes{"modes", {"core/run/modes", "fascia/run/run_modes"}, {}};
const Feature kGpu{"GPU",
                   {"gpu/", "fascia/run/gpu_run"},
                   {"device_functions_in_use", "device_module_exists", "module_file", "file_of"},
                   {"5StateaSEOS0_", "9RunReportaSEOS0_", "4normIdEET_", "7inverseIdEENS_4Mat3"}};
const Feature kCommands{"other commands",
                        {"app/bench/", "app/study/", "app/explain/", "app/estimate/", "app/verify/", "app/report/",
                         "app/rerun", "app/compare", "app/list", "app/run/check_scene", "app/results/picture"},
                        {"listed_things"}};

/// Most instructions of the doors of all features, of the whole run.
constexpr double kLeast = 1e-4;

struct Called {
  double instructions = 0;
  std::map<std::string, double> functions;  ///< as the linker knows them; instructions of their own
};

/// Numbers stand for names that were told before: "fn=(12) name", later "fn=(12)". Below stand lines "place count", of
/// which the one behind "calls=" is what was called.
Called read_callgrind(const fs::path& file) {
  Called called;
  std::istringstream text(read_text(file));
  const std::regex name(R"(^(c?)fn=(\(\d+\)) ?(\S*))");
  std::map<std::string, std::string> names;
  std::string current;
  bool of_callee = false;
  std::smatch found;
  for (std::string line; std::getline(text, line);) {
    if (line.empty()) continue;
    if (std::regex_search(line, found, name)) {
      if (found[3].length() > 0) names[found[2]] = found[3];
      called.functions[names[found[2]]] += 0;
      if (found[1].length() == 0) current = names[found[2]];
    } else if (line.starts_with("calls=")) {
      of_callee = true;
    } else if (std::isdigit(static_cast<unsigned char>(line[0])) != 0 || line[0] == '+' || line[0] == '-' ||
               line[0] == '*') {
      if (!of_callee && !current.empty()) called.functions[current] += std::stod(line.substr(line.rfind(' ')));
      of_callee = false;
    } else if (line.starts_with("summary: ") || line.starts_with("totals: ")) {
      called.instructions = std::stod(line.substr(line.find(' ')));
    }
  }
  return called;
}

/// "core/executor/shell_executor" of core/CMakeFiles/fascia_core.dir/executor/shell_executor.cpp.o
std::string source_of(const fs::path& object) {
  static const std::regex between(R"(/CMakeFiles/[^/]*\.dir)");
  const std::string path = std::regex_replace(fs::relative(object, build_dir()).string(), between, "");
  return path.substr(0, path.size() - std::string(".cpp.o").size());
}

/// The sources that define each function. Templates of the standard library and of fmt are nobody's own, nor is what is
/// called when the program is loaded.
std::map<std::string, std::set<std::string>> sources_of_functions() {
  std::map<std::string, std::set<std::string>> sources;
  for (const char* folder : {"app", "core", "coupling", "fem", "gpu", "io", "meshless", "shells"})
    for (const auto& entry : fs::recursive_directory_iterator(build_dir() / folder)) {
      if (!entry.path().string().ends_with(".cpp.o")) continue;
      const std::string source = source_of(entry.path());
      for (const std::string& line : lines_of(run_program({"nm", "--defined-only", entry.path().string()}).out)) {
        std::istringstream words(line);
        std::string address, kind, name;
        if (!(words >> address >> kind >> name) || std::string("TtWw").find(kind) == std::string::npos) continue;
        const bool standard = name.starts_with("_ZSt") || name.starts_with("_ZNSt") || name.starts_with("_ZNKSt") ||
                              name.find("N3fmt") != std::string::npos || name.find("NK3fmt") != std::string::npos;
        if (!standard && !name.starts_with("_GLOBAL__sub_I")) sources[name].insert(source);
      }
    }
  return sources;
}

bool is_of(const Feature& feature, const std::string& source) {
  for (const std::string& file : feature.files)
    if (source.starts_with(file)) return true;
  return false;
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
      run_program({"nm", "--version"});
    } catch (const std::runtime_error& e) {
      GTEST_SKIP() << e.what();
    }
  }

  Called run_counted(const std::string& scene, const std::vector<std::string>& settings) const {
    std::vector<std::string> command{"valgrind", "--tool=callgrind", "--demangle=no", "--callgrind-out-file=counts"};
    command.insert(command.end(), {fascia::test::program(), "run", (source_dir() / "scenes" / scene).string(),
                                   "--threads", "1", "--quiet", "--output", "out"});
    for (const std::string& setting : settings) command.insert(command.end(), {"--set", setting});
    ProgramOptions options;
    options.directory = folder_;
    options.timeout = std::chrono::minutes(10);
    const ProgramResult result = run_program(command, options);
    EXPECT_EQ(result.status, 0) << result.err;
    Called called = read_callgrind(folder_ / "counts");
    std::printf("%s: %.1f million instructions\n", scene.c_str(), called.instructions / 1e6);
    EXPECT_GT(called.functions.size(), 1000U);
    return called;
  }

  static void expect_idle(const Called& called, const std::vector<Feature>& features) {
    static const std::map<std::string, std::set<std::string>> sources = sources_of_functions();
    ASSERT_GT(sources.size(), 5000U);
    double spent = 0;
    for (const auto& [function, instructions] : called.functions) {
      const auto found = sources.find(function);
      if (found == sources.end()) continue;
      for (const Feature& feature : features) {
        const auto inside = [&](const std::string& source) { return is_of(feature, source); };
        const auto is_named = [&](const std::string& part) { return function.find(part) != std::string::npos; };
        if (!std::all_of(found->second.begin(), found->second.end(), inside)) continue;
        if (std::any_of(feature.of_headers.begin(), feature.of_headers.end(), is_named)) continue;
        const bool asks = std::any_of(feature.doors.begin(), feature.doors.end(), is_named);
        EXPECT_TRUE(asks) << feature.name << ": " << function << " of " << *found->second.begin();
        spent += instructions;
      }
    }
    std::printf("  asking what there is to do: %.0f instructions\n", spent);
    EXPECT_LT(spent, kLeast * called.instructions);
  }
};

/// A file that moved must not take its feature out of what is looked at.
TEST(IdleFeatureNames, AreThoseOfSources) {
  for (const Feature* feature : {&kShells, &kElements, &kMeshless, &kCouplings, &kTethers, &kSurfaces, &kPaths,
                                 &kExplicit, &kModes, &kGpu, &kCommands})
    for (const std::string& file : feature->files) {
      const fs::path start = source_dir() / file;
      const std::string first = start.filename().string();
      const auto begins = [&](const fs::directory_entry& e) { return e.path().filename().string().starts_with(first); };
      const fs::directory_iterator folder(start.parent_path());
      EXPECT_TRUE(std::any_of(begin(folder), end(folder), begins)) << feature->name << ": " << file;
    }
}

TEST_F(IdleFeatures, OfFramesOnAGrid) {
  expect_idle(run_counted("soft_cantilever.toml", {}),
              {kShells, kElements, kCouplings, kTethers, kSurfaces, kPaths, kExplicit, kModes, kGpu, kCommands});
}

TEST_F(IdleFeatures, OfTetrahedra) {
  expect_idle(run_counted("tetrahedra_block.toml", {"bodies.block.domain.box.cells=[1, 1, 1]", "solver.duration=0.05"}),
              {kShells, kMeshless, kCouplings, kTethers, kSurfaces, kPaths, kExplicit, kModes, kGpu, kCommands});
}

TEST_F(IdleFeatures, OfAShell) {
  expect_idle(run_counted("shell_roof.toml", {"bodies.roof.domain.cylinder.cells=[4, 4]"}),
              {kElements, kMeshless, kCouplings, kTethers, kSurfaces, kPaths, kExplicit, kModes, kGpu, kCommands});
}

}  // namespace
}  // namespace fascia::idle_features_test
