#pragma once

#include "assembly/specification/errors.hpp"
#include "assembly/specification/scene.hpp"

#include <vector>

namespace fascia {

/// Gives each part of a scene that has no place the key by which messages name it: bodies.liver, constraints[0].
void name_places(Scene& scene);

/// Bodies that share nodes with others, or lie between others, and lead back to themselves: at the place of each share
/// that closes a circle.
std::vector<Diagnostic> circles_of(const std::vector<Body>& bodies);

/// Looks for what a reader of scene files would have refused: names of bodies that are not there, lists of the wrong
/// length, numbers that are not finite or out of range.
/// @throws SceneError  everything that is wrong
void check_specification(const Scene& scene);

/// Steps of a duration, the last one cut; what is left below a millionth of a step lengthens the last one.
double step_count(double duration, double time_step);

/// Looks for what a whole run needs of its solver, and gives it the number of steps of its duration.
/// @throws SceneError  everything that is wrong
void check_run(Scene& scene);

}  // namespace fascia
