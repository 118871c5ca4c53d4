#pragma once

namespace fascia::app {

/// Watches what else the machine does while something is timed.
class MachineLoad {
 public:
  MachineLoad();
  /// Processor time of others since then, as a share of all processors' time [0, 1]; 0 where the system does not tell.
  /// @param own  processor time of what is timed [s]
  double others(double own) const;

 private:
  double busy_ = 0, total_ = 0;  ///< of all processors [s]
};

/// Shares above this make times untrustworthy.
inline constexpr double kBusy = 0.1;

}  // namespace fascia::app
