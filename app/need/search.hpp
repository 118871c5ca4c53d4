#pragma once

#include "app/need/accuracy.hpp"

#include <functional>
#include <optional>
#include <string>

namespace fascia::app {

/// What a search may spend.
struct SearchLimits {
  double share = 1;          ///< of the allowed errors that discretisation may take
  double step = INFINITY;    ///< 99th percentile of a step [s]
  double memory = INFINITY;  ///< of a run [bytes]
  int trials = 14;
  double seconds = 1200;  ///< of one run [s]
};

/// The choice that a search came to.
struct Found {
  NeedChoice choice;
  bool met = false;
  std::string why_not;                  ///< a clause: what keeps it from being met
  std::optional<NeedChoice> judged{};   ///< whose discretisation was judged, where that is not the choice itself
  std::vector<std::string> simpler{};   ///< sentences: what was left out, and what that adds to the errors
  std::vector<double> simpler_error{};  ///< what all of it adds, by quantity, relative
  std::vector<double> said_error{};     ///< of cells that the scene says, by quantity, relative; empty where none are
  std::vector<double> time_error{};     ///< of the time steps, by quantity, relative; empty of statics
};

/// The cheapest resolution and family whose error is within those allowed, and whose step and memory are within the
/// limits. Without an allowed error: the most accurate one within the limits.
///
/// Two coarse levels of each family come first. From what they converge to and how fast, the cheapest level is
/// predicted that is good enough, which is tried; where the limits are not known well enough to judge, the surest
/// family is refined. @param like  steps and scheme of all trials
/// @return none where it was stopped, or no trial gave a result (Found::why_not says why)
Found search_resolution(Trials& trials, const NeedChoice& like, const SearchLimits& limits);

/// Predicted cost of a trial of another size, by the nearest one that was made.
struct Prediction {
  double seconds = 0, step = 0, memory = 0;  ///< [s], [s], [bytes]
};
/// @return none where there is no trial of the family
std::optional<Prediction> predicted_cost(const Trials& trials, const Accuracy& accuracy, const Resolution& r);

}  // namespace fascia::app
