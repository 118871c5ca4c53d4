#pragma once

#include "assembly/simulation/simulation.hpp"

#include <string>

namespace fascia::app {

/// What the files of a run will take.
struct ResultSize {
  double states = 0;        ///< that are saved
  bool at_most = false;     ///< fewer where the path ends earlier
  double state_bytes = 0;   ///< .vtu files of one state
  double probes_bytes = 0;  ///< probes.csv

  double bytes() const { return states * state_bytes + probes_bytes; }
  /// "about 3.4 GB: 500 states of 6.8 MB".
  std::string text() const;
};

/// The size within a factor of about 1.5: arrays of a state that is bent a little everywhere are compressed in samples.
/// That takes as long as it takes to write a state without its compression.
ResultSize forecast_result(const Simulation& simulation);

/// False where numbers of cells and states alone say that there is nothing to warn of; costs nothing.
bool may_be_large(const Simulation& simulation);

/// Prints, and keeps, a warning where the files take more than 1 GB: with the keys that reduce it.
void warn_of_size(Simulation& simulation, const ResultSize& size);

}  // namespace fascia::app
