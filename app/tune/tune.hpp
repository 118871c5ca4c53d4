#pragma once

namespace fascia::app {

struct TuneOptions {
  bool quick = false;  ///< the runs without which nothing can be fitted, alone
  bool json = false;
};

/// Times small scenes of this program on this machine, within 20 s, and keeps what they cost (tune_file()).
/// @return kDone; kNotConverged where too few of them ran
int run_tune(const TuneOptions& options);

}  // namespace fascia::app
