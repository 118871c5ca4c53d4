#pragma once

#include "app/need/search.hpp"

namespace fascia::app {

/// Leaves out of a choice that meets its need what does not matter: finite elements that stay small become linear, a
/// body that moves as a whole rigid, the geometric stiffness goes where Newton's method needs no more iterations
/// without it. Each is tried on a coarse mesh first; all that change little are then tried together with the choice,
/// and stay if they save time and what they add to the errors is still allowed. What the scene says itself stays.
void simplify(Trials& trials, Found& found);

/// The part of the allowed errors that a search leaves to what may be left out: by a coarse trial with each of it, those
/// that save unknowns or iterations.
double room_for_simpler(Trials& trials, const NeedChoice& coarse);

}  // namespace fascia::app
