#pragma once

#include "gpu/run/run.hpp"
#include "gpu/space/device.hpp"

/// The code that computes on a GPU is a module that is loaded: fascia-cuda.so.
///
/// The functions of device.hpp and run.hpp call it. A run that asks for no GPU waits neither for its compiler nor for
/// its runtime.
namespace fascia::gpu {

struct DeviceFunctions {
  const char* build;        ///< FASCIA_INTERFACE_TAG: builds whose headers differ must not exchange modules
  const char* description;  ///< "toolkit 13.0, for 90-real"
  std::vector<int> (*find_devices)(int count, std::string& reason);
  decltype(&gpu::run_statics) run_statics;
  decltype(&gpu::run_implicit) run_implicit;
  decltype(&gpu::run_explicit) run_explicit;
  decltype(&gpu::make_stepper) make_stepper;
  decltype(&gpu::evaluate) evaluate;
};

/// The module's, loaded at the first call; null where there is none. From any thread.
/// @param reason  why: a sentence
const DeviceFunctions* device_functions(std::string& reason);

/// Those that something has asked for before; null where nothing has, or there are none. Loads nothing.
const DeviceFunctions* device_functions_in_use();

/// The module lies where it would be loaded from.
bool device_module_exists();

/// Takes these in place of a module: for programs that CUDA's part is linked into. Before the first use of a device.
void use_device_functions(const DeviceFunctions& functions);

/// The environment variable that names another module in place of fascia-cuda.so: fascia-host.so, whose "device" is
/// the processor.
inline constexpr const char* kModuleVariable = "FASCIA_DEVICE_MODULE";

/// The name by which a module hands out its functions, of type ModuleEntry.
inline constexpr const char* kModuleEntry = "fascia_device_functions";
using ModuleEntry = const DeviceFunctions* (*)();

}  // namespace fascia::gpu
