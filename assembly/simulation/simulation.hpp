#pragma once

#include "assembly/simulation/regions.hpp"
#include "assembly/specification/scene.hpp"
#include "assembly/specification/warnings.hpp"
#include "core/body/model_body.hpp"
#include "core/run/controlled_point.hpp"
#include "core/structure/model.hpp"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fascia {

/// Faces of another body that a tissue is attached to.
struct Interface {
  int body = 0;
  TriangleMesh faces;
};

/// A body of the scene in the model.
struct SimulatedBody {
  std::string name;
  std::unique_ptr<ModelBody> body;
  std::vector<int> node_ids;  ///< of the model: its own, then those that it shares
  std::vector<Vec3d> nodes;   ///< their rest positions [m]
  std::vector<char> node_on_boundary;
  std::vector<char> surface_on_boundary;     ///< ones, for each point of the surface
  std::string gap;                           ///< what it fills between two bodies, in words
  std::vector<FrameInertia> shared_inertia;  ///< its own on the nodes that it shares
  std::vector<FrameInertia> shared_damping;  ///< the same weighted with α, as Model::mass_damping
  std::vector<double> lumped_mass;           ///< of its nodes, where a static weight is shared otherwise [kg]
  std::vector<Interface> interfaces;         ///< its own frames on these follow the other body

  /// The nodes, for regions.
  Selectable selectable_nodes() const;
  /// Points of the surface, all on the boundary.
  Selectable selectable_surface() const;
  /// Index into `nodes` of one of its nodes.
  std::size_t index_of(int node) const;
  bool vertices = false;  ///< its nodes do not turn
  const char* node_word() const { return vertices ? "node" : "frame"; }
  const std::vector<BodyGroup>* groups() const;  ///< null where the body has no mesh
};

/// Where a probe's point is attached.
struct ProbePoint {
  Vec3d X{};
  Attachment field;
  std::size_t nearest = 0;  ///< integration point
};

/// Material that a constraint ties to where it belongs.
struct TetheredMaterial {
  int tether = 0;           ///< of the model
  int body = 0, frame = 0;  ///< model node of the nearest frame
  std::vector<Vec3d> axes;  ///< directions, of a tether with an arm rotations, that are held
  Attachment field;
};

/// A probe with what it selects resolved.
struct ResolvedProbe {
  const Probe* probe = nullptr;
  int body = -1;  ///< −1: the whole scene
  std::vector<ProbePoint> points;
  std::vector<int> nodes;     ///< of the model, by `where`
  std::vector<int> tethered;  ///< of Simulation::tethered
  int fluid = -1;             ///< of Simulation::fluids
  Vec3d about{};              ///< of moments and angular momentum
};

/// A weld, embedding or spring of the scene in the model.
struct BuiltCoupling {
  std::vector<int> nodes;    ///< of the model, that it couples
  std::vector<int> springs;  ///< of the point set
};

/// What fills a body.
struct FluidOfBody {
  int body = 0, surface = 0;  ///< the latter of the model
};

/// A motion that the caller gives before each step.
struct Driver {
  std::string name;
  int motion = 0;  ///< of the model
};

/// A number that the caller gives before each step, which multiplies the factors of some schedules.
struct Dial {
  std::string name;
  std::vector<int> schedules;
};

/// A scene ready to run.
struct Simulation {
  Scene scene;
  Model model;
  std::vector<SimulatedBody> bodies;
  std::vector<Schedule> schedules;  ///< index = DeadLoad::schedule and so on
  std::vector<ResolvedProbe> probes;
  std::vector<TetheredMaterial> tethered;
  std::vector<FluidOfBody> fluids;
  std::vector<Driver> drivers;
  std::vector<Dial> dials;
  std::vector<double> dial_values;              ///< at the present state
  std::vector<BuiltCoupling> couplings;         ///< of Scene::couplings
  std::vector<FrameInertia> dependent_inertia;  ///< of dependent nodes, before their hosts took it over
  std::vector<FrameInertia> dependent_damping;  ///< what their hosts took over of Model::mass_damping; or empty
  std::optional<ControlledPoint> controlled;    ///< of control = "displacement"
  State initial;
  Warnings warnings;
  int gravity_load = -1;   ///< index of gravity in Model::loads
  double stable_step = 0;  ///< of central differences [s]

  /// Factors of all schedules at a time, with the present values of dials, or with others.
  std::vector<double> factors(double time) const { return factors(time, dial_values); }
  std::vector<double> factors(double time, std::span<const double> dials_then) const;
};

/// Time between saved states of a dynamic run that names none [s].
inline constexpr double kDefaultEvery = 0.04;

/// Time between saved states [s]; 0: they are counted by steps.
double saving_time(const Output& output);

struct FluidState {
  double volume = 0, pressure = 0;  ///< [m³]; at the level of its centre at rest [Pa]
};
FluidState fluid_state(const Simulation& simulation, int fluid, const State& state);
/// Registers a schedule. @throws SceneError a sine in statics, which has no time; "smooth" where a path is followed
int new_schedule(Simulation& simulation, const Schedule& schedule, const Place& place);
int body_index(const Simulation& simulation, const std::string& name);
/// A rest position as a point of a body: within 1e-3 of its size it counts as on it, with a message.
/// @throws SceneError further away
Vec3d place_on_body(Simulation& simulation, int body, const Vec3d& X, const Place& place);
/// Mean distance of a body's nodes to their nearest one [m].
double mean_spacing(const SimulatedBody& body);
/// Model nodes of a body that a region selects, ascending; none or more. A rigid body's frame is selected with any
/// point of its surface.
std::vector<int> find_nodes(const Simulation& simulation, int body, const Region& region);
/// The same. @throws SceneError where it selects none
std::vector<int> select_nodes(const Simulation& simulation, int body, const Region& region);

}  // namespace fascia
