#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstring>

namespace {

constexpr const char* kName = "OPENBLAS_NUM_THREADS";
constexpr std::size_t kMostVariables = 4000;

/// The program was started by the loader by name, which stands in its place.
bool is_loader() {
  std::array<char, 4096> path{};
  const ssize_t length = readlink("/proc/self/exe", path.data(), path.size() - 1);
  if (length <= 0) return true;
  const char* name = std::strrchr(path.data(), '/');
  return name == nullptr || std::strncmp(name, "/ld", 3) == 0;
}

/// OpenBLAS starts a thread for each processor when it is loaded, of which each asks for a buffer of 134 MB at once and
/// tries for ever where it gets none; it reads the environment before this program can change it. A process with a
/// limit on its memory starts again with that environment, before the initialisers of any library: calls the system
/// alone.
void hold_blas_to_one_thread(int /*argc*/, char** argv, char** environment) {
  rlimit space{}, data{};
  if (getrlimit(RLIMIT_AS, &space) != 0 || getrlimit(RLIMIT_DATA, &data) != 0) return;
  if (space.rlim_cur == RLIM_INFINITY && data.rlim_cur == RLIM_INFINITY) return;
  std::array<char*, kMostVariables + 2> with{};
  std::size_t count = 0;
  for (; environment[count] != nullptr; ++count) {
    if (count == kMostVariables || std::strncmp(environment[count], kName, std::strlen(kName)) == 0) return;
    with[count] = environment[count];
  }
  static char variable[] = "OPENBLAS_NUM_THREADS=1";
  with[count] = variable;
  if (!is_loader()) execve("/proc/self/exe", argv, with.data());
}

[[gnu::section(".preinit_array"), gnu::used]] void (*const first)(int, char**, char**) = hold_blas_to_one_thread;

}  // namespace
