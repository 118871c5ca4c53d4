#pragma once

#include "tests/random/draws.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace fascia::random_scenes {

/// Size and matter of a scene, from which all else is scaled.
struct Scales {
  double length, width;   ///< of a body, along x and across [m]
  double young, density;  ///< of the first body [Pa], [kg/m³]
  double stiffest = 0;    ///< Young's modulus of the stiffest body [Pa]
  /// Time of a wave along a body [s].
  double time() const { return length * std::sqrt(density / young); }
  /// Transverse force that bends a body by about its length [N].
  double force() const { return young * width * width * width * width / (length * length); }
};

/// A scene that a seed gives.
struct RandomScene {
  Json tree;
  Scales scales;
  double load_size = 0;                           ///< of all loads together, those that cancel one another too [N]
  std::vector<std::optional<Vector>> resultants;  ///< of each load at its full size [N]; none where it is not known
  std::string wrong;                              ///< what was made wrong on purpose; empty in a sound scene
  std::string blamed;                             ///< the key that an error must name
  std::string section;                            ///< and where it stands: a key of SceneText::lines
};

RandomScene random_scene(std::uint64_t seed);

/// A body in the row of bodies along x.
struct RowBody {
  std::string name;
  double from, to;            ///< its ends along x [m]
  bool thin, stiff, carried;  ///< a sheet, shell or line; a rigid body; a surface
  bool solid;                 ///< a box that fills the row's section
  bool has_boundary;          ///< a closed surface
  bool alone;                 ///< it is coupled to none before it
  double young;               ///< [Pa]
};

// Parts of random_scene(), in files of their own.
std::vector<RowBody> add_bodies(Draws& draws, const Scales& scales, Json& scene);
void add_couplings(Draws& draws, const Scales& scales, std::vector<RowBody>& row, Json& scene);
void add_constraints(Draws& draws, const Scales& scales, const std::vector<RowBody>& row, Json& scene);
void add_loads(Draws& draws, const Scales& scales, const std::vector<RowBody>& row, RandomScene& scene);
void add_solver(Draws& draws, const Scales& scales, Json& scene);
void add_probes(const Scales& scales, const std::vector<RowBody>& row, Json& scene);
/// Makes one thing wrong.
void spoil(Draws& draws, RandomScene& scene);

/// A region between two places along x.
Json slab(double from, double to, const Scales& scales);

}  // namespace fascia::random_scenes
