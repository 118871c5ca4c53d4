#pragma once

#include "app/backend.hpp"
#include "app/coupling_report.hpp"
#include "app/probes.hpp"
#include "app/simulation.hpp"
#include "core/solver/drivers.hpp"
#include "io/result_writer.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

namespace fascia::app {

/// Writes the files of a run: one .vtu a body and saved time, the .pvd that lists them, probes.csv.
class ResultFiles {
 public:
  ResultFiles(const Simulation& simulation, std::filesystem::path directory, std::string name);

  /// A row of probes.csv. @param time  load factor in statics, number of the mode in modes
  void add_probes(double time, const Snapshot& at);
  /// The .vtu files of a state. @param time  in the .pvd, where times must not decrease: of a path its step
  /// @throws FileError, InputError
  void add_state(double time, const State& state);
  /// Writes the .pvd and probes.csv.
  void finish();

  const std::vector<double>& last_values(std::size_t probe) const { return last_[probe]; }
  double seconds() const { return seconds_; }

 private:
  bool tells_time_step() const;  ///< the last column of probes.csv: steps that follow the state
  io::VisualMesh visual_mesh(const SimulatedBody& b, const State& state) const;
  io::VisualMesh visual(const SimulatedBody& body, const State& state) const;
  const Simulation& simulation_;
  std::filesystem::path directory_;
  std::string name_, csv_;
  std::vector<io::PvdEntry> entries_;
  std::vector<std::vector<double>> last_;
  std::vector<std::vector<Attachment>> surface_;  ///< of each body
  int saved_ = 0;
  double seconds_ = 0;
};

struct RunTimes {
  double setup = 0, solve = 0, output = 0;
  std::vector<double> steps;
};

/// summary.json. Modes put a list into the probes of quantity frequency.
/// @param fluids  of Simulation::fluids at the end; none of modes
/// @param couplings  see coupling_report()
nlohmann::ordered_json summary(const Simulation& s, Backend backend, int gpus, const RunReport& run,
                               const RunTimes& times, int threads, const std::vector<nlohmann::json>& probe_values,
                               double stabilization_energy, const std::vector<FluidState>& fluids,
                               const CouplingReports& couplings);

}  // namespace fascia::app
