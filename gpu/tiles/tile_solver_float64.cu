#include "gpu/tiles/tile_team_methods.cuh"

namespace fascia::tile {

template SharedPlan shared_plan<double>(const TileLayout&);
template ResidentPlan resident_plan<double>(const TileLayout&);
template class Solver<double>;
template class TeamSolver<double>;

}  // namespace fascia::tile
