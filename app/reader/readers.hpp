#pragma once

#include "app/reader/table_reader.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

/// From tables that fit the schema to the structs of a scene. Each adds what it finds wrong to the reader's
/// diagnostics.
namespace fascia::app {

/// The region of a key; everything where the key is missing or wrong.
Region read_region(const TableReader& table, std::string_view key);

/// The keys `over` and `profile` of a table.
Schedule read_schedule(const TableReader& table);

Material read_material(const TableReader& table);

/// Named materials, by name. Materials with errors are there too.
using Materials = std::map<std::string, Material>;
Materials read_materials(const TableReader& scene);

/// @param bodies  names of all bodies
/// @param folder  to which paths in the scene are relative
/// @param under_need  the scene states a need: frames and cells may be left out
Body read_body(const TableReader& table, const Materials& materials, const std::vector<std::string>& bodies,
               const std::filesystem::path& folder, bool under_need);
/// The key `domain` of a body.
Domain read_domain(const TableReader& body, const std::vector<std::string>& bodies,
                   const std::filesystem::path& folder);

/// What a domain fills.
enum class Extent {
  solid,
  surface,
  line,
  thin_mesh  ///< sheets and lines of a mesh, perhaps beside solids; or a ring
};
/// By the keys `domain`, `thickness` and `radius` of a body; none where the domain is missing or wrong.
std::optional<Extent> read_extent(const TableReader& body);

/// The key `thickness` of a body; empty where it is missing or wrong.
std::vector<ThicknessUse> read_thickness(const TableReader& body);

/// The keys `thickness` and `radius` of a body.
void read_section(const TableReader& table, Body& body);

/// The keys `frames`, `weights` and `points` of a body.
/// @param bodies  names of all bodies
/// @param folder  to which paths in the scene are relative
void read_discretisation(const TableReader& table, const std::vector<std::string>& bodies,
                         const std::filesystem::path& folder, Body& body);

/// What only tetrahedra and hexahedra take: the cells of their domain, the formulation and remedies.
/// @param body  its model and materials are known
void read_elements(const TableReader& table, Body& body);
/// Reports the keys of read_elements that a meshless body has.
void refuse_element_keys(const TableReader& table);

/// What only shells take: the triangles of their domain, the thickness.
/// @param body  its materials are known
void read_shell(const TableReader& table, Body& body);
/// Reports the keys of read_shell that the domain of another model has.
void refuse_shell_keys(const TableReader& table);
/// The triangles of a generated surface or skin: of a rectangle, annulus, cylinder, ellipsoid or sphere.
/// @param body  its model and domain are known
void read_skin(const TableReader& domain, Body& body);

/// What rigid bodies and surfaces take: the triangles of their domain, the inertia. Reports what they do not take.
/// @param body  its model and domain are known
void read_carrier(const TableReader& table, Body& body);

/// As the key `model` says it.
const char* word(BodyModel model);
/// "is not used by model = "tetrahedra""
std::string unused_by(BodyModel model);
/// Reports a number of cells around, at an index of the list `cells`, that is no multiple of 4.
void check_around(const TableReader& shape, std::size_t index);

/// Where a body names the material of one of its uses, which were read.
Place place_of_material(const TableReader& body, std::size_t use);
/// Reports each material of a body that acts by itself.
void refuse_activation(const TableReader& body, const Body& read, const char* who);
/// Reads fibres, and the active stress along them.
void read_muscle(const TableReader& table, Material& material);
/// Reports each material of a body that relaxes in shear alone.
void refuse_shear_relaxation(const TableReader& body, const Body& read, const char* who);

/// A list of tables of which the first that selects something counts: only the last may have no `where`.
std::vector<TableReader> read_choices(const TableReader& table, std::string_view key);

Constraint read_constraint(const TableReader& table, const std::vector<std::string>& bodies);
Load read_load(const TableReader& table, const std::vector<std::string>& bodies);
World read_world(const TableReader& scene);
Solver read_solver(const TableReader& scene, const std::vector<std::string>& bodies);

/// Something is needed, of the scene or of a body.
bool states_need(const TableReader& scene);
/// The keys `need`, and what contradicts them. @param scene  has everything else
void read_need(const TableReader& table, Scene& scene);
/// "; or state a [need], by which it is chosen"
extern const char* const kNeedWouldChoose;

/// The kind of the solver, under a need of a duration alone any of dynamics; none where it is wrong.
std::optional<SolverKind> read_solver_kind(const TableReader& scene);

/// @param kind  of the solver; without it what depends on it is not checked
Probe read_probe(const TableReader& table, const std::vector<std::string>& bodies, std::optional<SolverKind> kind);

/// @param scene_name  names the default directory
/// @param shells  there are shells, or bodies that could not be read
Output read_output(const TableReader& scene, const std::string& scene_name, std::optional<SolverKind> kind,
                   bool shells);

/// The body that a table's key `body` names; empty where it names none, which is reported.
std::string read_body_name(const TableReader& table, const std::vector<std::string>& bodies);
/// Reports a name that is not that of another body than `own`.
void check_other_body(const std::string& name, const Place& place, const std::string& own,
                      const std::vector<std::string>& bodies, Diagnostics& diagnostics);

Coupling read_coupling(const TableReader& table, const std::vector<std::string>& bodies);

/// Reports surfaces that no coupling carries.
/// @param names  of all bodies; couplings of others, which are reported elsewhere, may carry any surface
void check_surfaces(const Scene& scene, const std::vector<std::string>& names, Diagnostics& diagnostics);
/// Reports a constraint of a body that has nothing to hold.
void check_model(const TableReader& table, const Constraint& constraint, const std::vector<Body>& bodies);
/// Reports a probe of something that its body does not have.
void check_model(const TableReader& table, const Probe& probe, const std::vector<Body>& bodies);

}  // namespace fascia::app
