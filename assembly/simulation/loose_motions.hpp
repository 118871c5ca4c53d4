#pragma once

#include "core/math/vec3.hpp"

#include <string>
#include <vector>

/// Rigid pieces that are tied to one another and to the ground, and what of them still moves.
namespace fascia {

/// A direction in which something resists the motion of a piece against another one, or against the ground (−1).
struct Tie {
  int piece = -1, other = -1;
  Vec3d X{}, direction{};
  bool rotation = false;
};

struct RigidPiece {
  Vec3d center{};
  double size = 1;  ///< a turn by 1 rad counts as a displacement by this [m]
};

/// The pieces as one: the middle of their centres, and the largest size.
RigidPiece whole_of(const std::vector<RigidPiece>& pieces, const std::vector<int>& members);

/// "translation along x", .. : motions of one rigid body that no tie to the ground resists; all six where none is.
std::vector<std::string> free_motions(const std::vector<const Tie*>& ties, const RigidPiece& body);

/// A motion that nothing resists, and the piece that moves most in it.
struct LooseMotion {
  int piece = 0;
  std::string name;
};

struct LooseMotions {
  std::vector<LooseMotion> motions;  ///< of many a sample
  int count = 0;
};

/// Motions of pieces against one another and the ground that no tie resists, beside those of all as one body.
/// @param members  the pieces that hang together
/// @param ties     theirs
LooseMotions loose_motions(const std::vector<RigidPiece>& pieces, const std::vector<int>& members,
                           const std::vector<const Tie*>& ties);

}  // namespace fascia
