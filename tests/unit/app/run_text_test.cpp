#include "app/results/run_text.hpp"

#include "app/results/probes.hpp"
#include "app/run/progress.hpp"
#include "app/schema/schema.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <thread>

namespace fascia::app::run_text_test {
namespace {

using Json = nlohmann::ordered_json;

TEST(RunText, SixDigits) {
  EXPECT_EQ(short_value(-1.5043896410216413), "-1.50439");
  EXPECT_EQ(short_value(7), "7");
  EXPECT_EQ(short_value(Json{1.0 / 3, 2e10 / 3, 1e-300 / 3}), "[0.333333, 6.66667e+09, 3.33333e-301]");
  EXPECT_EQ(short_value(nullptr), "null");
}

TEST(RunText, LongListsAreShortened) {
  EXPECT_EQ(short_value(Json(std::vector<double>(12, 0.5))),
            "[0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5]");
  const Json vectors(std::vector<std::vector<double>>(41, {1, 2, 3}));
  EXPECT_EQ(short_value(vectors), "[[1, 2, 3], [1, 2, 3], [1, 2, 3], [1, 2, 3], ... 37 more in probes.csv]");
  const std::vector<std::vector<double>> matrix(3, {1, 2, 3});
  EXPECT_EQ(short_value(Json(std::vector{matrix, matrix})),
            "[[[1, 2, 3], [1, 2, 3], [1, 2, 3]], ... 1 more in probes.csv]");
}

TEST(RunText, JsonIsUtf8) {
  EXPECT_EQ(Json::parse(json_text({{"message", "caf\xE9/x.toml: cannot be opened"}}))["message"],
            "caf\xEF\xBF\xBD/x.toml: cannot be opened");
}

TEST(RunText, EveryQuantityOfTheSchemaHasAUnit) {
  const Key probes = probes_schema();
  for (const Choice& c : probes.shape.items.front().find("quantity")->shape.choices) {
    if (!c.supported) continue;
    EXPECT_NE(unit_of_quantity(c.value), "") << c.value;
    const std::string unit = unit_of_quantity(c.value);
    if (c.doc.find('[') != std::string::npos && unit != "Hz")
      EXPECT_NE(c.doc.find("[" + unit + "]"), std::string::npos) << c.value;
  }
}

TEST(Progress, ShowsNewtonIterationsOfALongStep) {
  ::testing::internal::CaptureStderr();
  Progress progress(false, false, true, 0.0);
  progress.update(StepInfo{1, 0.25, 0.25, {}, 1});
  progress.update(IterationInfo{2, 0.5, 3, 1.5e-3, 1e-8});
  const std::string text = ::testing::internal::GetCapturedStderr();
  EXPECT_NE(text.find("load step 1 (factor 0.25)"), std::string::npos) << text;
  EXPECT_NE(text.find("25 %  load step 2 (factor 0.5)  Newton iteration 3  residual 1.5e-03, to be 1.0e-08"),
            std::string::npos)
      << text;
}

TEST(Progress, ShowsThatALongIterationGoesOn) {
  ::testing::internal::CaptureStderr();
  Progress progress(false, false, true, 0.4);
  progress.update(IterationInfo{1, 1, 1, 1, 1e-8});
  std::this_thread::sleep_for(std::chrono::milliseconds(900));
  progress.finish();
  const std::string text = ::testing::internal::GetCapturedStderr();
  EXPECT_NE(text.find("load step 1 (factor 1)  Newton iteration 1"), std::string::npos) << text;
}

TEST(Progress, SaysNothingOfShortSteps) {
  ::testing::internal::CaptureStderr();
  Progress progress(false, false, true, 60.0);
  progress.update(IterationInfo{2, 0.5, 3, 1.5e-3, 1e-8});
  Progress quiet(true, false, true, 0.0);
  quiet.update(IterationInfo{2, 0.5, 3, 1.5e-3, 1e-8});
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace fascia::app::run_text_test
