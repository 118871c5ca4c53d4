#pragma once

#include <string>
#include <utility>
#include <vector>

namespace fascia::app {

/// Where something ran, and how the program was built.
struct Machine {
  std::string date;               ///< ISO 8601, UTC
  std::string host, system, cpu;  ///< its name; kernel; model of the processor
  int threads = 0;                ///< that may run at once
  double memory = 0;              ///< [bytes]
  std::vector<std::string> gpu;   ///< models, as the driver names them
  std::string driver;             ///< of the GPUs; empty where there is none
  std::string fascia, commit, backends, compiler, flags, build;
  std::vector<std::pair<std::string, std::string>> libraries;  ///< name, version
};

/// This machine, now.
Machine this_machine();

/// The program, its libraries and modules, as this process has mapped them.
std::vector<std::string> files_of_program();

}  // namespace fascia::app
