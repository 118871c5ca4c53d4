#pragma once

#include <cstdlib>

namespace fascia::test {

/// How many random cases a test runs: as ctest says in FASCIA_CASES, else `by_hand`.
inline int cases(int by_hand) {
  const char* said = std::getenv("FASCIA_CASES");
  return said == nullptr ? by_hand : std::atoi(said);
}

}  // namespace fascia::test
