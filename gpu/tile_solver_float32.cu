#include "gpu/tile_solver_cg.cuh"

namespace fascia::tile {

template SharedPlan shared_plan<float>(const TileLayout&);
template ResidentPlan resident_plan<float>(const TileLayout&);
template class Solver<float>;

}  // namespace fascia::tile
