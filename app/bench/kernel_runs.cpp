#include "app/bench/kernel_runs.hpp"

#include "core/base/clock.hpp"
#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "core/base/processors.hpp"
#include "core/linear/vectors.hpp"
#include "core/math/rotation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <utility>

namespace fascia::app {
namespace {

/// Calls that are timed, unless the options say how many: those of some time [s], within these numbers.
constexpr double kSeconds = 0.1;
constexpr int kFewest = 5, kMost = 1000;
/// CG multiplies vectors with this number, which is small, so that repeated updates stay finite.
constexpr double kStep = 1e-3;

CallTimes time_calls(const std::function<void()>& call, int repeat) {
  call();  // warms up
  std::vector<double> seconds;
  const int most = repeat > 0 ? repeat : kMost;
  seconds.reserve(at(most));
  const Clock::time_point begin = Clock::now();
  while (static_cast<int>(seconds.size()) < most) {
    if (repeat == 0 && seconds.size() >= kFewest && seconds_since(begin) > kSeconds) break;
    const Clock::time_point start = Clock::now();
    call();
    seconds.push_back(seconds_since(start));
  }
  return times_of(std::move(seconds));
}

/// Largest difference, by the largest number of the second.
double difference(std::span<const double> a, std::span<const double> b) {
  double apart = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    apart = std::max(apart, std::abs(a[i] - b[i]));
    size = std::max(size, std::abs(b[i]));
  }
  return size > 0 ? apart / size : apart;
}

/// A number that other bits do not have (FNV-1a, by words).
class Bits {
 public:
  template <class Array>
  Bits& add(const Array& array) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(array.data());
    for (std::size_t i = 0; i + sizeof(std::uint64_t) <= array.size() * sizeof(array[0]); i += sizeof(std::uint64_t)) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes + i, sizeof word);
      hash_ = (hash_ ^ word) * 0x100000001b3;
    }
    return *this;
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325;
};

/// A smooth bend, by a hundredth of the model's length, with turned frames.
State bent(const Simulation& s) {
  State state = s.initial;
  const std::vector<Vec3d>& X = s.model.rest_position;
  double length = 0;
  for (const Vec3d& x : X) length = std::max(length, norm(x - X.front()));
  for (std::size_t i = 0; i < X.size(); ++i) {
    Vec3d turn;
    for (int k = 0; k < 3; ++k) {
      const double along = 3 * X[i][(k + 1) % 3] / length;
      state.u[i][k] = 0.01 * length * std::sin(1 + k + along);
      turn[k] = 0.05 * std::sin(2 + k + along);
    }
    state.D[i] = rotation_increment(turn);
  }
  return state;
}

/// A piece of work that is timed, and how a first call of it is judged.
struct Kernel {
  const char *name, *item;
  double items;
  std::function<void()> call;
  std::function<Traffic()> traffic;
  std::function<double()> error;
  std::function<std::uint64_t()> bits;
};

/// The arrays that kernels of a case work on, with the threads of a pool.
class Bench {
 public:
  Bench(const Simulation& s, const TrafficCount& count, ThreadPool& pool, BlockMatrix& matrix)
      : count_(count),
        pool_(pool),
        matrix_(matrix),
        vectors_(pool),
        executor_(s.model.points, pool),
        state_(bent(s)),
        gradient_(at(s.model.dof_count())),
        forces_(gradient_),
        x_(gradient_),
        product_(gradient_),
        assembled_(gradient_) {
    for (std::size_t i = 0; i < x_.size(); ++i) x_[i] = std::sin(0.7 * static_cast<double>(i));
    executor_.gradient(state_, {}, gradient_);
    solution_ = x_;
    residual_ = gradient_;
  }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  /// In an order in which each finds what those before it left.
  std::vector<Kernel> kernels();

 private:
  double unbalanced() const;
  double error_of_axpy() const;
  double error_of_dot() const;

  const TrafficCount& count_;
  ThreadPool& pool_;
  BlockMatrix& matrix_;
  CpuVectors vectors_;
  CpuExecutor executor_;
  State state_;
  Linearization lin_;
  std::vector<double> gradient_, forces_, x_, product_, assembled_, solution_, residual_;
  std::array<double, 1> dot_{};
};

/// |Σ force| by Σ |force|: internal forces move nothing as a whole.
double Bench::unbalanced() const {
  Vec3d sum;
  double size = 0;
  const DofLayout& dofs = matrix_.dofs();
  for (int node = 0; node < dofs.node_count(); ++node) {
    const double* f = forces_.data() + dofs.begin(node);
    const Vec3d force{{f[0], f[1], f[2]}};
    sum += force;
    size += norm(force);
  }
  return size > 0 ? norm(sum) / size : 0;
}

double Bench::error_of_dot() const {
  long double sum = 0, size = 0;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const long double term = static_cast<long double>(x_[i]) * product_[i];
    sum += term;
    size += std::abs(term);
  }
  return static_cast<double>(std::abs(sum - dot_[0]) / size);
}

/// After one call.
double Bench::error_of_axpy() const {
  std::vector<double> x = x_, r = gradient_;
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] += kStep * gradient_[i];
    r[i] -= kStep * product_[i];
  }
  return std::max(difference(solution_, x), difference(residual_, r));
}

std::vector<Kernel> Bench::kernels() {
  const double points = count_.points(), unknowns = static_cast<double>(x_.size());
  const double blocks = static_cast<double>(matrix_.fills_upper() ? (matrix_.block_count() + at(matrix_.rows())) / 2
                                                                  : matrix_.block_count());
  const auto both_products = [this] { return difference(product_, assembled_); };
  const auto bits_of = [](const auto& array) { return [&array] { return Bits().add(array).value(); }; };
  std::vector<Kernel> all;
  all.push_back({"forces", "point", points, [this] { executor_.forces(state_, {}, forces_); },
                 [this] { return count_.forces(); },
                 [this] { return std::max(difference(forces_, gradient_), unbalanced()); }, bits_of(forces_)});
  all.push_back(
      {"linearisation", "point", points, [this] { executor_.linearize(state_, {}, Tangent::full, lin_); },
       [this] { return count_.linearization(lin_); }, both_products,
       [this] { return Bits().add(lin_.Q).add(lin_.node_blocks).add(lin_.u).add(lin_.D).add(lin_.kept).value(); }});
  all.push_back({"product", "point", points, [this] { executor_.multiply(lin_, x_, product_); },
                 [this] { return count_.product(lin_); }, both_products, bits_of(product_)});
  all.push_back({"assembly", "point", points, [this] { executor_.assemble(lin_, matrix_); },
                 [this] { return count_.assembly(lin_, matrix_); }, both_products,
                 [this] { return Bits().add(std::span(matrix_.values(), matrix_.value_count())).value(); }});
  all.push_back({"assembled product", "block", blocks, [this] { matrix_.multiply(pool_, x_, assembled_); },
                 [this] { return assembled_product_traffic(matrix_); }, both_products, bits_of(assembled_)});
  all.push_back({"dot", "unknown", unknowns, [this] { dot_[0] = vectors_.dot(x_, product_); },
                 [this] { return dot_traffic(x_.size()); }, [this] { return error_of_dot(); }, bits_of(dot_)});
  all.push_back({"axpy", "unknown", unknowns,
                 [this] { vectors_.advance(kStep, gradient_, product_, solution_, residual_); },
                 [this] { return axpy_traffic(x_.size()); }, [this] { return error_of_axpy(); },
                 [this] { return Bits().add(solution_).add(residual_).value(); }});
  return all;
}

KernelRow row_of(const BenchmarkCase& c, const Simulation& s, const Kernel& kernel, double points) {
  KernelRow row;
  row.name = c.name;
  row.body = c.body;
  row.points = points;
  row.nodes = s.model.node_count();
  row.unknowns = s.model.dof_count();
  row.kernel = kernel.name;
  row.item = kernel.item;
  row.items = kernel.items;
  return row;
}

}  // namespace

CallTimes times_of(std::vector<double> seconds) {
  if (seconds.empty()) return {};
  std::sort(seconds.begin(), seconds.end());
  const std::size_t last = seconds.size() - 1;
  return {static_cast<int>(seconds.size()), seconds[seconds.size() / 2], seconds[last / 10], seconds[last - last / 10]};
}

Teams make_teams(const std::vector<int>& threads, int repeat, const Teller& say) {
  constexpr int kTrials = 7;
  Teams teams;
  teams.reserve(threads.size());
  for (const int count : threads) {
    say(fmt::format("rates of the machine, threads: {}", count));
    teams.push_back(std::make_unique<Team>(count, repeat > 0 ? std::min(repeat, kTrials) : kTrials));
    teams.back()->limits.main_memory();
  }
  return teams;
}

std::vector<KernelRow> time_kernels(const BenchmarkCase& c, const Simulation& simulation, SomeTeams teams, int repeat,
                                    const Teller& say) {
  const TrafficCount count(simulation.model.points);
  BlockMatrix matrix(simulation.model.points, simulation.model.surfaces);
  std::vector<std::vector<KernelRow>> by_kernel;
  std::vector<std::uint64_t> first_bits;
  for (const std::unique_ptr<Team>& team : teams) {
    say(fmt::format("{}: kernels, threads: {}", c.name, team->pool.size()));
    Bench bench(simulation, count, team->pool, matrix);
    const std::vector<Kernel> kernels = bench.kernels();
    for (const Kernel& kernel : kernels) kernel.call();
    by_kernel.resize(kernels.size());
    for (std::size_t k = 0; k < kernels.size(); ++k) {
      KernelRow row = row_of(c, simulation, kernels[k], count.points());
      row.threads = team->pool.size();
      row.error = kernels[k].error();
      if (first_bits.size() == k) first_bits.push_back(kernels[k].bits());
      row.bits_equal = kernels[k].bits() == first_bits[k];
      by_kernel[k].push_back(std::move(row));
    }
    for (std::size_t k = 0; k < kernels.size(); ++k) {
      KernelRow& row = by_kernel[k].back();
      row.time = time_calls(kernels[k].call, repeat);
      const Traffic traffic = kernels[k].traffic();
      row.memory_seconds = team->limits.memory(traffic.working_set()).seconds(traffic.read, traffic.written);
      row.flop_seconds = traffic.flops.value_or(0) / team->limits.flops();
      row.copy_rate = team->limits.main_memory().copy;
      row.traffic = traffic;
    }
  }
  std::vector<KernelRow> rows;
  rows.reserve(by_kernel.size() * teams.size());
  for (std::vector<KernelRow>& of_kernel : by_kernel)
    for (KernelRow& row : of_kernel) rows.push_back(std::move(row));
  return rows;
}

void refuse_options_of_steps(const Benchmark& benchmark, const BenchOptions& options) {
  const auto refuse = [&](const char* option) {
    throw InputError(
        fmt::format("{}: {} has none, since it times the processor's kernels; leave it out", option, benchmark.name));
  };
  if (options.backend == "cuda") refuse("--backend cuda");
  if (options.gpus != std::vector<int>{1}) refuse("--gpus");
  if (options.settings != "both") refuse("--settings");
}

std::string shared_processors(int threads) {
  const int processors = available_processors();
  if (threads <= processors) return "";
  return fmt::format("{} threads share {} processor{}: they wait for one another. ", threads, processors,
                     processors == 1 ? "" : "s");
}

double load_of_machine() {
  double load = 0;
  return getloadavg(&load, 1) == 1 ? load : 0;
}

}  // namespace fascia::app
