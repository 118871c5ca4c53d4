#pragma once

#include "app/scene/scene.hpp"

namespace fascia::app {

/// Factor of a schedule at a time [s]; in statics at a load factor, which stands for time / `over`, or for time / the
/// last time of a table.
double schedule_factor(const Schedule& schedule, double time, bool statics);

/// The same in statics where the load factor is an unknown: below 0 and above 1 the profile goes on straight.
double path_factor(const Schedule& schedule, double load_factor);

}  // namespace fascia::app
