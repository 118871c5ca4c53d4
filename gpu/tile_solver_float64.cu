#include "gpu/tile_solver_cg.cuh"

namespace fascia::tile {

template SharedPlan shared_plan<double>(const TileLayout&, int);
template ResidentPlan resident_plan<double>(const TileLayout&, int);
template class Solver<double>;

}  // namespace fascia::tile
