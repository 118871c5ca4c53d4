// Scenes drawn at random, and their twins in other units, turned, mirrored, with the other linear solver
// and in the GPU's steps.
#include "tests/random/invariants.hpp"
#include "tests/support/cases.hpp"
#include "tests/support/scene_run.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>

namespace fascia::random_scenes_test {
namespace {

using namespace fascia::random_scenes;

/// Counts of how scenes ended.
struct Tally {
  std::map<std::string, int> counts;
  std::vector<double> seconds;  ///< of a processor, of each scene's run
  void count(const std::string& what) { ++counts[what]; }
  void print() {
    std::sort(seconds.begin(), seconds.end());
    if (!seconds.empty())
      std::printf("  a run takes %.3f s (median), %.2f s at most\n", seconds[seconds.size() / 2], seconds.back());
    for (const auto& [what, number] : counts) std::printf("  %-48s %6d\n", what.c_str(), number);
  }
};

class Examination {
 public:
  explicit Examination(std::uint64_t seed) : scene_(random_scene(seed)), text_(text_of(scene_.tree)), seed_(seed) {}

  /// @return  what is wrong, in words
  std::vector<std::string> run(Tally& tally) {
    write_meshes(scene_.meshes, {}, folder_.path);
    const Outcome outcome = random_scenes::run(text_.text, folder_.path);
    for (const std::string& f : scene_.features)
      tally.count(
          fmt::format("with {}: exit status {}{}", f, outcome.exit_status, scene_.wrong.empty() ? "" : ", wrong"));
    tally.count(fmt::format("exit status {}{}", outcome.exit_status, scene_.wrong.empty() ? "" : ", wrong on purpose"));
    if (scene_.wrong.empty() && outcome.exit_status == 3) tally.count("status " + outcome.status());
    tally.seconds.push_back(outcome.seconds);
    if (outcome.seconds > 2) tally.count(fmt::format("seed {} takes {:.0f} s", seed_, outcome.seconds));
    note(faults_of_end(outcome), "");
    if (!scene_.wrong.empty()) {
      tally.count("wrong: " + scene_.wrong);
      note(faults_of_refusal(scene_, text_, outcome), "");
      return faults_;
    }
    if (outcome.exit_status == 2 && std::getenv("FASCIA_SHOW_REFUSED")) std::printf("%s", outcome.message.c_str());
    std::vector<std::string> checked;
    note(faults_of_balance(scene_, outcome, checked), "");
    for (const std::string& name : checked) tally.count("checked: " + name);
    if (outcome.timed_out || outcome.exit_status == 2) return faults_;
    Draws draws(seed_ + 1000000007);
    Frame units{.mass = draws.decades(-3, 3), .length = draws.decades(-3, 3), .time = draws.decades(-3, 3)};
    twin("units", units, outcome, tally);
    twin("turned", Frame{.turned = true}, outcome, tally);
    twin("mirrored", Frame{.mirrored = draws.whole(0, 2)}, outcome, tally);
    if (seed_ % 4 == 0 && !scene_.tree["solver"].contains("imperfection"))
      compare_with("texts", with_texts(scene_.tree), {}, outcome, tally);
    const Json other = with_other_solver(scene_.tree);
    if (!other.is_null()) compare_with("solver", other, {}, outcome, tally);
    const Json on_gpu = takes_steps_of_gpu() ? with_other_backend(scene_.tree) : Json(nullptr);
    if (!on_gpu.is_null()) compare_with("backend", on_gpu, {}, outcome, tally);
    return faults_;
  }
  const std::string& text() const { return text_.text; }
  void keep(const std::filesystem::path& folder) const {
    std::ofstream(folder / fmt::format("{}.toml", seed_)) << text_.text;
    write_meshes(scene_.meshes, {}, folder);
  }

 private:
  /// In the processor's memory they take a few times as long: every fifth scene; on a GPU all.
  bool takes_steps_of_gpu() const { return seed_ % 5 == 0 || std::getenv("FASCIA_ON_DEVICE") != nullptr; }

  void note(const std::vector<std::string>& faults, const std::string& of) {
    for (const std::string& f : faults) faults_.push_back(of + f);
  }

  void twin(const std::string& name, const Frame& frame, const Outcome& outcome, Tally& tally) {
    const std::string none = no_twin(scene_.tree, frame);
    if (!none.empty()) return tally.count("twin " + name + ": none, " + none);
    compare_with(name, in_frame(scene_.tree, frame), frame, outcome, tally);
  }

  void compare_with(const std::string& name, const Json& tree, const Frame& frame, const Outcome& outcome,
                    Tally& tally) {
    write_meshes(scene_.meshes, frame, folder_.path);
    const Outcome other = random_scenes::run(text_of(tree).text, folder_.path);
    note(faults_of_end(other), "twin " + name + ": ");
    const Comparison c = compare(scene_, outcome, other, frame);
    static const char* const kinds[] = {"agrees", "fails alike", "has several ends, as is said",
                                        "alone converges or fails", "DIFFERS"};
    tally.count("twin " + name + ": " + kinds[static_cast<int>(c.kind)]);
    // Conjugate gradients may give up where a factor does not, or where rounding goes another way, and say so: on thin
    // shells and sheets above all.
    const auto cg_gave_up = [](const Outcome& o) {
      return o.exit_status == 3 && o.message.find("conjugate gradients end at their") != std::string::npos;
    };
    const bool gave_up =
        c.kind == Comparison::Kind::one_failed && (name == "solver" || cg_gave_up(outcome) || cg_gave_up(other));
    if (gave_up) std::printf("seed %llu: conjugate gradients alone fail\n", static_cast<unsigned long long>(seed_));
    if (c.kind == Comparison::Kind::differ || (c.kind == Comparison::Kind::one_failed && !gave_up))
      faults_.push_back("twin " + name + ": " + c.text + "\n# the twin:\n" + text_of(tree).text);
  }

  RandomScene scene_;
  SceneText text_;
  std::uint64_t seed_;
  test::TemporaryFolder folder_;
  std::vector<std::string> faults_;
};

constexpr int kShares = 8;

/// The GPU's steps run in the processor's memory; on a GPU where FASCIA_ON_DEVICE is set.
class StepsOfGpu : public testing::Environment {
 public:
  void SetUp() override {
    const std::string module = (test::build_dir() / "fascia-host.so").string();
    if (std::getenv("FASCIA_ON_DEVICE") == nullptr) setenv("FASCIA_DEVICE_MODULE", module.c_str(), 1);
  }
};

testing::Environment* const steps_of_gpu = testing::AddGlobalTestEnvironment(new StepsOfGpu);

/// Seeds with a finding that is not settled: it is told, and fails nothing.
const std::map<std::uint64_t, const char*> kOpen{
    {672, "a shell of 1/1500 under a line force has several ends, of which nothing is said"},
    {775, "a rotation of 1e-7 rad is off by 2e-13 rad, 2.3 times what is allowed, with the other linear solver"},
    {844,
     "a shell on slack strands beside a body that is 570 times as stiff: what is left within the tolerance of the "
     "whole is 2e-4 of the shell's displacement; parts are judged apart from 1,000 on"},
    {1917, "a wire that its weight bends double has several ends, of which nothing is said"}};

/// Seeds that take half a minute (20: with the GPU's conjugate gradients, which have no factor to fall back on, until
/// Newton's method gives up); they run where many do.
constexpr std::uint64_t kLong[] = {20};
constexpr int kMany = 100;  ///< cases

void examine(std::uint64_t seed, Tally& tally) {
  Examination examination(seed);
  const char* keep = std::getenv("FASCIA_KEEP_SCENES");
  if (keep != nullptr) examination.keep(keep);
  const std::vector<std::string> faults = examination.run(tally);
  const auto open = kOpen.find(seed);
  if (open != kOpen.end()) {
    std::printf("seed %d: %zu findings, open: %s\n", static_cast<int>(seed), faults.size(), open->second);
    return;
  }
  for (const std::string& fault : faults)
    ADD_FAILURE() << "seed " << seed << ": " << fault << "\n# the scene:\n" << examination.text();
}

class RandomScenes : public testing::TestWithParam<int> {};

/// FASCIA_FIRST_SEED and FASCIA_CASES say which seeds; FASCIA_KEEP_SCENES where the scenes are kept.
TEST_P(RandomScenes, KeepTheirInvariants) {
  Tally tally;
  const int count = test::cases(40);
  const char* first = std::getenv("FASCIA_FIRST_SEED");
  for (int i = GetParam(); i < count; i += kShares) {
    const auto seed = static_cast<std::uint64_t>((first != nullptr ? std::atoi(first) : 1) + i);
    if (first == nullptr && count < kMany && std::ranges::find(kLong, seed) != std::end(kLong)) {
      std::printf("seed %d: among many cases only\n", static_cast<int>(seed));
      continue;
    }
    examine(seed, tally);
  }
  tally.print();
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomScenes, testing::Range(0, kShares));

/// Seeds of scenes that were hard to judge: an acceptance by parts (1460), surfaces on solids (805), Newmark's rule
/// with nodes that follow (165), loads on what is held (1995).
TEST(RandomScenesFound, BeforeStayRight) {
  Tally tally;
  for (const std::uint64_t seed : {165, 805, 1460, 1995}) examine(seed, tally);
  tally.print();
}

/// The comparison is worth something: a modulus that is off by a thousandth is seen wherever it has an effect.
TEST(RandomScenesSee, AThousandthOfAModulus) {
  int seen = 0, looked_at = 0;
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    const RandomScene scene = random_scene(seed);
    Json other = scene.tree;
    bool changed = false;
    for (auto& [name, body] : other["bodies"].items())
      for (const char* key : {"young", "c10", "c01", "c20", "c02", "bulk"})
        if (body.contains("material") && body["material"].is_object() && body["material"].contains(key) &&
            body["material"][key].is_number()) {
          body["material"][key] = 1.001 * body["material"][key].get<double>();
          changed = true;
        }
    if (!scene.wrong.empty() || !changed || !scene.tree.contains("loads") || scene.tree["solver"]["kind"] != "static")
      continue;
    const test::TemporaryFolder folder;
    write_meshes(scene.meshes, {}, folder.path);
    const Outcome one = random_scenes::run(text_of(scene.tree).text, folder.path);
    if (one.exit_status != 0) continue;
    const Outcome two = random_scenes::run(text_of(other).text, folder.path);
    ++looked_at;
    seen += compare(scene, one, two, {}).kind == Comparison::Kind::differ ? 1 : 0;
  }
  std::printf("%d of %d\n", seen, looked_at);
  EXPECT_GE(looked_at, 5);
  EXPECT_GE(seen, looked_at - 1) << "one may have loads on what is held alone";
}

}  // namespace
}  // namespace fascia::random_scenes_test
