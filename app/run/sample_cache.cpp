#include "app/run/sample_cache.hpp"

#include "app/cache.hpp"
#include "io/digest.hpp"
#include "io/files.hpp"

#include <stdexcept>
#include <system_error>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostBytes = 1'000'000'000;
constexpr const char* kKind = ".samples";
/// Sampling that takes less is not kept [s].
constexpr double kShort = 0.02;

}  // namespace

SampleCache::SampleCache(const Output& output) {
  if (!output.keeps_samples) return;
  const fs::path own = cache_folder();
  origin_ = stamp_of_program("libfascia");
  if (origin_.empty()) return;
  folder_ = !output.cache.empty() ? output.cache : own.empty() ? own : own / "samples";
}

fs::path SampleCache::file_of(std::string_view description) const {
  return folder_ / (io::sha256(origin_ + std::string(description)).substr(0, 32) + kKind);
}

/// A file begins with the digest of the rest: one that was cut off or damaged is none.
std::optional<std::string> SampleCache::find(std::string_view description) const try {
  if (folder_.empty()) return std::nullopt;
  const fs::path file = file_of(description);
  std::error_code none;
  if (!fs::exists(file, none)) return std::nullopt;
  const std::string all = io::read_file(file);
  constexpr std::size_t digest = 64;
  if (all.size() < digest || io::sha256(std::string_view(all).substr(digest)) != all.substr(0, digest))
    return std::nullopt;
  fs::last_write_time(file, fs::file_time_type::clock::now(), none);  // the oldest is that which was not used longest
  return all.substr(digest);
} catch (const std::runtime_error&) {
  return std::nullopt;  // empty, or gone meanwhile
}

bool SampleCache::wants(double seconds) const { return !folder_.empty() && seconds > kShort; }

void SampleCache::keep(std::string_view description, std::string_view bytes) const try {
  keep_in_cache(file_of(description), io::sha256(bytes) + std::string(bytes), kMostBytes);
} catch (const std::runtime_error&) {
  return;  // the next run makes them again
}

}  // namespace fascia::app
