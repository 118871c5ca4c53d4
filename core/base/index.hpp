#pragma once

#include "core/base/portability.hpp"

#include <cstddef>

namespace fascia {

/// An index that is known not to be negative, for the standard containers.
FASCIA_HD constexpr std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace fascia
