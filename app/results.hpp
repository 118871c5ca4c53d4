#pragma once

#include "app/backend.hpp"
#include "app/coupling_report.hpp"
#include "app/probes.hpp"
#include "app/simulation.hpp"
#include "core/solver/drivers.hpp"
#include "io/result_writer.hpp"

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

/// Writes the files of a run as they arise: one .vtu a body and saved time, the .pvd that lists them, probes.csv.
class ResultFiles {
 public:
  ResultFiles(const Simulation& simulation, std::filesystem::path directory, std::string name);

  /// Begins probes.csv. @throws FileError
  void open();
  /// A row of probes.csv. @param time  load factor in statics, number of the mode in modes
  void add_probes(double time, const Snapshot& at);
  /// The .vtu files of a state. @param time  in the .pvd, where times must not decrease: of a path its step
  /// @throws FileError, InputError
  void add_state(double time, const State& state);
  /// Waits until probes.csv and the .pvd are on the disk.
  void synchronise() const;

  const std::vector<double>& last_values(std::size_t probe) const { return last_[probe]; }
  double seconds() const { return seconds_; }

 private:
  bool tells_time_step() const;  ///< the last column of probes.csv: steps that follow the state
  io::VisualMesh visual_mesh(const SimulatedBody& b, const State& state) const;
  io::VisualMesh visual(const SimulatedBody& body, const State& state) const;
  const Simulation& simulation_;
  std::filesystem::path directory_;
  std::string name_;
  std::optional<io::GrowingFile> csv_;
  std::optional<io::Collection> collection_;  ///< from the first state on
  std::vector<std::vector<double>> last_;
  std::vector<std::vector<Attachment>> surface_;  ///< of each body
  int saved_ = 0;
  double seconds_ = 0;
};

struct RunTimes {
  double setup = 0, solve = 0, output = 0;
  std::vector<double> steps;
};

/// summary.json of a run that goes on: what is known of it from the start.
nlohmann::ordered_json running_summary(const Simulation& s);
const char* status_name(RunStatus status);

/// summary.json. Modes put a list into the probes of quantity frequency.
/// @param fluids  of Simulation::fluids at the end; none of modes
/// @param couplings  see coupling_report()
nlohmann::ordered_json summary(const Simulation& s, Backend backend, int gpus, const RunReport& run,
                               const RunTimes& times, int threads, const std::vector<nlohmann::json>& probe_values,
                               double stabilization_energy, const std::vector<FluidState>& fluids,
                               const CouplingReports& couplings);

}  // namespace fascia::app
