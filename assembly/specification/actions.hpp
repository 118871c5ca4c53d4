#pragma once

#include "assembly/specification/region.hpp"
#include "assembly/specification/schedule.hpp"
#include "core/math/mat3.hpp"

#include <array>
#include <optional>
#include <string>

/// Constraints, motions, loads and couplings of bodies. SI units.
namespace fascia {

struct Motion {
  Vec3d translate{};
  Vec3d axis{{0, 0, 1}};
  double angle = 0;  ///< [rad], continuous: may exceed 2π
  Vec3d center{};
};

struct Constraint {
  Place place{};
  std::string body{};
  Region where{};
  std::array<bool, 6> fixed{};     ///< x y z rx ry rz along `axes`
  Mat3d axes = Mat3d::identity();  ///< rows: orthonormal directions
  std::optional<Motion> motion{};  ///< none: held where it is, or moved by the driver
  std::string driver{};            ///< name by which a program moves it (fascia/stepper.hpp); empty: none
  Schedule schedule{};
};

struct Load {
  Place place{};
  std::string body{};
  std::optional<Region> where{};  ///< with what acts on a region
  std::optional<Vec3d> at{};      ///< with force, torque
  Place at_place{};
  std::optional<Vec3d> total_force{}, total_torque{}, force_per_node{}, force{}, torque{};  ///< [N], [N m]
  std::optional<Vec3d> traction{};   ///< dead force per rest area of the selected faces [Pa]
  std::optional<double> pressure{};  ///< against the normals of the selected faces [Pa]
  bool pressure_follows = true;
  std::optional<Vec3d> line_force{};  ///< on the selected edges [N/m]
  bool follower = false;
  Schedule schedule{};
};

enum class CouplingKind { weld, embed, spring };

struct Coupling {
  Place place{};
  std::string name{};
  CouplingKind kind = CouplingKind::weld;
  std::string body{};
  Region where{};
  std::string to{};  ///< of welds and embeddings
  Place to_place{};
  Vec3d point{};                     ///< of springs [m]
  double stiffness = 0;              ///< of all selected nodes together [N/m]
  std::optional<Vec3d> direction{};  ///< unit
};

struct World {
  Vec3d gravity{};
  Schedule schedule{};
  std::optional<Vec3d> up{};  ///< in pictures; default: against gravity
};

}  // namespace fascia
