#pragma once

#include "assembly/specification/domain.hpp"
#include "assembly/specification/fibres.hpp"
#include "assembly/specification/region.hpp"
#include "assembly/specification/schedule.hpp"
#include "core/geometry/point_table.hpp"
#include "core/math/mat3.hpp"
#include "core/physics/law.hpp"
#include "core/physics/law_constants.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

/// Bodies: what they are made of, and how they are cut into frames, elements or triangles. SI units.
namespace fascia {

/// How much the results of a scene, or of one body, must be worth. The rest of the scene is chosen so.
struct StatedNeed {
  Place place{};
  std::optional<double> error{};       ///< of the probe, or of the largest displacement of each body; relative
  std::optional<std::string> probe{};  ///< its name; none: displacements
  std::optional<double> step{};        ///< the 99th percentile of the time that a step takes [s]
  std::optional<double> memory{};      ///< [bytes]
  /// Directory of a study of this scene, among whose runs the choice is made; none: by trials.
  std::optional<std::filesystem::path> study{};
};

struct Material : LawConstants {
  Place place{};
  std::string name{};  ///< empty for an inline table
  Law law = Law::st_venant_kirchhoff;
  double mass_damping = 0, stiffness_damping = 0;  ///< [1/s], [s]
  std::vector<Fibres> fibres{};
  std::optional<Activation> activation{};  ///< its fibres pull by themselves
};
/// A material by Young's modulus [Pa] and Poisson's ratio, between −1 and ½.
inline Material elastic(double young, double poisson) {
  Material material;
  static_cast<Lame&>(material) = Lame::from_young(young, poisson);
  return material;
}
struct MaterialUse {
  Region where{};  ///< AllRegion where none was given
  Material material{};
};

struct InitialMotion {
  Vec3d velocity{}, angular_velocity{};
  std::optional<Vec3d> about{};  ///< default: the body's mass centre
};

/// Frames at the nodes of a regular grid.
struct GridFrames {
  std::vector<int> count{};  ///< along each direction, ends included: three numbers; a surface two, a line one
};
/// Poisson-disk samples.
struct SpacedSamples {
  double spacing = 0;  ///< mean distance of neighbours [m]
  int seed = 1;
};
/// Poisson-disk samples whose spacing is found for about `count` of them.
struct CountedSamples {
  int count = 0;
  int seed = 1;
};
struct ListedFrames {
  std::vector<Vec3d> positions{};  ///< [m]
  std::vector<Vec3d> rotations{};  ///< rotation vectors [rad]: none, or as many as positions
};
/// A table of positions: of a file, or of a program that has it in memory.
struct SampleFile {
  std::filesystem::path path{};  ///< already resolved against the scene's folder
  /// Gives the table when the body is built. @throws FileError, InputError
  std::function<PointTable()> read{};
};
using Frames = std::variant<GridFrames, SpacedSamples, CountedSamples, ListedFrames, SampleFile>;

/// Gauss points along each direction of every cell of the frame grid.
struct PerCell {
  std::vector<int> count{};  ///< as many numbers as the grid has
};
/// monostate: the default of the body's kind of frames
using Points = std::variant<std::monostate, PerCell, SpacedSamples, CountedSamples, SampleFile>;

struct ThicknessUse {
  Region where{};    ///< AllRegion where none was given
  double value = 0;  ///< [m]
};

/// Filling of a closed body: either a pressure or a bulk modulus.
struct Fluid {
  Place place{};
  std::optional<double> pressure{}, bulk_modulus{};  ///< [Pa]
  std::optional<double> volume{};                    ///< that it would have without pressure; default: at rest [m³]
  double density = 0;                                ///< [kg/m³]
  Schedule schedule{};
};

/// automatic: trilinear on a grid, mls for scattered frames
enum class WeightKind { automatic, trilinear, linear, mls, shepard, wendland, cubic_spline };
enum class Blend { automatic, half, full };
enum class Integration { automatic, full, selective };

enum class BodyModel {
  meshless,
  tetrahedra,
  hexahedra,
  shell,
  rigid,
  surface  ///< without matter: it rides on another body
};

/// Nodes of another body that are frames of this one too.
struct SharedNodes {
  Place place{}, body_place{};
  std::string body{};
  Region where{};
  bool rotations = true;  ///< vertices get a rotation
};

/// Strain of finite elements. large_strain: the material's law; corotational: linear in a frame that turns with the
/// element; linear: small displacements.
enum class Formulation { large_strain, corotational, linear };

/// Remedy of tetrahedra against volumetric locking; automatic: chosen by Poisson's ratio.
enum class Locking { automatic, none, f_bar };

/// Diagonals that cut the cells of a shell into triangles, see shells/generate.hpp.
enum class CellDiagonal { right, left, alternating };

/// Cells of a generated mesh.
struct MeshCells {
  /// Box, block, rectangle: along each edge; cylinder: along, around; annulus: outward, around; ellipsoid: around and,
  /// of a solid, layers.
  std::vector<int> count{};
  int split = 6;  ///< tetrahedra of a cell: 5 or 6
  CellDiagonal diagonal = CellDiagonal::right;
};

struct Body {
  Place place{};  ///< of the table [bodies.NAME]
  std::string name{};
  BodyModel model = BodyModel::meshless;
  Domain domain{};
  Place domain_place{};
  Transform transform{};
  std::vector<MaterialUse> materials{};     ///< first match wins
  std::optional<double> mass{}, density{};  ///< exactly one [kg], [kg/m³]
  std::vector<ThicknessUse> thickness{};    ///< surface domains, shells; first match wins; empty: none given
  Place thickness_place{};
  std::optional<double> radius{};  ///< line domains [m]
  Place radius_place{};
  Frames frames{};
  Place frames_place{};                              ///< of the key that says where they are
  bool affine = false;                               ///< frames of 12 DOFs, otherwise of 6
  std::optional<std::vector<SharedNodes>> shares{};  ///< none: not said
  Points points{};
  Place points_place{};
  std::optional<int> through{};  ///< points through a sheet's thickness; 1: the 2014 paper's rule
  WeightKind weights = WeightKind::automatic;
  Place weights_place{};
  std::optional<int> neighbours{};  ///< frames that influence a point, scattered frames
  std::optional<double> support{};  ///< radius of the weights, scattered frames [m]
  Blend blend = Blend::automatic;
  std::optional<double> drilling{};  ///< relative to mu; default: 0.1, affine frames 0.003
  Integration integration = Integration::automatic;
  InitialMotion initial{};
  std::optional<Fluid> fluid{};
  std::optional<Mat3d> inertia{};  ///< of a rigid body about its mass centre, in world axes [kg m²]
  Place inertia_place{};

  // Finite elements.
  std::optional<MeshCells> cells{};  ///< of generated domains
  Place cells_place{};
  Formulation formulation = Formulation::large_strain;
  Place formulation_place{};
  int order = 1;  ///< of the shape functions: 1 or 2
  Place order_place{};
  double incompressibility = 0;  ///< κ of the volume penalty κ V₀ |s|³/3, s = (V − V₀)/V₀ of a tetrahedron [Pa]
  Place incompressibility_place{};
  Locking locking = Locking::automatic;
  Place locking_place{};

  std::optional<StatedNeed> need{};
  bool under_need = false;  ///< the scene states a need, so that keys may be left out
  bool open = false;        ///< frames or cells are left out
};

/// Finite elements of the volume: the nodes are vertices, without rotation.
inline bool is_mesh_model(const Body& body) {
  return body.model == BodyModel::tetrahedra || body.model == BodyModel::hexahedra;
}
/// Triangles with thickness: the nodes are frames.
inline bool is_shell(const Body& body) { return body.model == BodyModel::shell; }
/// Carries a surface without being made of a material.
inline bool is_carrier(const Body& body) { return body.model == BodyModel::rigid || body.model == BodyModel::surface; }

}  // namespace fascia
