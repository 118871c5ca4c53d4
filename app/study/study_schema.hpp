#pragma once

#include "app/schema/schema.hpp"

namespace fascia::app {

/// The format of study files, a table.
const Shape& study_schema();

}  // namespace fascia::app
