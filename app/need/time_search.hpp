#pragma once

#include "app/need/search.hpp"

namespace fascia::app {

/// What a search begins with: the coarsest level of the cheapest family, of an open time step 32 steps.
NeedChoice first_choice(const Trials& trials);

/// As search_resolution(), for dynamics: time steps come first. On a coarse mesh they are halved until their error is a
/// quarter of what is allowed (at equal orders that shares the cost best, as cells have three directions); then the
/// resolution is looked for with that many steps, and the error of the steps is measured again with the mesh that was
/// chosen.
Found search_in_time(Trials& trials, const NeedChoice& first, const SearchLimits& limits);

}  // namespace fascia::app
