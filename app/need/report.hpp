#pragma once

#include "app/need/said_cells.hpp"
#include "app/need/search.hpp"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace fascia::app {

/// What a search came to, in words and for summary.json.
class NeedReport {
 public:
  explicit NeedReport(const Scene& scene) : scene_(scene) {}

  /// Its result. Runs the trial that tells the error of the solver. @param seconds  that it took
  void add(Trials& trials, const Found& found, const SaidCells& said, double seconds);
  /// Puts `chosen`, `estimated_error` and `need` into the summary of the run itself, whose steps and memory count too.
  void write(nlohmann::ordered_json& summary);

  const std::vector<std::string>& sentences() const { return sentences_; }
  bool met() const { return why_not_.empty() && step_.empty(); }
  /// Steps of the run were longer than its trial promised: another run may do better.
  bool steps_took_longer() const { return why_not_.empty() && !step_.empty(); }
  /// So they were, but only some of them: the same choice may do.
  bool steps_were_interrupted() const { return steps_took_longer() && interrupted_; }
  /// What was needed, what keeps it from being met, and what was reached.
  std::string not_met() const;

 private:
  const Scene& scene_;
  std::vector<std::string> sentences_, how_;
  nlohmann::ordered_json errors_, trials_;
  std::string why_not_, step_, reached_;
  double seconds_ = 0;
  bool interrupted_ = false;  ///< the longest steps are far above the others
};

/// 0.016 as "1.6 %".
std::string percent(double part);

/// Keys of a need for summary.json, which adds whether it was met.
nlohmann::ordered_json json_of(const StatedNeed& need);

/// "linear or quadratic hexahedra": the kinds that are tried.
std::string families_text(const OpenScene& open);

}  // namespace fascia::app
