#pragma once

#include "app/verify/cases.hpp"

#include <string>
#include <vector>

namespace fascia::app {

/// What of a registry is to be run.
struct ChosenRuns {
  Registry runs;              ///< with the cases that were chosen
  std::size_t long_left = 0;  ///< runs left out because they take long
};

/// Chooses by names of runs, cases, topics and features, and by globs of them ("cantilever-*"). Without names: all.
/// Runs that take long are left out unless `full`, or named themselves; a case that is named is chosen without the
/// others of its run.
/// @throws InputError  a name that is none of these, with one that is near
ChosenRuns choose(const Registry& registry, const std::vector<std::string>& names, bool full);

/// Prints all runs with their cases, the features with their numbers, and totals.
void print_registry(const ChosenRuns& chosen);

}  // namespace fascia::app
