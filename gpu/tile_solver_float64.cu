#include "gpu/tile_solver_cg.cuh"

namespace fascia::tile {

template SharedPlan shared_plan<double>(const TileLayout&);
template ResidentPlan resident_plan<double>(const TileLayout&);
template class Solver<double>;

}  // namespace fascia::tile
