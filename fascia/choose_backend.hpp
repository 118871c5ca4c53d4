#pragma once

#include "assembly/simulation/simulation.hpp"
#include "fascia/backend.hpp"

#include <exception>
#include <string>

namespace fascia {

/// Names what of a scene the GPU does not compute, in the scene's words; empty where it computes all.
std::string not_on_gpu(const Simulation& simulation);

/// Where a scene is computed: as it says, or with backend = "auto" on the GPU where there is one, it computes all of
/// the scene, and the scene is large enough to be faster there or asks for single precision, which only the GPU has,
/// or for several GPUs.
/// @throws BackendError  a backend that was asked for and is not there, or does not compute the scene
Backend choose_backend(const Simulation& simulation);

/// The precision that a scene was computed with: the processor has "mixed" in conjugate gradients alone, and no
/// "single".
/// @param iterated  these solved
std::string precision_of(const Simulation& simulation, Backend backend, bool iterated);

/// Sentence on single precision or on GPUs that a scene asks for where the processor computes it; empty otherwise.
std::string not_as_asked(const Simulation& simulation, Backend backend);

const char* name_of(Backend backend);

/// Says that an error is one of a device, of a type that programs do not see.
bool is_of_device(const std::exception& error);

}  // namespace fascia
