#include "app/version.hpp"

#include <fmt/format.h>

namespace fascia::app {

std::string backend_list() {
#if defined(FASCIA_CUDA)
  return fmt::format("cpu, cuda ({})", FASCIA_CUDA);
#else
  return "cpu";
#endif
}

std::string version_text() { return fmt::format("fascia {}\nbackends: {}", FASCIA_VERSION, backend_list()); }

}  // namespace fascia::app
