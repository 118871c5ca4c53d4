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
/// One instruction this way; GCC 12 makes five of __builtin_convertvector.
inline Four load_four(const float* p) { return Four{p[0], p[1], p[2], p[3]}; }
inline void store_four(const Four& value, double* to) { std::memcpy(to, &value, sizeof value); }

}  // namespace fascia
