#pragma once

#include "core/math/vec3.hpp"

#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace fascia {

/// Where in a scene file (or on the command line) something was said.
struct Place {
  std::string file{};  ///< as the user named it; "--set" for an override
  int line = 0, column = 0;
  std::string key{};  ///< full path, for example constraints[0].where.box.min
};

struct Region;
struct AllRegion {};
struct BoundaryRegion {};
struct BoxRegion {
  Vec3d min{}, max{};
};
struct SphereRegion {
  Vec3d center{};
  double radius = 0;
};
struct CylinderRegion {
  Vec3d from{}, to{};
  double radius = 0;
};
struct HalfspaceRegion {
  Vec3d point{}, normal{};
};
struct NearestRegion {
  Vec3d point{};
};
struct GroupRegion {
  std::string name{};
};
struct IdsRegion {
  std::vector<int> ids{};
};
struct AllOfRegion {
  std::vector<Region> parts;
};
struct AnyOfRegion {
  std::vector<Region> parts;
};
struct NotRegion {
  std::shared_ptr<const Region> part;
};

struct Region {
  Place place{};
  std::variant<AllRegion, BoundaryRegion, BoxRegion, SphereRegion, CylinderRegion, HalfspaceRegion, NearestRegion,
               GroupRegion, IdsRegion, AllOfRegion, AnyOfRegion, NotRegion>
      shape;
};

/// Region of all that lies in a box between two corners [m].
inline Region in_box(const Vec3d& min, const Vec3d& max) { return {{}, BoxRegion{min, max}}; }

}  // namespace fascia
