#pragma once

namespace fascia {

/// How a run ended. unstable, inverted: an equilibrium, but one that no body rests in.
enum class RunStatus { converged, not_converged, diverged, interrupted, unstable, inverted };

}  // namespace fascia
