#pragma once

#include "core/structure/model.hpp"

namespace fascia {

/// Moves inertia like move_inertia_to_hosts(), for statics without gravity, where no mass resists or weighs: a host's
/// may turn negative.
void move_idle_inertia_to_hosts(Model& model);

}  // namespace fascia
