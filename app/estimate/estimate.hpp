#pragma once

#include "app/estimate/error_estimate.hpp"
#include "app/estimate/field_samples.hpp"
#include "app/estimate/plan.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace fascia::app {

/// By runs of the same scene at other resolutions (plan_estimate).
class Estimate final : public ErrorEstimate {
 public:
  /// @throws SceneError  as plan_estimate
  explicit Estimate(const Simulation& simulation);

  void add(double time, const State& state) override {
    if (fields_) fields_->add(time, state);
  }

  bool run(const std::filesystem::path& directory, nlohmann::ordered_json& summary,
           const std::function<void(const std::string&)>& tell, const std::function<bool()>& stop) override;

 private:
  const Simulation& simulation_;
  EstimatePlan plan_;
  std::unique_ptr<FieldSamples> fields_;
};

/// What would be run: a line for the cost, then one for each error.
std::vector<std::string> plan_lines(const EstimatePlan& plan);

}  // namespace fascia::app
