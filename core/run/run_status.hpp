#pragma once

namespace fascia {

/// How a run ended. not_converged: also where steps were accepted above the tolerance, as a scene may ask for.
/// unstable, inverted: an equilibrium, but one that no body rests in.
enum class RunStatus { converged, not_converged, diverged, interrupted, unstable, inverted };

}  // namespace fascia
