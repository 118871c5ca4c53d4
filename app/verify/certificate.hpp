#pragma once

#include "app/machine.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <utility>
#include <vector>

namespace fascia::app {

/// What was verified, and where: the program by its bytes, its build, the machine.
struct Certificate {
  Machine machine;
  std::string command, processor_level;
  std::vector<std::pair<std::string, std::string>> files;  ///< of the program: path, SHA-256
};

/// Of this process. @throws FileError  a file of the program cannot be read
Certificate this_certificate();

nlohmann::ordered_json json_of(const Certificate& certificate);

}  // namespace fascia::app
