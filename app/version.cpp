#include "app/version.hpp"

#include "gpu/run/device_functions.hpp"

#include <fmt/format.h>

namespace fascia::app {

std::string backend_list() {
  std::string reason;
  const gpu::DeviceFunctions* cuda = gpu::device_functions(reason);
  return cuda == nullptr ? "cpu" : fmt::format("cpu, cuda ({})", cuda->description);
}

std::string backends_so_far() {
  if (const gpu::DeviceFunctions* cuda = gpu::device_functions_in_use())
    return fmt::format("cpu, cuda ({})", cuda->description);
  return gpu::device_module_exists() ? "cpu, cuda" : "cpu";
}

const char* tuning() { return FASCIA_TUNING; }

std::string version_text() {
  const std::string built_from = *commit() == '\0' ? "" : fmt::format("\ncommit: {}", commit());
  return fmt::format("fascia {}{}\nbackends: {}\ndirect solver: {}\nprocessor: {}", FASCIA_VERSION, built_from,
                     backend_list(), FASCIA_DIRECT_SOLVER, tuning());
}

}  // namespace fascia::app
