#pragma once

#include "app/run/run_scene.hpp"
#include "assembly/specification/scene.hpp"

namespace fascia::app {

/// Runs a scene whose need names a study: takes the cheapest of the study's runs that meets the need, and runs that.
/// Beside the results it writes chosen.toml. @return  kNotConverged where the need is not met: then the results are of
/// the nearest @throws SceneError  the study is of another scene, or there is none
int run_by_study(const RunOptions& options, const Scene& scene);

/// Checks such a scene with that choice, and says which it is.
int check_by_study(const RunOptions& options, const Scene& scene);

}  // namespace fascia::app
