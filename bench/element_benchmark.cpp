#include "core/executor/executor.hpp"
#include "tests/support/shell_models.hpp"
#include "tests/unit/fem/element_models.hpp"

#include <benchmark/benchmark.h>

/// Passes over a strained block of tetrahedra or hexahedra, one thread: 8 × 11 × 12 or 18 × 18 × 18 cells, of six
/// tetrahedra (6,336 and 34,992) or one hexahedron; and over a bent plate of 5,000 shell triangles. Counters: the time
/// of one element, of one degree of freedom, and bytes a second where memory is what takes the time, to be held against
/// a memory copy in the same run.
namespace fascia {
namespace {

enum Kind : std::int64_t { svk, neo_hookean, corotational, linear, averaged, tet10, hex8, hex20, shell };
constexpr const char* kKindNames[] = {"svk",       "neo-hookean", "corotational", "linear", "averaged",
                                      "tet10 svk", "hex8 svk",    "hex20 svk",    "shell"};

test::ElementOptions options(std::int64_t kind, bool large) {
  test::ElementOptions o;
  if (kind == tet10) o.shape = ElementShape::tet10;
  if (kind == hex8) o.shape = ElementShape::hex8;
  if (kind == hex20) o.shape = ElementShape::hex20;
  if (kind == corotational) o.formulation = ElementFormulation::corotational;
  if (kind == linear) o.formulation = ElementFormulation::linear;
  if (kind == averaged) o.locking = ElementLocking::averaged;
  o.law = kind == neo_hookean ? Law::neo_hookean : Law::st_venant_kirchhoff;
  o.cells = large ? std::array{18, 18, 18} : std::array{8, 11, 12};
  o.distortion = 0;
  return o;
}

Model model_of(std::int64_t kind, bool large) {
  if (kind != shell) return std::move(test::element_model(options(kind, large)).model);
  const auto plate = [](double u, double v) { return Vec3d{{u, v, 0.2 * u * v}}; };
  return std::move(test::shell_model(test::patch_mesh(plate, {50, 50}), {1e4, 0.3, 0.01}).model);
}

/// @param run  its arguments: a Kind, and 1 for the large block
struct Case {
  explicit Case(benchmark::State& run)
      : model(model_of(run.range(0), run.range(1) != 0)),
        executor(model.points, pool),
        state(test::random_state(model, 1e-3, run.range(0) == shell ? 1e-2 : 0)),
        gradient(static_cast<std::size_t>(model.dof_count())),
        direction(test::random_direction(model)) {
    executor.gradient(state, {}, gradient);
    executor.linearize(state, {}, Tangent::full, tangent);
    using Counter = benchmark::Counter;
    const auto flags = static_cast<Counter::Flags>(Counter::kIsIterationInvariantRate | Counter::kInvert);
    const int elements = run.range(0) == shell ? model.points.shells[0].count : model.points.blocks[0].count;
    run.counters["element"] = Counter(elements, flags);       // [s]
    run.counters["dof"] = Counter(model.dof_count(), flags);  // [s]
    run.SetLabel(kKindNames[run.range(0)] + (" " + std::to_string(elements)));
  }

  Model model;
  ThreadPool pool{1};
  CpuExecutor executor;
  State state;
  std::vector<double> gradient, direction;
  Linearization tangent;
};

void forces(benchmark::State& run) {
  Case c(run);
  for (auto _ : run) c.executor.forces(c.state, {}, c.gradient);
}

void gradient(benchmark::State& run) {
  Case c(run);
  for (auto _ : run) benchmark::DoNotOptimize(c.executor.gradient(c.state, {}, c.gradient));
}

void matrix_free_product(benchmark::State& run) {
  Case c(run);
  for (auto _ : run) c.executor.multiply(c.tangent, c.direction, c.gradient);
}

void assembly(benchmark::State& run) {
  Case c(run);
  BlockMatrix matrix(c.model.points);
  for (auto _ : run) c.executor.assemble(c.tangent, matrix);
}

void assembled_product(benchmark::State& run) {
  Case c(run);
  BlockMatrix matrix(c.model.points);
  c.executor.assemble(c.tangent, matrix);
  for (auto _ : run) matrix.multiply(c.pool, c.direction, c.gradient);
  run.SetBytesProcessed(run.iterations() * static_cast<std::int64_t>(matrix.value_count() * sizeof(double)));
}

void memory_copy(benchmark::State& run) {
  std::vector<double> from(1 << 23, 1.0), to(1 << 23);
  for (auto _ : run) {
    std::copy(from.begin(), from.end(), to.begin());
    benchmark::ClobberMemory();
  }
  run.SetBytesProcessed(run.iterations() * static_cast<std::int64_t>(from.size() * sizeof(double) * 2));
}

const std::vector<std::vector<std::int64_t>> kTetrahedra{{svk, neo_hookean, corotational, linear, averaged}, {0, 1}};
const std::vector<std::vector<std::int64_t>> kOthers{{tet10, hex8, hex20, shell}, {0}};

BENCHMARK(memory_copy);
BENCHMARK(forces)->ArgsProduct(kTetrahedra)->ArgsProduct(kOthers)->Unit(benchmark::kMicrosecond);
BENCHMARK(gradient)->ArgsProduct(kTetrahedra)->ArgsProduct(kOthers)->Unit(benchmark::kMicrosecond);
BENCHMARK(matrix_free_product)->ArgsProduct(kTetrahedra)->ArgsProduct(kOthers)->Unit(benchmark::kMicrosecond);
BENCHMARK(assembly)->ArgsProduct(kTetrahedra)->ArgsProduct(kOthers)->Unit(benchmark::kMicrosecond);
BENCHMARK(assembled_product)->Args({svk, 0})->Args({svk, 1})->ArgsProduct(kOthers)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace fascia
