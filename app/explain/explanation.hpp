#pragma once

#include "app/explain/body_motion.hpp"
#include "app/explain/variants.hpp"
#include "app/study/record.hpp"

#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

/// A share of what the whole scene takes.
struct Share {
  double value = 0;
  bool estimated = false;  ///< not measured: the share of the points
  std::string how;         ///< "left out", "as rigid"; empty where it is estimated
};

struct BodyProfile {
  std::string name, model;
  int unknowns = 0;
  std::size_t points = 0, cells = 0;
  double mass = 0;               ///< [kg]
  Share time;                    ///< of the solve
  std::optional<double> memory;  ///< of the peak, measured
  std::optional<BodyMotion> motion;
};

/// Times of one run by stage [s], and its memory [bytes].
struct Stages {
  double start = 0;  ///< of the program: all that is none of the others
  double setup = 0, solve = 0, output = 0;
  double memory_start = 0, memory_setup = 0, memory_run = 0;  ///< what each adds to the peak
};

/// How much something takes, relative to the scene as it is.
struct Ratio {
  double median = 1, low = 1, high = 1;
  bool is_less() const { return high < 1; }
};

/// The difference that a change makes to a probe.
struct ProbeChange {
  std::string probe;
  std::optional<double> relative;  ///< |new − old| / |old|, of dynamics over the curve; none: it is not there
};

/// A variant with what it did.
struct Part {
  Variant variant;
  std::optional<RunRecord> record;  ///< none: refused, or not run
  Ratio solve, setup;               ///< of runs that converged, beside the scene as it is
  double memory = 1;                ///< peak over that of the scene as it is
  std::vector<ProbeChange> changes;
  double estimated_gain = 0;               ///< without runs: of the solve's time, a share
  std::optional<double> estimated_change;  ///< without runs: about, of displacements

  bool measured() const { return record && record->converged(); }
  /// The largest of the probes' changes; none where no probe can be compared.
  const ProbeChange* largest_change() const;
};

struct Suggestion {
  std::string text;                    ///< a sentence
  std::vector<std::string> overrides;  ///< that carry it out
  Ratio solve;                         ///< measured beside runs of the scene as it is, in turns
  std::optional<ProbeChange> change;
  bool estimated = false;
  bool carried_out = true;  ///< among those that are tried together
};

struct Explanation {
  Scene scene;
  std::vector<std::string> overrides;  ///< of the base run
  bool quick = false, interrupted = false;
  int turns = 1;        ///< of each suggestion with the scene as it is
  double seconds = 0;   ///< that all of it took
  double limit = 1e-2;  ///< of the changes of probes that a suggestion may make
  RunRecord base;
  Stages stages;
  std::vector<BodyProfile> bodies;
  std::vector<Part> parts;
  std::vector<Suggestion> suggestions;
  std::optional<Suggestion> together;  ///< all that can be combined
  std::vector<std::string> notes;      ///< what a reader should mind
};

}  // namespace fascia::app
