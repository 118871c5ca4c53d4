#pragma once

#include "app/run/run_scene.hpp"
#include "assembly/specification/scene.hpp"

namespace fascia::app {

/// Runs a scene that states a need: looks for the cheapest choice that meets it, by trials, and runs that. Beside the
/// results it writes chosen.toml, which runs without the search.
/// @return  kNotConverged where the need is not met: then the results are the best that were reached
int run_need(const RunOptions& options, const Scene& scene);

/// Checks a scene that states a need with what a search would try first, and says what it leaves open.
int check_need(const RunOptions& options, const Scene& scene);

}  // namespace fascia::app
