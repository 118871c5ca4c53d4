#pragma once

#include "app/estimate/field_samples.hpp"
#include "app/estimate/plan.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace fascia::app {

/// The errors of a scene's results without a reference, by runs of the same scene at other resolutions (plan_estimate).
/// Made before the scene's own run, of which it is told the states.
class Estimate {
 public:
  /// @throws SceneError  as plan_estimate
  explicit Estimate(const Simulation& simulation);

  /// A saved state of the scene's own run.
  void add(double time, const State& state) {
    if (fields_) fields_->add(time, state);
  }

  /// Runs the twins and puts `estimated_error` and `estimate` into the summary.
  /// @param directory  of the scene's own result, which converged
  /// @param tell       is told what is done, a line each
  /// @param stop       ends it once it says true; then the summary stays as it was
  /// @return  whether it was not stopped
  bool run(const std::filesystem::path& directory, nlohmann::ordered_json& summary,
           const std::function<void(const std::string&)>& tell, const std::function<bool()>& stop);

 private:
  const Simulation& simulation_;
  EstimatePlan plan_;
  std::unique_ptr<FieldSamples> fields_;
};

/// What would be run: a line for the cost, then one for each error.
std::vector<std::string> plan_lines(const EstimatePlan& plan);

/// "estimated error of tip: 1.2 % (discretisation 1.1 %, time 0.1 %, solver 2e-06 %)", a line for each probe and body.
std::vector<std::string> estimate_lines(const nlohmann::ordered_json& summary);

}  // namespace fascia::app
