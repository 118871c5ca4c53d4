#include "app/bench/machine_limits.hpp"

#include "app/run/process_memory.hpp"
#include "core/base/aligned.hpp"
#include "core/base/clock.hpp"
#include "core/math/across_lanes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <set>
#include <string>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

/// Independent chains of multiply and add: two units of latency four are busy with eight.
constexpr int kChains = 12;
constexpr long kRounds = 1'000'000;
/// Bytes that a thread reads in a trial: a millisecond, so that some trials are not interrupted by other programs.
constexpr double kTrialBytes = 1.0 * (1 << 25);
/// Trials beyond the fewest that are asked for: within so many seconds for each of these, up to so many times.
constexpr double kTrialSeconds = 0.008;
constexpr int kMoreTrials = 8;
/// Largest working set: so many times the last cache, within these limits [bytes].
constexpr double kTimesCache = 4, kSmallestLimit = 1.0 * (1 << 26), kLargestLimit = 1.0 * (1 << 30);
/// Halves of a thread's share are whole multiples of so many numbers, so that all loops take all of them.
constexpr std::size_t kMultiple = 64;

/// Keeps a result that nobody reads.
thread_local volatile double sink = 0;
/// A factor that the compiler does not know.
volatile double unknown = 1e-6;

std::string line_of(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

/// Some streams side by side: one alone does not keep the memory busy.
double sum_of(const double* begin, std::size_t count) {
  constexpr std::size_t kStreams = 4, kAtOnce = 2, kStep = kAtOnce * kBatchWidth;
  const std::size_t length = count / kStreams;
  std::array<Lanes, kStreams * kAtOnce> sums;
  for (std::size_t i = 0; i + kStep <= length; i += kStep)
    for (std::size_t s = 0; s < kStreams; ++s)
      for (std::size_t k = 0; k < kAtOnce; ++k)
        sums[kAtOnce * s + k] += Lanes::load(begin + s * length + i + k * kBatchWidth);
  double sum = 0;
  for (const Lanes& s : sums) sum += lane_sum(s);
  return sum;
}

void update(double factor, const double* x, double* y, std::size_t count) {
  constexpr std::size_t kAtOnce = 4, kStep = kAtOnce * kBatchWidth;
  const Lanes a(factor);
  for (std::size_t i = 0; i + kStep <= count; i += kStep)
    for (std::size_t k = i; k < i + kStep; k += kBatchWidth) (Lanes::load(y + k) + a * Lanes::load(x + k)).store(y + k);
}

double multiply_and_add(long rounds) {
  std::array<Lanes, kChains> chain;
  for (int k = 0; k < kChains; ++k) chain[static_cast<std::size_t>(k)] = Lanes(1.0 + k);
  const Lanes a(1.0 - 1e-9), b(1e-9);
  for (long r = 0; r < rounds; ++r)
    for (Lanes& y : chain) y = a * y + b;
  double sum = 0;
  for (const Lanes& y : chain) sum += lane_sum(y);
  return sum;
}

}  // namespace

double last_level_cache() {
  const fs::path root = "/sys/devices/system/cpu";
  int last = 0;
  double bytes = 0;
  std::set<std::string> seen;  // processors that share one
  std::error_code none;
  for (int cpu = 0; fs::exists(root / ("cpu" + std::to_string(cpu)) / "cache", none); ++cpu)
    for (int i = 0; i < 8; ++i) {
      const fs::path cache = root / ("cpu" + std::to_string(cpu)) / "cache" / ("index" + std::to_string(i));
      const int level = std::atoi(line_of(cache / "level").c_str());
      if (level < std::max(last, 1)) continue;
      if (level > last) {
        last = level;
        bytes = 0;
        seen.clear();
      }
      const std::string size = line_of(cache / "size");  // "32768K"
      if (!seen.insert(line_of(cache / "shared_cpu_list")).second) continue;
      bytes += std::atof(size.c_str()) * (size.ends_with('M') ? 1048576.0 : size.ends_with('K') ? 1024.0 : 1.0);
    }
  return bytes;
}

MachineLimits::MachineLimits(ThreadPool& pool, int trials) : pool_(pool), trials_(trials) {
  const double wanted = std::clamp(kTimesCache * last_level_cache(), kSmallestLimit, kLargestLimit);
  largest_ = std::exp2(std::floor(2 * std::log2(std::min(wanted, free_memory().bytes / 4))) / 2);
  flops_ = measure_flops();
}

template <class Work>
double MachineLimits::best_seconds(const Work& work) {
  double best = std::numeric_limits<double>::infinity();
  const Clock::time_point begin = Clock::now();
  for (int trial = 0; trial < trials_ * kMoreTrials; ++trial) {
    if (trial >= trials_ && seconds_since(begin) > kTrialSeconds * trials_) break;
    const Clock::time_point start = Clock::now();
    pool_.for_chunks(threads(), work);
    best = std::min(best, seconds_since(start));
  }
  return best;
}

double MachineLimits::measure_flops() {
  const double seconds = best_seconds([](int) { sink = multiply_and_add(kRounds); });
  return 2.0 * kChains * kBatchWidth * static_cast<double>(kRounds) * threads() / seconds;
}

/// Halves of a thread's share are copied one onto the other.
MemoryRates MachineLimits::measure(std::size_t doubles) {
  const std::size_t of_thread = doubles / static_cast<std::size_t>(threads());
  const std::size_t half = std::max<std::size_t>(of_thread / 2 / kMultiple, 1) * kMultiple, share = 2 * half;
  const double bytes = static_cast<double>(share * sizeof(double));
  const int passes = std::max(1, static_cast<int>(kTrialBytes / bytes));
  const auto release = [](double* p) { AlignedAllocator<double>().deallocate(p, 0); };
  const std::unique_ptr<double, decltype(release)> room(  // untouched, so that pages lie near who touches them first
      AlignedAllocator<double>().allocate(share * static_cast<std::size_t>(threads())), release);
  const auto share_of = [&](int thread) { return room.get() + static_cast<std::size_t>(thread) * share; };
  pool_.for_chunks(threads(), [&](int t) { std::fill_n(share_of(t), share, 1.0); });
  const double reading = best_seconds([&](int t) {
    for (int pass = 0; pass < passes; ++pass) sink = sum_of(share_of(t), share);
  });
  const double copying = best_seconds([&](int t) {
    for (int pass = 0; pass < passes; ++pass) {
      std::memcpy(share_of(t), share_of(t) + half, half * sizeof(double));
      asm volatile("" ::: "memory");  // each copy counts
    }
  });
  const double updating = best_seconds([&](int t) {
    for (int pass = 0; pass < passes; ++pass) update(unknown, share_of(t), share_of(t) + half, half);
  });
  const double all = bytes * passes * threads();
  return {all / reading, all / copying, 1.5 * all / updating};
}

const MemoryRates& MachineLimits::memory(double bytes) {
  const double least = static_cast<double>(2 * kMultiple * sizeof(double)) * threads();
  const double size = std::exp2(std::round(2 * std::log2(std::clamp(bytes, least, largest_))) / 2);
  const double key = std::min(size, largest_);
  const auto known = rates_.find(key);
  if (known != rates_.end()) return known->second;
  return rates_.emplace(key, measure(static_cast<std::size_t>(key) / sizeof(double))).first->second;
}

}  // namespace fascia::app
