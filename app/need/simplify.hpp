#pragma once

#include "app/need/search.hpp"

namespace fascia::app {

/// Leaves out of a choice that meets its need what does not matter: a body that moves as a whole becomes rigid, finite
/// elements that stay small linear, the geometric stiffness goes where Newton's method needs no more iterations without
/// it, and bodies whose own errors leave room get fewer cells. Each is tried on a coarse mesh first, then with the
/// choice, one after the other; it stays where it saves time and all of them add no more to any error than is left: of
/// what the need does not name, the largest error that it allows. What the scene says itself stays.
void simplify(Trials& trials, Found& found);

/// The part of the allowed errors that a search leaves to what may be left out: by a coarse trial with each of it,
/// those that save unknowns or iterations.
double room_for_simpler(Trials& trials, const NeedChoice& coarse);

}  // namespace fascia::app
