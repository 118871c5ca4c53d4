#pragma once

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

/// The problem is one that several devices do not compute together; one may.
struct NotShared : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The first devices that this build can use, `count` at most, the first of which is taken.
/// @param reason  why there are not as many: a sentence
std::vector<int> find_devices(int count, std::string& reason);

/// Takes the first device that this build can use; the others are left alone. False where there is none.
/// @param reason  why: a sentence
inline bool find_device(std::string& reason) { return !find_devices(1, reason).empty(); }

/// Takes the first device that this build can use. @throws NoDevice  with the reason and a remedy
void require_device();

}  // namespace fascia::gpu
