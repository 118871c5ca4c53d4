#pragma once

#include "app/scene/scene.hpp"
#include "meshless/body.hpp"

#include <string>
#include <vector>

namespace fascia::app {

/// A domain in the axes of its frame grid (scaled, not yet turned or moved), and its rigid placement.
struct PlacedDomain {
  SolidDomain solid;
  Mat3d rotation = Mat3d::identity();
  Vec3d translation{};
  std::vector<std::string> messages;
};

/// @throws FileError, InputError  a mesh that cannot be used
PlacedDomain make_domain(const Body& body);

}  // namespace fascia::app
