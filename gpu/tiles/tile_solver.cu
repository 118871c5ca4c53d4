#include "gpu/tiles/tile_team_solver.cuh"

#include <algorithm>

namespace fascia {

namespace tile {

DeviceLimits DeviceLimits::present() {
  int device = 0;
  DeviceLimits limits;
  check(cudaGetDevice(&device), "finding the device");
  check(cudaDeviceGetAttribute(&limits.multiprocessors, cudaDevAttrMultiProcessorCount, device), "asking the device");
  check(cudaDeviceGetAttribute(&limits.shared_bytes, cudaDevAttrMaxSharedMemoryPerBlockOptin, device),
        "asking the device");
  return limits;
}

namespace {

/// Tiles of small problems have this many points at least.
constexpr int kLeastResidentPoints = 32;

int whole(int n, int of) { return (n + of - 1) / of * of; }

/// Tiles by which shared memory holds two blocks of 256 threads, or more smaller ones (measured).
int usual_tile_size(int influences, TileConstants constants, bool drilling) {
  if (influences <= 4) return drilling ? 128 : 256;
  if (influences <= 8) return constants == TileConstants::float32 && !drilling ? 256 : 128;
  return influences <= 16 ? 128 : 64;
}

template <class Constant>
std::unique_ptr<TileSolver> make_solver(const TilePoints& points, const TileSolverSettings& settings,
                                        ThreadPool& pool) {
  DeviceLimits limits = DeviceLimits::present();
  for (const int device : settings.devices) {
    const OnDevice on(device);
    limits.shared_bytes = std::min(limits.shared_bytes, DeviceLimits::present().shared_bytes);
  }
  const int n = points.point_count();
  if (n == 0) return nullptr;
  const auto shares = static_cast<int>(settings.devices.size());
  const bool team = shares > 1;
  if (settings.resident && !team && n <= limits.multiprocessors * kMostTileThreads) {
    const int share = (n + limits.multiprocessors - 1) / limits.multiprocessors;
    for (int size = std::max(kLeastResidentPoints, whole(share, 16)); size <= kMostTileThreads; size += 16) {
      auto layout = make_tiles(points, {size, kMostTileFrames}, pool);
      if (!layout) break;
      const ResidentPlan plan = resident_plan<Constant>(*layout);
      if (plan.bytes > limits.shared_bytes) break;
      if (layout->tile_count > limits.multiprocessors) continue;
      return std::make_unique<Solver<Constant>>(whole_share(std::move(*layout)), plan, limits);
    }
  }
  const int wanted = settings.tile_size > 0
                         ? settings.tile_size
                         : usual_tile_size(points.most_influences(), settings.constants, points.drilling);
  for (int size = wanted; size >= 64; size /= 2) {
    auto layout = make_tiles(points, {size, kMostTileFrames}, pool);
    if (!layout) continue;
    if (shared_plan<Constant>(*layout).bytes > limits.shared_bytes) continue;
    if (layout->tile_count < shares && size > 64) continue;
    if (team) return std::make_unique<TeamSolver<Constant>>(std::move(*layout), settings.devices);
    return std::make_unique<Solver<Constant>>(whole_share(std::move(*layout)), std::nullopt, limits);
  }
  return nullptr;
}

}  // namespace
}  // namespace tile

std::unique_ptr<TileSolver> TileSolver::make(const TilePoints& points, const TileSolverSettings& settings,
                                             ThreadPool& pool) {
  return settings.constants == TileConstants::float32 ? tile::make_solver<float>(points, settings, pool)
                                                      : tile::make_solver<double>(points, settings, pool);
}

}  // namespace fascia
