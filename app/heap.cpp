#include "app/heap.hpp"

#include <malloc.h>

namespace fascia::app {

void keep_freed_memory() {
  constexpr int kMegabyte = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, 32 * kMegabyte);  // the most that there is
  mallopt(M_TRIM_THRESHOLD, 64 * kMegabyte);
}

}  // namespace fascia::app
