#pragma once

#include "app/warnings.hpp"
#include "core/solver/modes.hpp"

#include <cstddef>

namespace fascia::app {

/// What is to be said of natural modes: those that frames have and matter hardly feels, and what rounding leaves open.
/// @param free_motions  of the bodies as rigid ones, which have frequency 0
void warn_of_modes(const Modes& modes, std::ptrdiff_t free_motions, Warnings& warnings);

}  // namespace fascia::app
