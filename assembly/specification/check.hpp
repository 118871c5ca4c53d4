#pragma once

#include "assembly/specification/scene.hpp"

namespace fascia {

/// Gives each part of a scene that has no place the key by which messages name it: bodies.liver, constraints[0].
void name_places(Scene& scene);

/// Looks for what a reader of scene files would have refused: names of bodies that are not there, lists of the wrong
/// length, numbers that are not finite or out of range.
/// @throws SceneError  everything that is wrong
void check_specification(const Scene& scene);

}  // namespace fascia
