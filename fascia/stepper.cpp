#include "fascia/stepper.hpp"

#include "assembly/actions/actions.hpp"
#include "assembly/build/build_simulation.hpp"
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

/// x = center + (I + D) (X − center) + u.
struct Pose {
  Mat3d D{};
  Vec3d u{}, center{};

  /// This motion, told about another center.
  Pose about(const Vec3d& c) const { return {D, u + D * (c - center), c}; }
};

/// A view that was asked for, which every step fills again.
struct Buffer {
  bool wanted = false;
  std::vector<double> values;
};

}  // namespace

struct Snapshot::Data {
  SteppingSnapshot steps;
  std::vector<Pose> from, to;          ///< of drivers
  ReachedForces reached;               ///< with the inertia of the step that led there
  std::shared_ptr<const int> stepper;  ///< whose it is
};

struct Stepper::Parts {
  explicit Parts(Scene scene)
      : simulation(built(std::move(scene))), pool(simulation.scene.solver.threads), from(simulation.drivers.size()) {
    add_imperfection(simulation);
    to = from;
    const Solver& solver = simulation.scene.solver;
    SolverSettings settings = settings_of(solver);
    const SteppingSettings stepping{solver.kind == SolverKind::statics, scheme_of(solver.kind), solver.load_steps};
    backend = solver.backend == "cuda" ? choose_backend(simulation) : Backend::cpu;
    if (const std::string lost = not_as_asked(simulation, backend); !lost.empty())
      simulation.warnings.add("backend", lost);
    const State& start = simulation.initial;
    steps = backend == Backend::cuda ? gpu::make_stepper(simulation.model, start, settings, stepping)
                                     : make_stepper(simulation.model, start, pool, settings, stepping);
    surfaces.resize(simulation.bodies.size());
    attached.resize(simulation.bodies.size());
  }

  bool statics() const { return simulation.scene.solver.kind == SolverKind::statics; }

  /// Factors of all schedules during a step.
  FactorFunction factors(double start, double dt) const {
    return [this, start, dt](double time) {
      std::vector<double> f = simulation.factors(statics() ? std::min(time, 1.0) : time);
      const bool ends = dt > 0 && time >= start + dt;
      const double part = ends ? 1.0 : dt > 0 ? std::clamp((time - start) / dt, 0.0, 1.0) : 0.0;
      for (const Driver& driver : simulation.drivers)
        f[at(simulation.model.motions[at(driver.motion)].schedule)] = part;
      return f;
    };
  }

  /// Tells the model how drivers move in the next step: from where they are, to where they were told to go.
  void place_motions(const std::vector<Pose>& ends) {
    for (std::size_t k = 0; k < from.size(); ++k) {
      const Pose start = from[k].about(ends[k].center);
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
  const ReachedForces& acting() { return acting(forces.wanted); }

  /// Drivers have arrived, or stay where they were. What is read from here on stands still.
  void end_step(bool converged) {
    (converged ? from : to) = converged ? to : from;
    place_motions(from);
    if (converged) read = false;  // else the state, and what acted there, stays
  }

  /// Fills what was asked for with the present state.
  void refresh() {
    const bool none = !positions.wanted && !rotations.wanted && !forces.wanted && !state_is_seen &&
                      std::none_of(surfaces.begin(), surfaces.end(), [](const Buffer& b) { return b.wanted; });
    if (none) return;
    const State& state = this->state();
    if (positions.wanted) fill_positions(state);
    if (rotations.wanted) fill_rotations(state);
    if (forces.wanted) fill_forces();
    for (std::size_t b = 0; b < surfaces.size(); ++b)
      if (surfaces[b].wanted) fill_surface(b, state);
  }

  void fill_positions(const State& state) {
    double* out = positions.values.data();
    for (std::size_t i = 0; i < state.u.size(); ++i) {
      const Vec3d x = simulation.model.rest_position[i] + state.u[i];
      for (int k = 0; k < 3; ++k) *out++ = x[k];
    }
  }
  void fill_rotations(const State& state) {
    double* out = rotations.values.data();
    for (std::size_t i = 0; i < state.u.size(); ++i) {
      const Mat3d Q = Mat3d::identity() + state.D[i];
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) *out++ = Q(r, c);
    }
  }
  void fill_forces() {
    const std::vector<double> held = held_forces(simulation, acting());
    for (int i = 0; i < simulation.model.node_count(); ++i)
      std::copy_n(held.data() + simulation.model.points.dofs.begin(i), 3, forces.values.data() + 3 * at(i));
    for (const TetheredMaterial& m : simulation.tethered) {
      if (squared_norm(simulation.model.tethers[at(m.tether)].arm) > 0) continue;  // a couple
      for (int k = 0; k < 3; ++k) forces.values[at(3 * m.frame + k)] += reached.tether_forces[at(m.tether)][k];
    }
  }
  void fill_surface(std::size_t body, const State& state) {
    const std::vector<Vec3d>& rest = simulation.bodies[body].body->surface().points;
    double* out = surfaces[body].values.data();
    for (std::size_t p = 0; p < rest.size(); ++p) {
      const Vec3d x = rest[p] + field_at(attached[body][p], state).u;
      for (int k = 0; k < 3; ++k) *out++ = x[k];
    }
  }

  Rows nodes_view(Buffer& buffer, int columns) {
    const int rows = simulation.model.node_count();
    if (!std::exchange(buffer.wanted, true)) buffer.values.resize(at(rows) * at(columns));
    return {buffer.values.data(), rows, columns};
  }
  void require_driver(int driver) const {
    if (driver < 0 || at(driver) >= to.size())
      throw InputError(fmt::format("there is no driver number {}; the scene has {}", driver, to.size()));
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
  std::vector<Pose> from, to;  ///< of drivers: where they are, and where the next step takes them
  Buffer positions, rotations, forces;
  std::vector<Buffer> surfaces;
  std::vector<std::vector<Attachment>> attached;  ///< of the points of surfaces that were asked for
  bool state_is_seen = false;                     ///< displacements or velocities were asked for
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

StepReport Stepper::step(double dt) {
  if (!(dt > 0) || !std::isfinite(dt)) throw InputError(fmt::format("a step of {} s; must be above 0", dt));
  if (time() + dt == time())
    throw InputError(fmt::format("a step of {} s is lost beside the time, {} s; take a longer one", dt, time()));
  Parts& p = *parts_;
  p.place_motions(p.to);
  const Clock::time_point start = Clock::now();
  RunReport run;
  try {
    run = translated([&] { return p.steps->step(p.factors(time(), dt), dt); });
  } catch (...) {
    p.end_step(false);
    throw;
  }
  StepReport report;
  report.converged = run.status == RunStatus::converged;
  report.at_limit = run.steps_at_limit > 0;
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
  const Pose& pose = p.from[at(driver)];
  return {pose.u, rotation_vector(pose.D), pose.center};
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
Rows Stepper::positions() {
  const bool filled = parts_->positions.wanted;
  const Rows view = parts_->nodes_view(parts_->positions, 3);
  if (!filled) parts_->fill_positions(parts_->state());
  return view;
}
Rows Stepper::rotations() {
  const bool filled = parts_->rotations.wanted;
  const Rows view = parts_->nodes_view(parts_->rotations, 9);
  if (!filled) parts_->fill_rotations(parts_->state());
  return view;
}
Rows Stepper::forces() {
  const bool filled = parts_->forces.wanted;
  const Rows view = parts_->nodes_view(parts_->forces, 3);
  if (!filled) parts_->fill_forces();
  return view;
}

std::span<const std::array<int, 3>> Stepper::surface_triangles(int body) const {
  parts_->require_body(body);
  return parts_->simulation.bodies[at(body)].body->surface().triangles;
}
Rows Stepper::surface_points(int body) {
  parts_->require_body(body);
  Parts& p = *parts_;
  const ModelBody& of = *p.simulation.bodies[at(body)].body;
  const std::size_t count = of.surface().points.size();
  Buffer& buffer = p.surfaces[at(body)];
  if (!buffer.wanted) {
    buffer.values.resize(3 * count);
    std::vector<Attachment> attached;
    for (std::size_t i = 0; i < count; ++i) attached.push_back(of.attach_surface(i));
    p.attached[at(body)] = std::move(attached);
    p.fill_surface(at(body), p.state());
    buffer.wanted = true;
  }
  return {buffer.values.data(), static_cast<int>(count), 3};
}

int Stepper::inverted_points(int body) {
  parts_->require_body(body);
  return folded_points(parts_->simulation.bodies[at(body)], parts_->state()).inverted;
}

std::vector<double> Stepper::probe(std::string_view name) {
  Parts& p = *parts_;
  const std::size_t index = probe_index(p.simulation, name);
  const ReachedForces& acting = p.acting();
  return probe_value(p.simulation, index, {&p.state(), &acting, 0, 0});
}

Snapshot Stepper::snapshot() {
  Parts& p = *parts_;
  Snapshot out;
  const FactorFunction factors = p.factors(time(), 0);
  ReachedForces reached = p.acting(true);
  SteppingSnapshot steps = translated([&] { return p.steps->snapshot(factors); });
  out.data_ =
      std::make_shared<Snapshot::Data>(Snapshot::Data{std::move(steps), p.from, p.to, std::move(reached), p.identity});
  return out;
}

void Stepper::restore(const Snapshot& snapshot) {
  Parts& p = *parts_;
  if (!snapshot.data_) throw InputError("an empty snapshot; take one with snapshot()");
  const Snapshot::Data& data = *snapshot.data_;
  if (data.stepper != p.identity) throw InputError("a snapshot of another stepper; take one of this one");
  p.from = data.from;
  p.to = data.to;
  p.place_motions(p.from);
  translated([&] { p.steps->restore(data.steps, p.factors(data.steps.state.time, 0)); });
  p.reached = data.reached;
  p.read = p.has_forces = true;
  p.refresh();
}

}  // namespace fascia
