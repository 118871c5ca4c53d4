#pragma once

#include "app/scene/scene.hpp"

namespace fascia::app {

/// Factor of a schedule at a time [s]; in statics at a load factor, which then stands for time / over.
double schedule_factor(const Schedule& schedule, double time, bool statics);

}  // namespace fascia::app
