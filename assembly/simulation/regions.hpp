#pragma once

#include "assembly/specification/scene.hpp"
#include "core/body/model_body.hpp"

#include <span>
#include <vector>

namespace fascia {

/// What a region selects from.
struct Selectable {
  std::span<const Vec3d> points;                   ///< rest positions
  std::span<const char> on_boundary = {};          ///< one a point; empty: the boundary cannot be asked for
  const std::vector<BodyGroup>* groups = nullptr;  ///< of a mesh; null: none can be asked for
  std::span<const int> cell = {};                  ///< of each point; empty: the points are the body's nodes
  double size = 0;  ///< of the body, where it is wider than the points [m]: a billionth of it is forgiven at borders
};

/// The points that a region selects.
/// @throws SceneError  a region that these points do not know (a group, or the boundary)
std::vector<bool> select(const Region& region, const Selectable& points);

/// @throws SceneError  a region that selects nodes anywhere (nearest, ids) where material is asked for
void require_material(const Region& region);

/// Whether a region of material (no boundary, no group) holds a position.
/// @param size  of the body that the position belongs to [m]
/// @throws SceneError  for another region
bool contains(const Region& region, const Vec3d& X, double size);

/// Whether a region names `boundary` anywhere.
bool names_boundary(const Region& region);

/// Whether a region picks single frames anywhere: `nearest` or `ids`.
bool names_frames(const Region& region);

/// Whether a region has `ids` anywhere.
bool names_ids(const Region& region);

}  // namespace fascia
