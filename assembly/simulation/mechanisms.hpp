#pragma once

#include "assembly/simulation/loose_motions.hpp"
#include "assembly/simulation/simulation.hpp"

#include <string>
#include <vector>

/// What may move without deforming: connected pieces of bodies taken as rigid, tied to one another by couplings and to
/// the ground by supports.
namespace fascia {

/// A connected part of a body.
struct Piece {
  int body = 0;
  std::vector<int> nodes;  ///< of the model, ascending
  Vec3d center{};
  bool whole = false;  ///< all of the body
};

/// Pieces that hang together, and what of them is free.
struct Assembly {
  std::vector<int> pieces;        ///< of Mechanisms::pieces
  std::vector<std::string> free;  ///< motions of all pieces as one body that no support resists
  LooseMotions loose;             ///< further ones
};

struct Mechanisms {
  std::vector<Piece> pieces;
  std::vector<Assembly> assemblies;
  std::vector<std::string> own_motions;  ///< of each piece, its supports and springs alone: what is free; empty: held
};

Mechanisms find_mechanisms(const Simulation& simulation);

/// How many independent rigid motions nothing resists.
int free_motion_count(const Mechanisms& mechanisms);

}  // namespace fascia
