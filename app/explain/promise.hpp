#pragma once

#include "app/explain/explanation.hpp"

#include <vector>

namespace fascia::app {

/// Without runs: what a body's points take of the time, and what its deformation is of all displacements.
void estimate(Explanation& explanation);

/// Parts that can be run, by what their change may gain without harm, most first; changes that only show an error of
/// the scene as it is come last. @param explanation  after estimate()
std::vector<Part*> by_promise(Explanation& explanation);

}  // namespace fascia::app
