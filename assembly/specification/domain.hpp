#pragma once

#include "assembly/specification/region.hpp"
#include "core/geometry/mesh.hpp"
#include "core/geometry/mid_nodes.hpp"
#include "core/math/vec3.hpp"

#include <array>
#include <filesystem>
#include <functional>
#include <numbers>
#include <string>
#include <variant>

/// What a body fills, as the user wrote it, in SI units.
namespace fascia {

/// Lengths whose fifth powers, of moments of inertia, are doubles [m].
inline constexpr double kShortest = 1e-50, kLongest = 1e50;

struct BoxDomain {
  Vec3d min{}, max{};
};
/// A solid, for shells its skin or a sector of that; angle 0 and the sense of rotation: shells/generate.hpp.
struct CylinderDomain {
  Vec3d from{}, to{};
  double radius = 0;
  std::array<double, 2> angle{0, 2 * std::numbers::pi};  ///< [rad], ascending
  bool caps = true;                                      ///< of a closed skin: the ends are closed by disks
  bool closed = true;                                    ///< a whole turn whose two edges are one
};
/// A flat ring or a sector of it, angles about `normal` as above.
struct AnnulusDomain {
  Vec3d center{}, normal{};
  double inner = 0, outer = 0;
  std::array<double, 2> angle{0, 2 * std::numbers::pi};  ///< [rad], ascending
  bool closed = true;                                    ///< a whole turn whose two edges are one
};
/// A solid, for shells its skin.
struct EllipsoidDomain {
  Vec3d center{}, radii{};
};
/// A mesh: of a file, or of a program that has it in memory.
struct FileDomain {
  std::filesystem::path path{};  ///< already resolved against the scene's folder; of a mesh in memory its name
  Place place{};                 ///< of the key
  double unit = 1;               ///< of its numbers [m], as far as is known: Transform::scale has it
  int refine = 0;                ///< how often every cell is cut, of elements and shells
  Place refine_place{};
  /// Gives the mesh when the body is built, in the file's numbers. Whoever fills the specification says how.
  /// @throws FileError, InputError
  std::function<Mesh(MidNodes)> read{};
};
/// A parallelogram: origin + u edge_u + v edge_v, u and v from 0 to 1.
struct RectangleDomain {
  Vec3d origin{}, edge_u{}, edge_v{};
};
struct LineDomain {
  Vec3d from{}, to{};
};
/// The trilinear map of a cube onto eight corners [m], in the order of a VTK hexahedron: four of the lower face,
/// counter-clockwise seen from above, then the four above them. Its Jacobian is positive at every corner.
struct BlockDomain {
  std::array<Vec3d, 8> corners{};
};
/// What fills the space between two bodies.
enum class BetweenKind { volume, sheet, strands };
/// The space between parts of the surfaces of two bodies.
struct BetweenDomain {
  std::array<std::string, 2> bodies{};
  Region where{};  ///< the parts
  BetweenKind as = BetweenKind::volume;
  std::array<Place, 2> places{};  ///< of the two names
};
using Domain = std::variant<BoxDomain, CylinderDomain, EllipsoidDomain, FileDomain, RectangleDomain, LineDomain,
                            BlockDomain, AnnulusDomain, BetweenDomain>;

/// x → R(axis, angle) (scale x) + translate
struct Transform {
  Vec3d translate{};
  Vec3d axis{{0, 0, 1}};
  double angle = 0;  ///< [rad]
  double scale = 1;
};

}  // namespace fascia
