#include "bench/tile_problem.hpp"
#include "core/base/thread_pool.hpp"
#include "core/linear/vectors.hpp"
#include "core/node/positive_inverse.hpp"
#include "gpu/tiles/tile_memory.cuh"
#include "gpu/tiles/tile_solver.hpp"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>

/// Time of 60 CG iterations on tiles, after checks of products, forces, residuals and repeatability.
///   tile_benchmark [points:influences:bits:drilling:tile:resident:gpus ...]
/// bits: 64 or 32 of the constants; drilling: 0 or 1; tile: 0 as usual, 64, 128 or 256; resident: 0 or 1.
/// gpus: shares of as many of them as there are.
namespace fascia::bench {
namespace {

constexpr int kIterations = 60;
constexpr int kMostChecked = 1'100'000;  // points
constexpr int kMostSolved = 40'000;      // points, by the processor too

struct Case {
  int points = 0, influences = 4, bits = 64, drilling = 0, tile = 0, resident = 1, gpus = 1;
};

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += (a[i] - b[i]) * (a[i] - b[i]);
    size += b[i] * b[i];
  }
  return std::sqrt(sum / size);
}

/// Median of several runs [ms].
template <class Work>
double milliseconds(int runs, const Work& work) {
  cudaEvent_t begin{}, end{};
  tile::check(cudaEventCreate(&begin), "making an event");
  tile::check(cudaEventCreate(&end), "making an event");
  std::vector<double> times;
  for (int run = 0; run <= runs; ++run) {
    tile::check(cudaEventRecord(begin), "timing");
    work();
    tile::check(cudaEventRecord(end), "timing");
    tile::check(cudaEventSynchronize(end), "timing");
    float ms = 0;
    tile::check(cudaEventElapsedTime(&ms, begin, end), "timing");
    if (run > 0) times.push_back(ms);
  }
  cudaEventDestroy(begin);
  cudaEventDestroy(end);
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

struct Device {
  tile::Buffer<double> u, D, blocks, b, x, y;
  explicit Device(const TileProblem& p) {
    std::vector<double> values;
    for (const Vec3d& v : p.u) values.insert(values.end(), v.v, v.v + 3);
    u.upload(values);
    values.clear();
    for (const Mat3d& m : p.D) values.insert(values.end(), &m.m[0][0], &m.m[0][0] + 9);
    D.upload(values);
    blocks.upload(p.node_blocks);
    b.upload(p.b);
    x.resize(p.b.size());
    y.resize(p.b.size());
  }
};

/// Products and forces against the processor; errors relative to the whole.
void check_results(TileSolver& solver, const TileReference& reference, const TileProblem& problem, Device& device) {
  solver.multiply(device.b.get(), device.y.get());
  std::printf("  product %.1e", difference(device.y.download(), reference.product(problem.b)));
  double energy = 0;
  const std::vector<double> forces = reference.gradient(energy);
  const TileEnergy e = solver.gradient(device.u.get(), device.D.get(), 0, device.y.get(), nullptr);
  std::printf(", forces %.1e, energy %.1e\n", difference(device.y.download(), forces),
              std::abs((e.elastic + e.stabilization) / energy - 1));
}

/// Residual curves against the processor's CG.
void check_residuals(TileSolver& solver, const TileReference& reference, const TileProblem& problem, Device& device,
                     bool block_jacobi, ThreadPool& pool) {
  std::vector<double> inverse;
  if (block_jacobi) {
    inverse = reference.diagonal();
    for (std::size_t f = 0; f < inverse.size(); f += 36) positive_inverse(inverse.data() + f, 6);
  }
  const CpuVectors vectors(pool);
  const auto precondition = [&](const CpuVectors::Vector& r, CpuVectors::Vector& z) {
    z = r;
    for (std::size_t f = 0; block_jacobi && f < r.size() / 6; ++f)
      for (std::size_t i = 0; i < 6; ++i) {
        z[6 * f + i] = 0;
        for (std::size_t j = 0; j < 6; ++j) z[6 * f + i] += inverse[36 * f + 6 * i + j] * r[6 * f + j];
      }
    return vectors.dot(r, z);
  };
  const auto apply = [&](const CpuVectors::Vector& p, CpuVectors::Vector& Ap) {
    const std::vector<double> y = reference.product({p.begin(), p.end()});
    Ap.assign(y.begin(), y.end());
  };
  for (const int iterations : {1, 10, kIterations}) {
    const CgOptions options{iterations, 1e-14};
    CpuVectors::Vector x;
    const CgReport host = conjugate_gradients(vectors, apply, precondition,
                                              CpuVectors::Vector(problem.b.begin(), problem.b.end()), x, options);
    const CgReport there = solver.solve(device.b.get(), device.x.get(), options);
    std::printf("  %s after %d: residual %.6e, processor %.6e, x differs by %.1e, status %d %d\n",
                block_jacobi ? "block-Jacobi" : "plain", there.iterations, there.relative_residual,
                host.relative_residual, difference(device.x.download(), {x.begin(), x.end()}),
                static_cast<int>(there.status), static_cast<int>(host.status));
  }
}

void run(const Case& c, const TileProblem& problem, ThreadPool& pool) {
  std::printf("case %d points, K = %d, fp%d constants, drilling %d, tile %d, resident %d, GPUs %d\n", c.points,
              c.influences, c.bits, c.drilling, c.tile, c.resident, c.gpus);
  TileSolverSettings settings{c.bits == 32 ? TileConstants::float32 : TileConstants::float64, c.resident != 0, c.tile};
  int devices = 0;
  tile::check(cudaGetDeviceCount(&devices), "counting GPUs");
  for (int i = 0; i < c.gpus && c.gpus > 1; ++i) settings.devices.push_back(i % devices);
  const auto solver = TileSolver::make(problem.points, settings, pool);
  if (solver == nullptr) {
    std::printf("  refused\n");
    return;
  }
  const TileLayout& layout = solver->layout();
  std::printf("  %d frames, %d tiles of %d, at most %d frames a tile, %.2f partials a frame, %s\n", layout.frame_count,
              layout.tile_count, layout.tile_size, layout.most_frames,
              static_cast<double>(layout.slot_count()) / layout.frame_count,
              solver->resident() ? "one launch" : "two kernels");
  Device device(problem);
  solver->set_node_blocks(device.blocks.get());
  solver->linearize(device.u.get(), device.D.get(), Tangent::full, 0);
  if (c.points <= kMostChecked) {
    const TileReference reference(problem);
    check_results(*solver, reference, problem, device);
    if (c.points <= kMostSolved) {
      check_residuals(*solver, reference, problem, device, false, pool);
      solver->build_preconditioner();
      check_residuals(*solver, reference, problem, device, true, pool);
      solver->clear_preconditioner();
    }
  }
  const CgOptions options{kIterations, 0};
  const int runs = c.points <= 1'100'000 ? 21 : 5;
  const CgReport report = solver->solve(device.b.get(), device.x.get(), options);
  const std::vector<double> first = device.x.download();
  solver->solve(device.b.get(), device.x.get(), options);
  const std::vector<double> second = device.x.download();
  const bool same = std::memcmp(first.data(), second.data(), first.size() * sizeof(double)) == 0;
  const double plain = milliseconds(runs, [&] { solver->start_solve(device.b.get(), device.x.get(), options); });
  const double product = milliseconds(runs, [&] { solver->multiply(device.b.get(), device.y.get()); });
  const double forces =
      milliseconds(runs, [&] { solver->forces(device.u.get(), device.D.get(), 0, device.y.get(), nullptr); });
  const double linearize =
      milliseconds(runs, [&] { solver->linearize(device.u.get(), device.D.get(), Tangent::full, 0); });
  const double jacobi = milliseconds(runs, [&] { solver->build_preconditioner(); });
  const double preconditioned =
      milliseconds(runs, [&] { solver->start_solve(device.b.get(), device.x.get(), options); });
  const CgReport better = solver->finish_solve();
  std::printf("  two runs %s; |r|^2 %.2e plain, %.2e block-Jacobi after %d, %d\n", same ? "alike" : "DIFFER",
              std::pow(report.relative_residual, 2), std::pow(better.relative_residual, 2), report.iterations,
              better.iterations);
  std::printf(
      "RESULT %d K%d fp%d drill%d tile%d %s GPUs %d: 60 its %.3f ms, block-Jacobi %.3f; product %.4f, forces %.4f, "
      "linearize %.4f, build block-Jacobi %.4f\n",
      c.points, c.influences, c.bits, c.drilling, layout.tile_size, solver->resident() ? "one" : "two", c.gpus, plain,
      preconditioned, product, forces, linearize, jacobi);
  std::fflush(stdout);
}

Case parse(const char* text) {
  Case c;
  std::sscanf(text, "%d:%d:%d:%d:%d:%d:%d", &c.points, &c.influences, &c.bits, &c.drilling, &c.tile, &c.resident,
              &c.gpus);
  return c;
}

int run_all(int argc, char** argv) {
  std::vector<Case> cases;
  for (int i = 1; i < argc; ++i) cases.push_back(parse(argv[i]));
  if (cases.empty())
    for (const int points : {360, 6'070, 34'610, 300'000, 1'000'000, 3'000'000, 10'000'000})
      for (const int influences : {4, 8}) cases.push_back({points, influences, 64, 0, 0, 1});
  ThreadPool pool(0);
  TileProblem problem;
  Case last;
  for (const Case& c : cases) {
    if (c.points != last.points || c.influences != last.influences || c.drilling != last.drilling)
      problem = make_problem(c.points, c.influences, c.drilling != 0 ? 0.5 : 1.0, c.drilling != 0 ? 0.1 : 0.0, pool);
    last = c;
    run(c, problem, pool);
  }
  return 0;
}

}  // namespace
}  // namespace fascia::bench

int main(int argc, char** argv) {
  try {
    return fascia::bench::run_all(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
