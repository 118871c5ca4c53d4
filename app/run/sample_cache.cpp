#include "app/run/sample_cache.hpp"

#include "app/machine.hpp"
#include "core/base/errors.hpp"
#include "io/digest.hpp"
#include "io/files.hpp"

#include <algorithm>
#include <system_error>
#include <vector>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostBytes = 1'000'000'000;
constexpr const char* kKind = ".samples";
/// Sampling that takes less is not kept [s].
constexpr double kShort = 0.02;

/// The oldest files go, until half of what may be there is left.
void drop_old(const fs::path& folder) {
  struct Kept {
    fs::file_time_type time;
    std::uintmax_t size = 0;
    fs::path path;
  };
  std::error_code none;
  std::vector<Kept> files;
  std::uintmax_t all = 0;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    if (entry.path().extension() != kKind) continue;
    files.push_back({entry.last_write_time(none), entry.file_size(none), entry.path()});
    all += files.back().size;
  }
  if (all <= kMostBytes) return;
  std::sort(files.begin(), files.end(), [](const Kept& a, const Kept& b) { return a.time < b.time; });
  for (const Kept& file : files) {
    if (all <= kMostBytes / 2) return;
    fs::remove(file.path, none);
    all -= file.size;
  }
}

}  // namespace

SampleCache::SampleCache(const Output& output) {
  if (!output.keeps_samples) return;
  const fs::path own = cache_folder();
  folder_ = !output.cache.empty() ? output.cache : own.empty() ? own : own / "samples";
  if (!folder_.empty()) origin_ = stamp_of_program("libfascia");
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
} catch (const FileError&) {
  return std::nullopt;
}

bool SampleCache::wants(double seconds) const { return !folder_.empty() && seconds > kShort; }

void SampleCache::keep(std::string_view description, std::string_view bytes) const try {
  io::make_directories(folder_);
  drop_old(folder_);
  io::replace_file(file_of(description), io::sha256(bytes) + std::string(bytes));
} catch (const FileError&) {
  return;
}

}  // namespace fascia::app
