#include "app/bench/kernel_report.hpp"
#include "app/bench/kernel_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

namespace fascia::app {
namespace {

/// Weak scaling takes bodies of any size.
constexpr std::array kBodies{KernelBody::grid, KernelBody::tetrahedra, KernelBody::scattered4};
constexpr std::array kWeakBodies{KernelBody::grid, KernelBody::tetrahedra};

/// 1, 2, 4 … and all.
std::vector<int> numbers_of_threads(int all) {
  constexpr std::size_t kDoublings = 31;
  std::vector<int> numbers;
  numbers.reserve(kDoublings + 1);
  for (int threads = 1; threads < all; threads *= 2) numbers.push_back(threads);
  numbers.push_back(all);
  return numbers;
}

/// Whole steps, and CG in them: 60 iterations with what each needs. What the first leaves of the linear system tells
/// whether they did the same.
/// @param like  a row of the case
std::vector<KernelRow> time_steps(const KernelRow& like, const Simulation& simulation, SomeTeams teams, int repeat) {
  StepPlan plan{1, 3, 100, 0.5};
  if (repeat > 0) plan.fewest = plan.most = repeat;
  std::vector<KernelRow> rows;
  rows.reserve(2 * teams.size());
  std::optional<double> residual;
  for (const std::unique_ptr<Team>& team : teams) {
    const StepTimes times = processor(team->pool.size()).run(simulation, plan);
    if (!residual) residual = times.residual;
    const auto add = [&](const char* kernel, std::vector<double> seconds) {
      for (double& s : seconds) s *= 1e-3;
      KernelRow row;
      row.name = like.name;
      row.body = like.body;
      row.points = like.points;
      row.nodes = like.nodes;
      row.unknowns = like.unknowns;
      row.kernel = kernel;
      row.item = "step";
      row.threads = team->pool.size();
      row.time = times_of(std::move(seconds));
      row.error = std::abs(times.residual - *residual) / *residual;
      row.bits_equal = times.residual == *residual;
      rows.push_back(std::move(row));
    };
    add("60 CG iterations", times.cg_ms);
    add("whole step", times.step_ms);
  }
  return rows;
}

/// Rows of a kernel follow one another, with the first number of threads first.
void compare_with_first(std::vector<KernelRow>& rows) {
  const KernelRow* first = nullptr;
  for (KernelRow& row : rows) {
    if (first == nullptr || first->kernel != row.kernel) first = &row;
    row.speed_up = row.points / row.time.median / (first->points / first->time.median);
    row.efficiency = *row.speed_up * first->threads / row.threads;
  }
}

/// Puts rows of a kernel beside one another, in the order of their first.
std::vector<KernelRow> by_kernel(std::vector<KernelRow> rows) {
  std::vector<std::string> order;
  for (const KernelRow& row : rows)
    if (std::ranges::find(order, row.kernel) == order.end()) order.push_back(row.kernel);
  const auto place = [&](const KernelRow& row) { return std::ranges::find(order, row.kernel) - order.begin(); };
  std::ranges::stable_sort(rows, {}, place);
  return rows;
}

class Scaling {
 public:
  Scaling(const BenchOptions& options, SomeTeams teams, KernelResult& result, const Teller& say)
      : options_(options), teams_(teams), result_(result), say_(say) {}

  /// One model on all numbers of threads.
  void strong(const BenchmarkCase& c) { add(times(c, teams_), "strong"); }

  /// Each number of threads gets a model of its own, with as many points a thread. Returns these models.
  std::vector<BenchmarkCase> weak(KernelBody body, int points) {
    std::vector<BenchmarkCase> cases;
    std::vector<KernelRow> rows;
    cases.reserve(teams_.size());
    for (std::size_t t = 0; t < teams_.size(); ++t) {
      cases.push_back(body_case("scaling_weak", body, points * teams_[t]->pool.size()));
      std::ranges::move(times(cases.back(), teams_.subspan(t, 1)), std::back_inserter(rows));
    }
    for (KernelRow& row : rows) row.bits_equal.reset();
    add(std::move(rows), "weak");
    return cases;
  }

 private:
  std::vector<KernelRow> times(const BenchmarkCase& c, SomeTeams teams) {
    say_(fmt::format("{}: building", c.name));
    std::string reason;
    const std::optional<Simulation> simulation = built(c, reason);
    if (!simulation) {
      result_.skipped.push_back({c.name, reason});
      return {};
    }
    std::vector<KernelRow> rows = time_kernels(c, *simulation, teams, options_.repeat, say_);
    say_(fmt::format("{}: steps", c.name));
    std::ranges::move(time_steps(rows.front(), *simulation, teams, options_.repeat), std::back_inserter(rows));
    return rows;
  }
  void add(std::vector<KernelRow> rows, const char* growth) {
    rows = by_kernel(std::move(rows));
    compare_with_first(rows);
    for (KernelRow& row : rows) row.growth = growth;
    std::ranges::move(rows, std::back_inserter(result_.rows));
  }

  const BenchOptions& options_;
  SomeTeams teams_;
  KernelResult& result_;
  const Teller& say_;
};

BenchReport run_scaling(const Benchmark& benchmark, const BenchOptions& options, const Teller& say) {
  refuse_options_of_steps(benchmark, options);
  KernelResult result{benchmark.name, benchmark.title, benchmark.notes, {}, {}, load_of_machine()};
  std::vector<BenchmarkCase> cases = chosen_cases(benchmark, options, result.skipped);
  const std::vector<int> threads = numbers_of_threads(ThreadPool(options.threads).size());
  result.notes = shared_processors(threads.back()) + result.notes;
  const Teams teams = make_teams(threads, options.repeat, say);
  Scaling run(options, teams, result, say);
  std::set<int> sizes;
  for (const BenchmarkCase& c : cases) {
    run.strong(c);
    sizes.insert(c.size);
  }
  for (const KernelBody body : kWeakBodies)
    for (const int size : sizes) std::ranges::move(run.weak(body, size), std::back_inserter(cases));
  return report_of_scaling(result, teams, cases);
}

}  // namespace

Benchmark scaling() {
  Benchmark b{
      "scaling",
      "Scaling of the processor's kernels and steps with the number of threads",
      "Strong: the same model on all numbers of threads. Weak: as many points for each thread. Speed-up: points "
      "a second by those of one thread; efficiency: this by the number of threads. Of copy: GB/s by those of a "
      "copy in main memory on as many threads.",
      100000,
      {},
      100000,
      run_scaling};
  for (const KernelBody body : kBodies)
    for (const int points : {1000, 10000, 100000, 1000000, 10000000}) {
      if (body == KernelBody::scattered4 && points > 1000000) continue;  // sampling would take long
      b.cases.push_back(body_case("scaling", body, points));
    }
  return b;
}

}  // namespace fascia::app
