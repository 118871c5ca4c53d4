#pragma once

#include <stdexcept>

namespace fascia {

enum class Backend { cpu, cuda };

/// A backend that was asked for and is not there, or does not compute the scene.
class BackendError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace fascia
