#pragma once

#include <cstdlib>

namespace fascia::test {

/// How many random cases a test runs: as ctest says in FASCIA_CASES, else `by_hand`.
inline int cases(int by_hand) {
  const char* said = std::getenv("FASCIA_CASES");
  return said == nullptr ? by_hand : std::atoi(said);
}

/// True where a test that takes long runs in its full size (ctest says FASCIA_FULL: ./check --all), not as a coarser
/// twin.
inline bool full_size() { return std::getenv("FASCIA_FULL") != nullptr; }

}  // namespace fascia::test
