#include "app/heap.hpp"

#include <cstdlib>

namespace fascia::app {

void keep_freed_memory() {
  constexpr std::size_t block = 4U << 20U;
  void* volatile mapped = std::malloc(block);
  std::free(mapped);
}

}  // namespace fascia::app
