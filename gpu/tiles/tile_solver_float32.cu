#include "gpu/tiles/tile_team_methods.cuh"

namespace fascia::tile {

template SharedPlan shared_plan<float>(const TileLayout&);
template ResidentPlan resident_plan<float>(const TileLayout&);
template class Solver<float>;
template class TeamSolver<float>;

}  // namespace fascia::tile
