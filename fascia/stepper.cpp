#include "fascia/stepper.hpp"

#include "assembly/actions/actions.hpp"
#include "assembly/build/build_simulation.hpp"
#include "assembly/simulation/held_forces.hpp"
#include "assembly/simulation/matter.hpp"
#include "assembly/simulation/probe_values.hpp"
#include "assembly/simulation/solver_settings.hpp"
#include "assembly/specification/check.hpp"
#include "core/base/clock.hpp"
#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "core/math/rotation.hpp"
#include "core/run/model_stepper.hpp"
#include "fascia/choose_backend.hpp"
#include "fascia/run/state_views.hpp"
#include "gpu/run/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace fascia {

namespace {
/// Refuses what a stepper does not advance: other kinds of solution are runs of their own.
void require_steps(const Scene& scene) {
  const Solver& solver = scene.solver;
  const auto refuse = [&](const char* what) {
    throw SceneError({{solver.place, fmt::format("a stepper does not take {}; use statics with control by loads, or an "
                                                 "implicit scheme",
                                                 what)}});
  };
  if (solver.kind == SolverKind::modes) refuse("modes");
  if (solver.kind == SolverKind::central_differences) refuse("explicit dynamics");
  if (solver.control != StaticControl::load) refuse("paths past limit points");
  if (solver.gpus > 1) refuse("several GPUs");
  if (scene.states_need()) refuse("a scene that states a need, whose resolution `fascia run` chooses");
}

Simulation built(Scene scene) {
  name_places(scene);
  require_steps(scene);
  return build_checked(std::move(scene));
}

/// Calls a function; errors of a device become those that programs see.
template <class Call>
decltype(auto) translated(const Call& call) {
  try {
    return call();
  } catch (const std::exception& e) {
    if (is_of_device(e)) throw BackendError(e.what());
    throw;
  }
}

bool is_finite(const Vec3d& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }

}  // namespace

/// x = center + (I + D) (X − center) + u.
struct DriverPose {
  Mat3d D{};
  Vec3d u{}, center{};

  /// This motion, told about another center.
  DriverPose about(const Vec3d& c) const { return {D, u + D * (c - center), c}; }
};

struct Snapshot::Data {
  SteppingSnapshot steps;
  std::vector<DriverPose> from, to;  ///< of drivers
  std::vector<double> dials, next_dials;
  ReachedForces reached;               ///< with the inertia of the step that led there
  std::shared_ptr<const int> stepper;  ///< whose it is
};

struct Stepper::Parts {
  explicit Parts(Scene scene)
      : simulation(built(std::move(scene))), pool(simulation.scene.solver.threads), from(simulation.drivers.size()) {
    add_imperfection(simulation);
    to = from;
    next_dials = simulation.dial_values;
    const Solver& solver = simulation.scene.solver;
    SolverSettings settings = settings_of(solver);
    settings.stops = [this] { return stop.stop_requested(); };
    const SteppingSettings stepping{solver.kind == SolverKind::statics, scheme_of(solver.kind), solver.load_steps};
    backend = solver.backend == "cuda" ? choose_backend(simulation) : Backend::cpu;
    if (const std::string lost = not_as_asked(simulation, backend); !lost.empty())
      simulation.warnings.add("backend", lost);
    steps = backend == Backend::cuda ? gpu::make_stepper(simulation.model, simulation.initial, settings, stepping)
                                     : make_stepper(simulation.model, simulation.initial, pool, settings, stepping);
    if (settings.budget > 0) warm_up(solver.time_step);
  }

  /// Tries steps of this length, so that the first one is no slower than others.
  void warm_up(double dt) {
    try {
      if (const std::string no = steps->warm_up(factors(simulation.initial.time, dt), dt); !no.empty())
        simulation.warnings.add("budget", no);
    } catch (const StateError& e) {
      simulation.warnings.add("budget", e.what());
    }
  }

  bool statics() const { return simulation.scene.solver.kind == SolverKind::statics; }

  /// Factors of all schedules during a step.
  FactorFunction factors(double start, double dt) const {
    return [this, start, dt](double time) {
      const bool ends = dt > 0 && time >= start + dt;
      const double part = ends ? 1.0 : dt > 0 ? std::clamp((time - start) / dt, 0.0, 1.0) : 0.0;
      std::vector<double> dials = simulation.dial_values;
      for (std::size_t d = 0; d < dials.size(); ++d) dials[d] = std::lerp(dials[d], next_dials[d], part);
      std::vector<double> f = simulation.factors(statics() ? std::min(time, 1.0) : time, dials);
      for (const Driver& driver : simulation.drivers)
        f[at(simulation.model.motions[at(driver.motion)].schedule)] = part;
      return f;
    };
  }

  /// Tells the model how drivers move in the next step: from where they are, to where they were told to go.
  void place_motions(const std::vector<DriverPose>& ends) {
    for (std::size_t k = 0; k < from.size(); ++k) {
      const DriverPose start = from[k].about(ends[k].center);
      const Vec3d turn = rotation_vector(compose_increments(ends[k].D, transpose(start.D)));
      const double angle = norm(turn);
      PrescribedMotion& m = simulation.model.motions[at(simulation.drivers[k].motion)];
      m.center = start.center;
      m.D_start = start.D;
      m.u_start = start.u;
      m.translation = ends[k].u - start.u;
      m.angle = angle;
      m.axis = angle > 0 ? turn * (1 / angle) : Vec3d{{0, 0, 1}};
    }
  }

  const State& state() {
    return translated([&]() -> const State& { return steps->state(); });
  }

  /// Reads what acts at the present state. @param with_forces  whether probes need them or not
  const ReachedForces& acting(bool with_forces) {
    ReachedParts parts = needed_parts(simulation);
    parts.forces = parts.forces || with_forces;
    if (read && (has_forces || !parts.forces)) return reached;
    translated([&] { steps->read(factors(steps->state().time, 0), parts, reached); });
    read = true;
    has_forces = parts.forces;
    return reached;
  }
  /// Reads forces too, now and after each step from now on: a step that fails takes with it what led there.
  const ReachedForces& forces() {
    forces_are_asked = true;
    return acting(true);
  }

  /// Drivers and dials have arrived, or stay where they were. What is read from here on stands still.
  void end_step(bool converged) {
    (converged ? from : to) = converged ? to : from;
    (converged ? simulation.dial_values : next_dials) = converged ? next_dials : simulation.dial_values;
    place_motions(from);
    stop = {};
    if (converged) read = false;  // else the state, and what acted there, stays
  }

  /// Fills what was asked for with the present state.
  void refresh() {
    if (forces_are_asked) acting(true);
    if (views.any() || state_is_seen) views.fill(state(), reached);
  }

  /// Refuses a step at whose end the fluid of a body would have no volume without pressure.
  void require_volumes(double dt) const {
    const double end = steps->time() + dt;
    const std::vector<double> at_end = factors(steps->time(), dt)(end);
    for (const FluidOfBody& fluid : simulation.fluids) {
      const SurfaceLoad& load = simulation.model.surfaces[at(fluid.surface)];
      const double volume = load.rest_volume + at_end[at(load.schedule)] * (load.volume - load.rest_volume);
      if (load.bulk_modulus > 0 && volume <= 0)
        throw InputError(
            fmt::format("the fluid in the body \"{}\" is given a volume of {:.6g} m3 at {:.6g}; must be "
                        "above 0: set its dial nearer to 0",
                        simulation.bodies[at(fluid.body)].name, volume, end));
    }
  }
  void require_driver(int driver) const {
    if (driver < 0 || at(driver) >= to.size())
      throw InputError(fmt::format("there is no driver number {}; the scene has {}", driver, to.size()));
  }
  void require_dial(int dial) const {
    if (dial < 0 || at(dial) >= next_dials.size())
      throw InputError(fmt::format("there is no dial number {}; the scene has {}", dial, next_dials.size()));
  }
  void require_body(int body) const {
    if (body < 0 || at(body) >= simulation.bodies.size())
      throw InputError(fmt::format("there is no body number {}; the scene has {}", body, simulation.bodies.size()));
  }

  std::shared_ptr<const int> identity = std::make_shared<const int>(0);
  Simulation simulation;
  ThreadPool pool;
  Backend backend = Backend::cpu;
  std::unique_ptr<ModelStepper> steps;
  std::vector<DriverPose> from, to;  ///< of drivers: where they are, and where the next step takes them
  std::vector<double> next_dials;
  std::stop_token stop;  ///< of the step that runs
  StateViews views{simulation};
  bool forces_are_asked = false;
  bool state_is_seen = false;  ///< displacements or velocities were asked for
  ReachedForces reached;
  bool read = false;        ///< it is that of the present state
  bool has_forces = false;  ///< so far as it is read
};

Stepper::Stepper(Scene scene) {
  parts_ = translated([&] { return std::make_unique<Parts>(std::move(scene)); });
}
Stepper::~Stepper() = default;
Stepper::Stepper(Stepper&&) noexcept = default;
Stepper& Stepper::operator=(Stepper&&) noexcept = default;

StepReport Stepper::step(double dt, const std::stop_token& stop) {
  if (!(dt > 0) || !std::isfinite(dt)) throw InputError(fmt::format("a step of {} s; must be above 0", dt));
  if (time() + dt == time())
    throw InputError(fmt::format("a step of {} s is lost beside the time, {} s; take a longer one", dt, time()));
  Parts& p = *parts_;
  if (!p.simulation.fluids.empty()) p.require_volumes(dt);
  p.place_motions(p.to);
  const Clock::time_point start = Clock::now();
  RunReport run;
  p.stop = stop;
  try {
    run = translated([&] { return p.steps->step(p.factors(time(), dt), dt); });
  } catch (...) {
    p.end_step(false);
    throw;
  }
  StepReport report;
  report.converged = run.status == RunStatus::converged;
  report.stopped = run.status == RunStatus::interrupted;
  report.at_limit = run.steps_at_limit > 0;
  report.out_of_time = run.steps_out_of_time > 0;
  report.stable = !run.stability.is_unstable();
  report.message = run.message;
  report.newton_iterations = run.newton_iterations;
  report.linear_iterations = run.linear_iterations;
  report.residual = run.residual;
  p.end_step(report.converged);
  p.refresh();
  report.seconds = seconds_since(start);
  report.time = time();
  return report;
}

double Stepper::time() const { return parts_->steps->time(); }
Backend Stepper::backend() const { return parts_->backend; }
std::vector<std::string> Stepper::warnings() const { return parts_->simulation.warnings.summary(); }

int Stepper::driver(std::string_view name) const {
  const std::vector<Driver>& drivers = parts_->simulation.drivers;
  const auto found = std::find_if(drivers.begin(), drivers.end(), [&](const Driver& d) { return d.name == name; });
  if (found == drivers.end())
    throw InputError(fmt::format("no constraint names a driver \"{}\"; set Constraint::driver", name));
  return static_cast<int>(found - drivers.begin());
}

void Stepper::set_motion(int driver, const RigidMotion& motion) {
  Parts& p = *parts_;
  p.require_driver(driver);
  if (!is_finite(motion.translation) || !is_finite(motion.rotation) || !is_finite(motion.center))
    throw InputError(fmt::format("the motion of the driver \"{}\" has a number that is not finite",
                                 p.simulation.drivers[at(driver)].name));
  p.to[at(driver)] = {rotation_increment(motion.rotation), motion.translation, motion.center};
}

RigidMotion Stepper::motion(int driver) const {
  const Parts& p = *parts_;
  p.require_driver(driver);
  const DriverPose& pose = p.from[at(driver)];
  return {pose.u, rotation_vector(pose.D), pose.center};
}

Wrench Stepper::driver_force(int driver, const std::optional<Vec3d>& about) {
  Parts& p = *parts_;
  p.require_driver(driver);
  const Driver& of = p.simulation.drivers[at(driver)];
  if (about && !is_finite(*about))
    throw InputError(fmt::format("the point for the moment of the driver \"{}\" is not finite", of.name));
  const DriverPose& pose = p.from[at(driver)];
  const Wrench w =
      force_of_motion(p.simulation, p.state(), p.forces(), of.motion, about.value_or(pose.center + pose.u));
  if (!is_finite(w.force) || !is_finite(w.moment))
    throw StateError(fmt::format("the force of the driver \"{}\" is not finite", of.name));
  return w;
}

int Stepper::dial(std::string_view name) const {
  const std::vector<Dial>& dials = parts_->simulation.dials;
  const auto found = std::find_if(dials.begin(), dials.end(), [&](const Dial& d) { return d.name == name; });
  if (found == dials.end())
    throw InputError(fmt::format("no load, motion, fluid or gravity that acts names a dial \"{}\"", name));
  return static_cast<int>(found - dials.begin());
}

void Stepper::set_dial(int dial, double value) {
  Parts& p = *parts_;
  p.require_dial(dial);
  if (!std::isfinite(value))
    throw InputError(
        fmt::format("the value of the dial \"{}\" is {}; must be finite", p.simulation.dials[at(dial)].name, value));
  p.next_dials[at(dial)] = value;
}

double Stepper::dial_value(int dial) const {
  parts_->require_dial(dial);
  return parts_->simulation.dial_values[at(dial)];
}

int Stepper::body(std::string_view name) const {
  const std::vector<SimulatedBody>& bodies = parts_->simulation.bodies;
  const auto found = std::find_if(bodies.begin(), bodies.end(), [&](const SimulatedBody& b) { return b.name == name; });
  if (found == bodies.end()) throw InputError(fmt::format("there is no body \"{}\" in the scene", name));
  return static_cast<int>(found - bodies.begin());
}
int Stepper::node_count() const { return parts_->simulation.model.node_count(); }
int Stepper::first_node(int body) const {
  parts_->require_body(body);
  return parts_->simulation.bodies[at(body)].body->first_node();
}
int Stepper::node_count(int body) const {
  parts_->require_body(body);
  return parts_->simulation.bodies[at(body)].body->node_count();
}

Rows Stepper::displacements() {
  parts_->state_is_seen = true;
  return {parts_->state().u[0].v, node_count(), 3};
}
Rows Stepper::velocities() {
  parts_->state_is_seen = true;
  return {parts_->state().v[0].v, node_count(), 3};
}
Rows Stepper::positions() { return parts_->views.positions(parts_->state()); }
Rows Stepper::rotations() { return parts_->views.rotations(parts_->state()); }
Rows Stepper::forces() { return parts_->views.forces(parts_->forces()); }

std::span<const std::array<int, 3>> Stepper::surface_triangles(int body) const {
  parts_->require_body(body);
  return parts_->simulation.bodies[at(body)].body->surface().triangles;
}
Rows Stepper::surface_points(int body) {
  parts_->require_body(body);
  return parts_->views.surface(at(body), parts_->state());
}

int Stepper::inverted_points(int body) {
  parts_->require_body(body);
  return folded_points(parts_->simulation.bodies[at(body)], parts_->state()).inverted;
}

std::vector<double> Stepper::probe(std::string_view name) {
  Parts& p = *parts_;
  const std::size_t index = probe_index(p.simulation, name);
  const ReachedForces& acting = needed_parts(p.simulation).forces ? p.forces() : p.acting(false);
  return probe_value(p.simulation, index, {&p.state(), &acting, 0, 0});
}

Snapshot Stepper::snapshot() {
  Parts& p = *parts_;
  Snapshot out;
  const FactorFunction factors = p.factors(time(), 0);
  ReachedForces reached = p.acting(true);
  SteppingSnapshot steps = translated([&] { return p.steps->snapshot(factors); });
  out.data_ = std::make_shared<Snapshot::Data>(Snapshot::Data{std::move(steps), p.from, p.to, p.simulation.dial_values,
                                                              p.next_dials, std::move(reached), p.identity});
  return out;
}

void Stepper::restore(const Snapshot& snapshot) {
  Parts& p = *parts_;
  if (!snapshot.data_) throw InputError("an empty snapshot; take one with snapshot()");
  const Snapshot::Data& data = *snapshot.data_;
  if (data.stepper != p.identity) throw InputError("a snapshot of another stepper; take one of this one");
  p.from = data.from;
  p.to = data.to;
  p.simulation.dial_values = data.dials;
  p.next_dials = data.next_dials;
  p.place_motions(p.from);
  translated([&] { p.steps->restore(data.steps, p.factors(data.steps.state.time, 0)); });
  p.reached = data.reached;
  p.read = p.has_forces = true;
  p.refresh();
}

}  // namespace fascia
