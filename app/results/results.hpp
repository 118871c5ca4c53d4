#pragma once

#include "app/results/budget_use.hpp"
#include "app/results/probes.hpp"
#include "app/results/step_seconds.hpp"
#include "app/run/recovery.hpp"
#include "assembly/simulation/simulation.hpp"
#include "core/base/thread_pool.hpp"
#include "core/run/drivers.hpp"
#include "fascia/run/run_simulation.hpp"
#include "io/result_writer.hpp"

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

struct Failure;

/// Name of the .vtu of a body. @param state  number of the saved state, from 0
std::string state_file(const SimulatedBody& body, std::size_t state);

/// Writes the files of a run as they arise: one .vtu a body and saved time, the .pvd that lists them, probes.csv.
class ResultFiles {
 public:
  /// @param provenance  as text, for each .vtu
  ResultFiles(const Simulation& simulation, std::filesystem::path directory, std::string name, std::string provenance);

  /// Begins probes.csv. @throws FileError
  void open();
  /// A row of probes.csv. @param time  load factor in statics, number of the mode in modes
  /// @param time_step  that ended there, of steps that follow the state [s]
  void add_probes(double time, const ProbeValues& values, double time_step);
  /// The .vtu files of a state. @param time  in the .pvd, where times must not decrease: of a path its step
  /// @throws FileError, InputError
  void add_state(double time, const State& state);
  /// The .vtu files of a state in which the run failed, with what is suspect in it; in no .pvd.
  /// @return  their names. @throws FileError (diagnosis/failed_files.cpp)
  std::vector<std::string> add_failed(const Failure& failure);
  /// Bytes of the .vtu files of a state, about.
  double estimated_size(const State& state);
  /// Waits until probes.csv and the .pvd are on the disk.
  void synchronise() const;

  const std::vector<double>& last_values(std::size_t probe) const { return last_[probe]; }
  double seconds() const { return seconds_; }
  /// State::time of the states that were saved.
  const std::vector<double>& times() const { return times_; }

 private:
  bool tells_time_step() const;  ///< the last column of probes.csv: steps that follow the state
  /// Of the integration points, and recovered at the nodes.
  struct BodyTensors {
    std::vector<PointTensors> points, nodes;
  };
  BodyTensors tensors(const SimulatedBody& b, const State& state);
  io::VisualMesh visual_mesh(const SimulatedBody& b, const State& state);
  io::VisualMesh visual(const SimulatedBody& body, const State& state);
  io::VisualMesh state_mesh(const SimulatedBody& body, const State& state, double time);
  const Simulation& simulation_;
  std::filesystem::path directory_;
  std::string name_, provenance_;
  ThreadPool pool_;
  std::optional<io::GrowingFile> csv_;
  std::optional<io::Collection> collection_;  ///< from the first state on
  std::vector<std::vector<double>> last_;
  std::vector<std::vector<Attachment>> surface_;        ///< of each body
  std::vector<std::optional<NodalRecovery>> recovery_;  ///< of each body, once it is needed
  std::vector<double> times_;
  double seconds_ = 0;
};

struct RunTimes {
  double setup = 0, solve = 0, output = 0;
  double processor = 0;  ///< of the solve, of all threads
  StepSeconds steps;
  BudgetUse budget;  ///< of scenes that give one
};

/// summary.json of a run that goes on: what is known of it from the start.
/// @param provenance  see provenance_of()
nlohmann::ordered_json running_summary(const Simulation& s, const nlohmann::ordered_json& provenance);
const char* status_name(RunStatus status);

/// summary.json of a run that ended, with its couplings and the fluids in bodies.
/// @param probe_values  of modes, frequencies are lists
nlohmann::ordered_json summary(const Simulation& s, const RunEnd& end, const RunTimes& times, int threads,
                               const std::vector<nlohmann::json>& probe_values,
                               const nlohmann::ordered_json& provenance);

}  // namespace fascia::app
