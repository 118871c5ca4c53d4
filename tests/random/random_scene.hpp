#pragma once

#include "assembly/actions/actions.hpp"
#include "tests/random/draws.hpp"
#include "tests/random/mesh_file.hpp"

#include <cstdint>
#include <map>
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
  std::string section;                            ///< and where it stands: a key of SceneText::lines; empty in a mesh
  std::map<std::string, MeshFile> meshes;         ///< by the name of their file
  std::vector<std::string> features;              ///< fluids, tissues and meshes, in words
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
  double lift = 0;            ///< of its section along z [m]
};

// Parts of random_scene(), in files of their own.
std::vector<RowBody> add_bodies(Draws& draws, const Scales& scales, Json& scene);
/// @param on_solid  the body before it can carry a surface
RowBody add_body(Draws& draws, const Scales& scales, int index, double from, bool on_solid, Json& scene);
void add_couplings(Draws& draws, const Scales& scales, std::vector<RowBody>& row, Json& scene);
void add_constraints(Draws& draws, const Scales& scales, const std::vector<RowBody>& row, Json& scene);
void add_loads(Draws& draws, const Scales& scales, const std::vector<RowBody>& row, RandomScene& scene);
void add_gravity(Draws& draws, const Scales& scales, Json& scene);
/// Beside a load, motion or fluid: how it grows; nothing in statics, where that has no meaning.
void add_schedule(Draws& draws, const Json& scene, Json& entry);
void add_solver(Draws& draws, const Scales& scales, Json& scene);
void add_probes(const Scales& scales, const std::vector<RowBody>& row, Json& scene);
/// Makes one thing wrong.
void spoil(Draws& draws, RandomScene& scene);

/// Gives a material of the law "mooney-rivlin" its constants in the place of the moduli that it was drawn with.
void take_own_constants(Json& material);
/// Takes them and the law back.
void take_moduli(Json& material);

// Parts of one scene in five.
/// A shell that a fluid can fill takes the place of the last body.
void add_closed_shell(Draws& draws, const Scales& scales, std::vector<RowBody>& row, Json& scene);
/// A body beside one of the row, and what fills the space between them.
void add_tissue(Draws& draws, const Scales& scales, bool flies, std::vector<RowBody>& row, RandomScene& scene);
/// A file takes the place of a box or a rectangle.
void add_mesh(Draws& draws, const Scales& scales, const std::vector<RowBody>& row, const std::string& file,
              RandomScene& scene);
void add_fluid(Draws& draws, bool flies, const std::vector<RowBody>& row, RandomScene& scene);

/// A part of a body's length that no cell is as short as.
double sliver(const Scales& scales);
/// A region between two places along x.
Json slab(double from, double to, const Scales& scales);
/// A body's end along x.
Json end_of(const RowBody& body, bool far, const Scales& scales);
/// A sheet, of a shell or of frames.
bool is_rectangle(const Json& body);

}  // namespace fascia::random_scenes
