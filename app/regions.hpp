#pragma once

#include "app/scene/scene.hpp"

#include <span>
#include <vector>

namespace fascia::app {

/// The points that a region selects, by rest position.
///
/// @param on_boundary  which of the points lie on the body's boundary; empty: none can be asked for
/// @throws SceneError  a region that these points do not know (group, or boundary where `on_boundary` is empty)
std::vector<bool> select(const Region& region, std::span<const Vec3d> points, std::span<const char> on_boundary);

/// Whether a region of shapes (no nearest, ids, boundary, group) holds a position.
/// @throws SceneError  for those
bool contains(const Region& region, const Vec3d& X);

/// Whether a region names `boundary` anywhere.
bool names_boundary(const Region& region);

/// Whether a region picks single frames anywhere: `nearest` or `ids`.
bool names_frames(const Region& region);

}  // namespace fascia::app
