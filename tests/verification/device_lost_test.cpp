#include "app/reader/parse.hpp"
#include "app/run/run_scene.hpp"
#include "assembly/build/build_simulation.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "fascia/backend.hpp"
#include "fascia/run/gpu_run.hpp"
#include "gpu/space/device.hpp"
#include "tests/support/paths.hpp"
#include "tests/verification/break_device.hpp"

#include <gtest/gtest.h>

#include <filesystem>

/// A device that fails or has no memory; each test in a process of its own.
namespace fascia::test::device_lost_test {
namespace {

class DeviceLost : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    std::string reason;
    if (!gpu::find_device(reason)) GTEST_SKIP() << reason;
    simulation_.emplace(
        build_simulation(app::parse_scene_file(fascia::test::source_dir() / "scenes" / (GetParam() + ".toml"), {})));
    state_ = simulation_->initial;
  }
  std::optional<GpuRun> run(const std::string& backend, const gpu::DeviceObserver& observe) {
    simulation_->scene.solver.backend = backend;
    return run_on_gpu(
        *simulation_, state_, [this](double t) { return simulation_->factors(t); },
        settings_of(simulation_->scene.solver), [this](const std::string& text) { warnings_.push_back(text); },
        observe);
  }
  std::optional<Simulation> simulation_;
  State state_;
  std::vector<std::string> warnings_;
};

TEST_P(DeviceLost, OnTheWayEndsTheRunWithWhatWasSeen) {
  State seen;
  const std::optional<GpuRun> run = this->run("auto", [&](const StepInfo& step, ReachedStep& device) {
    seen = device.state();
    if (step.step == 3) break_device();
    return true;
  });
  ASSERT_TRUE(run.has_value());
  EXPECT_EQ(run->report.status, RunStatus::not_converged);
  EXPECT_EQ(run->report.steps, 3);
  EXPECT_EQ(run->report.message.rfind("after step 3: gpu: ", 0), 0u) << run->report.message;
  EXPECT_EQ(state_.u, seen.u);
}

TEST_P(DeviceLost, WithoutMemorySaysHowMuchThereIs) {
  const std::vector<void*> taken = take_memory();
  const State before = state_;
  EXPECT_FALSE(run("auto", {}).has_value());
  EXPECT_EQ(warnings_.size(), 1u);
  try {
    run("cuda", {});
    ADD_FAILURE() << "ran without memory";
  } catch (const BackendError& e) {
    EXPECT_NE(std::string(e.what()).find("gpu: out of memory: asked for "), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find(" free of "), std::string::npos) << e.what();
  }
  EXPECT_EQ(state_.u, before.u);
  give_back(taken);
  EXPECT_TRUE(run("cuda", [](const StepInfo&, ReachedStep&) { return false; }).has_value());
}

INSTANTIATE_TEST_SUITE_P(device, DeviceLost, ::testing::Values("tumbling_box", "shell_spin", "struck_beam"),
                         [](const auto& scene) { return scene.param; });

}  // namespace
}  // namespace fascia::test::device_lost_test
