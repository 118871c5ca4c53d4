#pragma once

#include "app/need/trials.hpp"

namespace fascia::app {

/// Gives flat and slender solids the cells that suit their errors, by trials with twice as many along some directions.
///
/// Cells through a thin direction stay as many as they are where twice as many change next to nothing. Where the other
/// directions are what makes most of the error, these get more cells in all levels: the matrix of a slender body costs
/// as much more by its length, but with a higher power by its section.
void shape_cells(Trials& trials, const NeedChoice& coarsest);

}  // namespace fascia::app
