#pragma once

#include "core/math/batch.hpp"

#include <cstring>

/// Four numbers of 64 bits in a register, from anywhere in memory.
namespace fascia {

using Four = BatchRegister<4>::Type;

inline Four load_four(const double* p) {
  Four r;
  std::memcpy(&r, p, sizeof r);
  return r;
}
inline Four load_four(const float* p) {
  float r __attribute__((vector_size(16)));
  std::memcpy(&r, p, sizeof r);
  return __builtin_convertvector(r, Four);
}
inline void store_four(const Four& value, double* to) { std::memcpy(to, &value, sizeof value); }

}  // namespace fascia
