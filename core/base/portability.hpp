#pragma once

/// Marks a function that also compiles for the GPU.
#if defined(__CUDACC__)
#define FASCIA_HD __host__ __device__
#else
#define FASCIA_HD
#endif

namespace fascia {

/// Tells the processor that this thread looks at memory until another one writes there.
inline void wait_a_moment() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("isb");
#endif
}

}  // namespace fascia
