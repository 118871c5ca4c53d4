#include "core/linear/blas.hpp"

#include "core/base/errors.hpp"

#include <dlfcn.h>
#include <sys/mman.h>

#include <cstddef>
#include <vector>

namespace fascia {

void hold_blas_to_one_thread() {
  using Set = void (*)(int);
  if (void* set = dlsym(RTLD_DEFAULT, "openblas_set_num_threads")) reinterpret_cast<Set>(set)(1);
  if (void* set = dlsym(RTLD_DEFAULT, "omp_set_max_active_levels")) reinterpret_cast<Set>(set)(0);
}

namespace {

void take_buffer() {
  constexpr std::size_t kBuffer = std::size_t{130} << 20;  // OpenBLAS' BUFFER_SIZE, and what else its product asks for
  using Update = void (*)(const char*, const char*, const int*, const int*, const double*, const double*, const int*,
                          const double*, double*, const int*);
  void* update = dlsym(RTLD_DEFAULT, "dsyrk_");
  if (update == nullptr || dlsym(RTLD_DEFAULT, "openblas_set_num_threads") == nullptr) return;
  void* room = mmap(nullptr, kBuffer, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (room == MAP_FAILED)
    throw InputError(
        "out of memory: OpenBLAS, which the direct solver calls, needs 136 MB for its buffer, and the process cannot "
        "have them; raise its limit (ulimit -v). Steps of dynamics do without it by solver.linear = { kind = \"cg\" }; "
        "statics may factorise at their end, to tell whether the state is stable");
  munmap(room, kBuffer);
  constexpr int n = 64;  // beyond what small products do without a buffer
  constexpr double one = 1, zero = 0;
  const std::vector<double> a(n * n, 1.0);
  std::vector<double> c(n * n, 0.0);
  reinterpret_cast<Update>(update)("L", "N", &n, &n, &one, a.data(), &n, &zero, c.data(), &n);
}

}  // namespace

void take_blas_buffer() { [[maybe_unused]] static const bool taken = (take_buffer(), true); }

}  // namespace fascia
