#pragma once

#include <string>
#include <vector>

namespace fascia::app {

/// A small scene that is timed.
struct TuneCase {
  std::string kind;  ///< as in CostSample
  int size = 1;      ///< cells across
  bool factorised = true, dynamics = false;
  int threads = 1;
  bool explicit_steps = false;  ///< and the others mean nothing
};

/// From those without which nothing can be fitted to those that refine. @param quick  the first ones alone
std::vector<TuneCase> tune_cases(bool quick, int threads);

/// A block, or for shells a plate, twice as long as wide, held at one end, under its weight: load steps, ten
/// implicit steps, or 300 explicit ones.
std::string tune_scene(const TuneCase& c);

/// Courant number of its implicit steps, as LinearUse has it; else 0.
double courant_of(const TuneCase& c);

}  // namespace fascia::app
