#pragma once

#include "app/estimate/field_samples.hpp"
#include "app/estimate/plan.hpp"
#include "app/estimate/series.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

/// The runs of a plan, each in a process of its own, in a hidden folder of a result's directory that is removed.
class TwinRuns {
 public:
  /// @param tell  is told what is done, a line each
  /// @param stop  ends what runs once it says true
  /// @throws FileError  the folder cannot be made
  TwinRuns(const Simulation& simulation, const EstimatePlan& plan, const FieldSamples* fields,
           const std::filesystem::path& directory, const std::function<void(const std::string&)>& tell,
           const std::function<bool()>& stop);

  bool stopped() const { return stopped_; }
  /// Of a twin that converged; none otherwise.
  std::optional<Series> probe(TwinRole role, const std::string& name) const;
  std::optional<Series> field(TwinRole role, std::size_t body) const;
  /// Sentences: which twins gave nothing, and why.
  const std::vector<std::string>& failures() const { return failures_; }
  /// What was run, for summary.json.
  const nlohmann::ordered_json& runs() const { return runs_; }

 private:
  struct Outcome {
    ProbeTable probes;
    bool has_fields = false;
  };
  void run(const PlannedTwin& twin, const std::filesystem::path& folder, const std::function<bool()>& stop);

  const Simulation& simulation_;
  const FieldSamples* fields_;
  std::map<TwinRole, Outcome> outcomes_;
  std::vector<std::string> failures_;
  nlohmann::ordered_json runs_ = nlohmann::ordered_json::array();
  bool stopped_ = false;
};

}  // namespace fascia::app
