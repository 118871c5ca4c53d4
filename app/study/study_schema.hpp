#pragma once

#include "app/scene/schema.hpp"

namespace fascia::app {

/// The format of study files, a table.
const Shape& study_schema();

}  // namespace fascia::app
