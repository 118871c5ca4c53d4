// Arrays begin on 64-byte boundaries; where they are large the system is asked for large pages.
#include "core/base/aligned.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <ios>
#include <sstream>
#include <string>

namespace fascia::aligned_test {
namespace {

/// Flags of the mapping that an address lies in, as /proc/self/smaps has them.
std::string flags_at(const void* address) {
  const auto wanted = reinterpret_cast<std::uintptr_t>(address);
  std::ifstream maps("/proc/self/smaps");
  bool inside = false;
  for (std::string line; std::getline(maps, line);) {
    std::istringstream words(line);
    std::uintptr_t first = 0, last = 0;
    char dash = 0;
    if (words >> std::hex >> first >> dash >> last && dash == '-') inside = first <= wanted && wanted < last;
    if (inside && line.starts_with("VmFlags:")) return line;
  }
  return {};
}

TEST(AlignedVectors, BeginOnWholeLinesOfTheCache) {
  for (const std::size_t n : {1U, 7U, 1000U, 3000000U})
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(AlignedVector<double>(n).data()) % 64, 0U) << n;
}

TEST(AlignedVectors, AskForLargePagesWhereTheyAreLarge) {
  if (!std::filesystem::exists("/sys/kernel/mm/transparent_hugepage/enabled"))
    GTEST_SKIP() << "this system has no large pages that a program may ask for";
  constexpr std::size_t kNumbers = std::size_t{4} << 20;  // 32 MB, of which the middle is in large pages in any case
  const AlignedVector<double> large(kNumbers);
  const std::string flags = flags_at(large.data() + kNumbers / 2);
  if (flags.empty()) GTEST_SKIP() << "/proc/self/smaps tells no flags";
  EXPECT_NE((flags + ' ').find(" hg "), std::string::npos) << flags;
}

}  // namespace
}  // namespace fascia::aligned_test
