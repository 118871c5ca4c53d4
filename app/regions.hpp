#pragma once

#include "app/scene/scene.hpp"
#include "core/model/model_body.hpp"

#include <span>
#include <vector>

namespace fascia::app {

/// What a region selects from.
struct Selectable {
  std::span<const Vec3d> points;                   ///< rest positions
  std::span<const char> on_boundary = {};          ///< one a point; empty: the boundary cannot be asked for
  const std::vector<BodyGroup>* groups = nullptr;  ///< of a mesh; null: none can be asked for
  std::span<const int> cell = {};                  ///< of each point; empty: the points are the body's nodes
};

/// The points that a region selects.
/// @throws SceneError  a region that these points do not know (a group, or the boundary)
std::vector<bool> select(const Region& region, const Selectable& points);

/// Whether a region (no nearest, ids, boundary) holds a position, or the cell that it is in.
/// @param groups  of the mesh; null: a group cannot be asked for
/// @throws SceneError  for those
bool contains(const Region& region, const Vec3d& X, const std::vector<BodyGroup>* groups = nullptr, int cell = -1);

/// Whether a region names `boundary` anywhere.
bool names_boundary(const Region& region);

/// Whether a region picks single frames anywhere: `nearest` or `ids`.
bool names_frames(const Region& region);

}  // namespace fascia::app
