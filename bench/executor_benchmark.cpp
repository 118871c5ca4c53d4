#include "core/executor/executor.hpp"
#include "tests/support/models.hpp"

#include <benchmark/benchmark.h>

/// Passes over the points of a bent block, one thread. Counters: integration points a second, and bytes of a memory
/// copy a second as the yardstick of the machine in the same run.
namespace fascia {
namespace {

struct Case {
  explicit Case(int n)
      : built(test::block({.grid = {n, n, n}})),
        executor(built.model.points, pool),
        state(test::random_state(built.model, 1e-3, 0.1)),
        gradient(static_cast<std::size_t>(built.model.dof_count())),
        direction(test::random_direction(built.model)) {
    executor.gradient(state, {}, gradient);
    executor.linearize(state, {}, Tangent::full, tangent);
  }
  void count(benchmark::State& run) const {
    run.counters["points/s"] =
        benchmark::Counter(built.model.points.point_count, benchmark::Counter::kIsIterationInvariantRate);
  }

  test::BuiltModel built;
  ThreadPool pool{1};
  CpuExecutor executor;
  State state;
  std::vector<double> gradient, direction;
  Linearization tangent;
};

void gradient(benchmark::State& run) {
  Case c(static_cast<int>(run.range(0)));
  for (auto _ : run) benchmark::DoNotOptimize(c.executor.gradient(c.state, {}, c.gradient));
  c.count(run);
}

void matrix_free_product(benchmark::State& run) {
  Case c(static_cast<int>(run.range(0)));
  for (auto _ : run) c.executor.multiply(c.tangent, c.direction, c.gradient);
  c.count(run);
}

void assembly(benchmark::State& run) {
  Case c(static_cast<int>(run.range(0)));
  BlockMatrix matrix(c.built.model.points);
  for (auto _ : run) c.executor.assemble(c.tangent, matrix);
  c.count(run);
}

void assembled_product(benchmark::State& run) {
  Case c(static_cast<int>(run.range(0)));
  BlockMatrix matrix(c.built.model.points);
  c.executor.assemble(c.tangent, matrix);
  for (auto _ : run) matrix.multiply(c.pool, c.direction, c.gradient);
  c.count(run);
}

void memory_copy(benchmark::State& run) {
  std::vector<double> from(1 << 23, 1.0), to(1 << 23);
  for (auto _ : run) {
    std::copy(from.begin(), from.end(), to.begin());
    benchmark::ClobberMemory();
  }
  run.SetBytesProcessed(run.iterations() * static_cast<std::int64_t>(from.size() * sizeof(double) * 2));
}

BENCHMARK(memory_copy);
BENCHMARK(gradient)->Arg(9)->Arg(17)->Unit(benchmark::kMicrosecond);
BENCHMARK(matrix_free_product)->Arg(9)->Arg(17)->Unit(benchmark::kMicrosecond);
BENCHMARK(assembly)->Arg(9)->Arg(17)->Unit(benchmark::kMicrosecond);
BENCHMARK(assembled_product)->Arg(9)->Arg(17)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace fascia
