#pragma once

#include "app/bench/benchmark.hpp"
#include "app/bench/machine_limits.hpp"
#include "app/bench/traffic.hpp"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// Kernels of the processor, timed one by one.
namespace fascia::app {

/// Times of calls [s]: the median, and between which times four of five lie.
struct CallTimes {
  int calls = 0;
  double median = 0, low = 0, high = 0;
};
CallTimes times_of(std::vector<double> seconds);

/// A kernel of a case on some threads.
struct KernelRow {
  std::string name, body;  ///< of the case
  double points = 0;       ///< integration points; triangles of shells
  int nodes = 0, unknowns = 0;
  std::string kernel, item;  ///< time is told by item: "point", "block", "unknown", or "step"
  double items = 1;
  int threads = 1;
  CallTimes time;                  ///< [s]
  std::optional<Traffic> traffic;  ///< none: it is not counted
  double memory_seconds = 0;       ///< the least that the traffic takes: MemoryRates::seconds()
  double flop_seconds = 0;         ///< likewise its operations; 0 where they are not counted
  double copy_rate = 0;            ///< of the main memory with these threads [bytes/s]
  double error = 0;                ///< relative difference from another way to the same numbers
  std::optional<bool> bits_equal;  ///< results are those of the first number of threads, bit for bit
  std::string growth;              ///< "strong": the same on all numbers of threads; "weak": as many points a thread
  /// Points a second by those on the first number of threads, and this by how many times as many threads there are.
  std::optional<double> speed_up, efficiency;

  double limit_seconds() const { return memory_seconds > flop_seconds ? memory_seconds : flop_seconds; }
  /// Part of the time that the machine would take at its limit.
  double fraction() const { return limit_seconds() / time.median; }
};

/// Threads with the limits of the machine for as many.
struct Team {
  Team(int threads, int trials) : pool(threads), limits(pool, trials) {}
  ThreadPool pool;
  MachineLimits limits;
};
using Teams = std::vector<std::unique_ptr<Team>>;
using SomeTeams = std::span<const std::unique_ptr<Team>>;

/// @param repeat  as BenchOptions::repeat: trials of the machine's rates too, where they are fewer
Teams make_teams(const std::vector<int>& threads, int repeat, const Teller& say);

/// Times all kernels of a case on each team: forces, linearisation, product without a matrix, assembly, product with
/// it, and what CG does with vectors. All see a bent state with the full tangent, and one direction. Rows of a kernel
/// follow one another. The errors are: forces, from the gradient and from balance; linearisation to assembled product,
/// of the products with and without a matrix; vectors, from a plain loop.
std::vector<KernelRow> time_kernels(const BenchmarkCase& c, const Simulation& simulation, SomeTeams teams, int repeat,
                                    const Teller& say);

/// Rows that such a benchmark found.
struct KernelResult {
  std::string name, title, notes;
  std::vector<KernelRow> rows;
  std::vector<SkippedCase> skipped;
  double load = 0;  ///< of the machine before it began
};

/// Kinds of bodies that have kernels of their own.
enum class KernelBody { grid, scattered4, scattered8, tetrahedra, hexahedra, shells };

/// A body of about so many integration points, of shells triangles. Beams are those of table 3 in the paper's setting,
/// with five scattered points a frame. @param prefix  of the name
BenchmarkCase body_case(const std::string& prefix, KernelBody body, int points);

/// Refuses options that go with whole steps alone. @throws InputError
void refuse_options_of_steps(const Benchmark& benchmark, const BenchOptions& options);

/// Says that threads share processors, where they do; otherwise empty.
std::string shared_processors(int threads);

/// Mean number of programs that wanted to run in the last minute.
double load_of_machine();

}  // namespace fascia::app
