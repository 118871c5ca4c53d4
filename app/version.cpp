#include "app/version.hpp"

#include <fmt/format.h>

namespace fascia::app {

std::string version_text() {
#if defined(FASCIA_CUDA)
  const std::string backends = fmt::format("cpu, cuda ({})", FASCIA_CUDA);
#else
  const std::string backends = "cpu";
#endif
  return fmt::format("fascia {}\nbackends: {}", FASCIA_VERSION, backends);
}

}  // namespace fascia::app
