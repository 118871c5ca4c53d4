#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fascia::app {

struct CompareOptions {
  std::filesystem::path a, b;
  double tolerance = 1e-6;
  std::vector<std::string> only;  ///< see compare()
  bool json = false;
};

/// Prints how two results differ. @return kDone, or kDiffers above the tolerance or where they cannot be compared
int compare_command(const CompareOptions& options);

}  // namespace fascia::app
