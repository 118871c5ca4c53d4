#pragma once

#include "app/scene/domain.hpp"
#include "app/scene/profile.hpp"
#include "app/scene/region.hpp"
#include "core/math/mat3.hpp"
#include "core/physics/law.hpp"
#include "core/physics/law_constants.hpp"
#include "core/tangent/linear_settings.hpp"

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

/// The scene as the user wrote it, checked key by key, in SI units. The parser makes it; the builder turns it into a
/// model.
namespace fascia::app {

// ------------------------------------------------------------------------------------------------ need
/// What the results of a scene, or of one body, must be worth. What the scene leaves out is chosen so.
struct StatedNeed {
  Place place;
  std::optional<double> error;       ///< of the probe, or of the largest displacement of each body; relative
  std::optional<std::string> probe;  ///< its name; none: displacements
  std::optional<double> step;        ///< the 99th percentile of the time that a step takes [s]
  std::optional<double> memory;      ///< [bytes]
};

// ------------------------------------------------------------------------------------------------ bodies
struct Material : LawConstants {
  Place place;
  std::string name;  ///< empty for an inline table
  Law law = Law::st_venant_kirchhoff;
  double mass_damping = 0, stiffness_damping = 0;  ///< [1/s], [s]
};
struct MaterialUse {
  Region where;  ///< AllRegion where none was given
  Material material;
};

struct InitialMotion {
  Vec3d velocity{}, angular_velocity{};
  std::optional<Vec3d> about;  ///< default: the body's mass centre
};

/// Frames at the nodes of a regular grid.
struct GridFrames {
  std::vector<int> count;  ///< along each direction, ends included: three numbers; a surface two, a line one
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
  std::vector<Vec3d> positions;  ///< [m]
  std::vector<Vec3d> rotations;  ///< rotation vectors [rad]: none, or as many as positions
};
/// A CSV table of positions, see io/mesh/point_table.hpp.
struct SampleFile {
  std::filesystem::path path;  ///< already resolved against the scene's folder
};
using Frames = std::variant<GridFrames, SpacedSamples, CountedSamples, ListedFrames, SampleFile>;

/// Gauss points along each direction of every cell of the frame grid.
struct PerCell {
  std::vector<int> count;  ///< as many numbers as the grid has
};
/// monostate: the default of the body's kind of frames
using Points = std::variant<std::monostate, PerCell, SpacedSamples, CountedSamples, SampleFile>;

struct ThicknessUse {
  Region where;      ///< AllRegion where none was given
  double value = 0;  ///< [m]
};

/// What fills a closed body: either a pressure or a bulk modulus.
struct Fluid {
  Place place;
  std::optional<double> pressure, bulk_modulus;  ///< [Pa]
  std::optional<double> volume;                  ///< that it would have without pressure; default: at rest [m³]
  double density = 0;                            ///< [kg/m³]
  Schedule schedule;
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
  Place place, body_place;
  std::string body;
  Region where;
  bool rotations = true;  ///< vertices get a rotation
};

/// Strain of finite elements. large_strain: the material's law; corotational: linear in a frame that turns with the
/// element; linear: small displacements.
enum class Formulation { large_strain, corotational, linear };

/// Remedy of tetrahedra against volumetric locking; automatic: chosen by Poisson's ratio.
enum class Locking { automatic, none, f_bar };

/// What cuts a cell of a shell into triangles, see shells/generate.hpp.
enum class CellDiagonal { right, left, alternating };

/// Cells of a generated mesh.
struct MeshCells {
  /// Box, block, rectangle: along each edge; cylinder: along, around; annulus: outward, around; ellipsoid: around and,
  /// of a solid, layers.
  std::vector<int> count;
  int split = 6;  ///< tetrahedra of a cell: 5 or 6
  CellDiagonal diagonal = CellDiagonal::right;
};

struct Body {
  Place place;  ///< of the table [bodies.NAME]
  std::string name;
  BodyModel model = BodyModel::meshless;
  Domain domain;
  Place domain_place;
  Transform transform;
  std::vector<MaterialUse> materials;   ///< first match wins
  std::optional<double> mass, density;  ///< exactly one [kg], [kg/m³]
  std::vector<ThicknessUse> thickness;  ///< surface domains, shells; first match wins; empty: none given
  Place thickness_place;
  std::optional<double> radius;  ///< line domains [m]
  Place radius_place;
  Frames frames;
  Place frames_place;                              ///< of the key that says where they are
  bool affine = false;                             ///< frames of 12 DOFs, otherwise of 6
  std::optional<std::vector<SharedNodes>> shares;  ///< none: not said
  Points points;
  Place points_place;
  std::optional<int> through;  ///< points through a sheet's thickness; 1: the 2014 paper's rule
  WeightKind weights = WeightKind::automatic;
  Place weights_place;
  std::optional<int> neighbours;  ///< frames that influence a point, scattered frames
  std::optional<double> support;  ///< radius of the weights, scattered frames [m]
  Blend blend = Blend::automatic;
  std::optional<double> drilling;  ///< relative to mu; default: 0.1, affine frames 0.003
  Integration integration = Integration::automatic;
  InitialMotion initial;
  std::optional<Fluid> fluid;
  std::optional<Mat3d> inertia;  ///< of a rigid body about its mass centre, in world axes [kg m²]
  Place inertia_place;

  // Finite elements.
  std::optional<MeshCells> cells;  ///< of generated domains
  Place cells_place;
  Formulation formulation = Formulation::large_strain;
  Place formulation_place;
  int order = 1;  ///< of the shape functions: 1 or 2
  Place order_place;
  double incompressibility = 0;  ///< κ of the volume penalty κ V₀ |s|³/3, s = (V − V₀)/V₀ of a tetrahedron [Pa]
  Place incompressibility_place;
  Locking locking = Locking::automatic;
  Place locking_place;

  std::optional<StatedNeed> need;
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

// ------------------------------------------------------------------------------------------------ constraints, loads
struct Motion {
  Vec3d translate{};
  Vec3d axis{{0, 0, 1}};
  double angle = 0;  ///< [rad], continuous: may exceed 2π
  Vec3d center{};
};

struct Constraint {
  Place place;
  std::string body;
  Region where;
  std::array<bool, 6> fixed{};     ///< x y z rx ry rz along `axes`
  Mat3d axes = Mat3d::identity();  ///< rows: orthonormal directions
  std::optional<Motion> motion;    ///< none: held where it is
  Schedule schedule;
};

struct Load {
  Place place;
  std::string body;
  std::optional<Region> where;  ///< with what acts on a region
  std::optional<Vec3d> at;      ///< with force, torque
  Place at_place;
  std::optional<Vec3d> total_force, total_torque, force_per_node, force, torque;  ///< [N], [N m]
  std::optional<Vec3d> traction;   ///< dead force per rest area of the selected faces [Pa]
  std::optional<double> pressure;  ///< against the normals of the selected faces [Pa]
  bool pressure_follows = true;
  std::optional<Vec3d> line_force;  ///< on the selected edges [N/m]
  bool follower = false;
  Schedule schedule;
};

// ------------------------------------------------------------------------------------------------ couplings
enum class CouplingKind { weld, embed, spring };

struct Coupling {
  Place place;
  std::string name;
  CouplingKind kind = CouplingKind::weld;
  std::string body;
  Region where;
  std::string to;  ///< of welds and embeddings
  Place to_place;
  Vec3d point{};                   ///< of springs [m]
  double stiffness = 0;            ///< of all selected nodes together [N/m]
  std::optional<Vec3d> direction;  ///< unit
};

struct World {
  Vec3d gravity{};
  Schedule schedule;
  std::optional<Vec3d> up;  ///< in pictures; default: against gravity
};

// ------------------------------------------------------------------------------------------------ solver
enum class SolverKind { statics, implicit_euler, bdf2, newmark, midpoint, central_differences, modes };
constexpr bool is_implicit_dynamics(SolverKind kind) {
  return kind == SolverKind::implicit_euler || kind == SolverKind::bdf2 || kind == SolverKind::newmark ||
         kind == SolverKind::midpoint;
}
constexpr bool is_dynamic(SolverKind kind) {
  return is_implicit_dynamics(kind) || kind == SolverKind::central_differences;
}

enum class OnLimit { stop, proceed };

enum class StaticControl { load, displacement, arc_length };

/// The displacement that control = "displacement" prescribes.
struct ControlledDisplacement {
  std::string body;
  Vec3d at{};  ///< rest position [m]
  Place at_place;
  Vec3d direction{};
  std::optional<double> to;  ///< [m]
};

struct Solver {
  Place place;
  SolverKind kind = SolverKind::statics;
  double time_step = 0;  ///< [s]; 0 where it is automatic
  Place time_step_place;
  bool time_step_automatic = false;  ///< central differences: a safe fraction of the stable step, and `steps` is open
  int steps = 0;                     ///< dynamic kinds: from `steps`, or duration / time_step rounded up
  std::optional<double> duration;    ///< [s], where it was given
  int load_steps = 0;                ///< 0: automatic
  StaticControl control = StaticControl::load;
  std::optional<ControlledDisplacement> controlled;
  int max_steps = 500;  ///< of a path that is followed
  int modes = 10;
  int newton_max_iterations = 50;
  double newton_tolerance = 1e-8;
  OnLimit on_limit = OnLimit::stop;
  LinearMethod linear = LinearMethod::automatic;
  PreconditionerKind preconditioner = PreconditionerKind::automatic;
  int linear_max_iterations = 1000;
  double linear_tolerance = 1e-6;
  bool full_tangent = true;
  double imperfection = 0;  ///< of statics: part of the largest body by which the lowest mode bends it
  Place imperfection_place;
  bool accept_unstable = false, accept_inverted = false;  ///< ends of statics that count as converged all the same
  std::string precision = "double";                       ///< "double", "mixed", "single"
  std::string backend = "auto";                           ///< "auto", "cpu", "cuda"
  int gpus = 1;
  int threads = 0;
  bool step_open = false;    ///< time_step is left out, under a need
  bool scheme_open = false;  ///< kind is left out beside a duration, under a need
};

// ------------------------------------------------------------------------------------------------ results
enum class Quantity {
  displacement,
  position,
  rotation,
  velocity,
  strain,
  stress,  // at points
  force,
  moment,  // on constrained or loaded nodes
  volume,
  mass,
  energy,
  kinetic_energy,
  total_energy,
  momentum,
  angular_momentum,
  max_displacement,
  mean_displacement,
  frequency,
  fluid_volume,
  fluid_pressure
};

struct Probe {
  Place place;
  std::string name;
  std::optional<std::string> body;
  Quantity quantity = Quantity::displacement;
  std::vector<Vec3d> at;
  Place at_place;
  bool at_is_list = false;  ///< `at` was a list of points: the value is a list
  std::optional<Region> where;
  std::optional<Vec3d> about;
};

struct Picture {
  Vec3d view{{1, 1, 1}};
  std::array<int, 2> size{1200, 800};
  std::string field = "von_mises";
  std::optional<std::array<double, 2>> range;  ///< of the colours, in SI
};

/// Which other meshes estimate the errors of results: finer ones where they are small, else coarser ones.
enum class EstimateBy { automatic, finer, coarser };

struct Output {
  Place place;
  std::filesystem::path directory;
  double every = 0;     ///< [s]; 0: not given
  int every_steps = 0;  ///< 0: not given
  std::vector<std::string> fields;
  std::optional<Picture> picture;
  std::optional<EstimateBy> estimate;  ///< none: errors are not estimated
};

struct Scene {
  std::filesystem::path path;
  std::string text;                     ///< of the file
  std::vector<std::string> overrides;   ///< "key.path=value", in their order
  std::vector<std::string> silenced;    ///< names of warnings
  std::map<std::string, Place> places;  ///< of every key that is written, by its full path
  std::string title;
  World world;
  std::vector<Body> bodies;  ///< in the order of the file
  std::vector<Constraint> constraints;
  std::vector<Load> loads;
  std::vector<Coupling> couplings;  ///< in the order of the file
  Solver solver;
  std::vector<Probe> probes;  ///< in the order of the file
  Output output;
  std::optional<StatedNeed> need;

  /// Something is needed, of the scene or of a body.
  bool states_need() const;

  /// Whether a key is written: "loads[0].over".
  bool says(const std::string& key) const { return places.contains(key); }
  /// Where a key is written; where it is not, the table that would hold it.
  Place place_of(const std::string& key) const;
};

}  // namespace fascia::app
