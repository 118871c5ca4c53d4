#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace fascia::gpu {

/// There is no device, or none that this build can use.
struct NoDevice : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// The device has too little memory.
struct DeviceMemoryError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// The device stopped working in the middle of a run.
struct DeviceLost : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A graphics processor of this machine.
struct DeviceInfo {
  std::string name;
  int major = 0, minor = 0;  ///< compute capability
  int multiprocessors = 0;
  std::size_t memory = 0, free_memory = 0;  ///< [bytes]
  int driver = 0, runtime = 0;              ///< 1000 · major + 10 · minor
};

/// The build has a CUDA backend.
bool built_with_cuda();

/// Devices that this build can use, the default one first; empty where there are none.
/// @param reason  why there are none: a sentence
std::vector<DeviceInfo> usable_devices(std::string& reason);

/// The default device. @throws NoDevice  with the reason and a remedy
DeviceInfo require_device();

}  // namespace fascia::gpu
