#include "assembly/build/build_simulation.hpp"

#include "assembly/actions/actions.hpp"
#include "assembly/bodies/bodies.hpp"
#include "assembly/bodies/domains.hpp"
#include "assembly/bodies/neighbours.hpp"
#include "assembly/specification/check.hpp"
#include "assembly/specification/errors.hpp"
#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "core/geometry/bounds.hpp"
#include "core/math/rotation.hpp"
#include "core/solver/boundary_motion.hpp"
#include "core/step/dependents.hpp"
#include "core/structure/dependent_inertia.hpp"
#include "core/structure/inertia.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fascia {

namespace {

void set_initial_motion(Simulation& s, const Body& body, const SimulatedBody& built) {
  const int first = built.body->first_node(), count = built.body->node_count();
  Vec3d center{};
  double mass = 0;
  for (int i = first; i < first + count; ++i) {
    mass += s.model.inertia[at(i)].mass;
    center += s.model.rest_position[at(i)] * s.model.inertia[at(i)].mass + s.model.inertia[at(i)].first;
  }
  const bool moves = squared_norm(body.initial.velocity) + squared_norm(body.initial.angular_velocity) > 0;
  if (moves && !is_dynamic(s.scene.solver.kind))
    throw SceneError(
        {{body.place, "initial motion needs a dynamic solver; remove initial, or use kind = \"implicit-euler\""}});
  if (!moves) return;
  const std::vector<DependentNode>& dependents = s.model.points.dependents;
  const auto following = std::count_if(dependents.begin(), dependents.end(), [&](const DependentNode& d) {
    return d.node >= first && d.node < first + count;
  });
  if (following == count)
    throw SceneError({{body.place,
                       "initial motion is lost on this body: all its nodes belong to other bodies or follow them; give "
                       "those the motion and remove initial"}});
  if (2 * following > count)
    s.warnings.add(
        "initial", s.scene.place_of("bodies." + body.name + ".initial"),
        fmt::format("{} of {} {}s follow other bodies, and start as these do", following, count, built.node_word()));
  const Vec3d about = body.initial.about.value_or(mass > 0 ? center * (1 / mass) : bounds_of(built.nodes).middle()),
              w = body.initial.angular_velocity;
  for (int i = first; i < first + count; ++i) {
    s.initial.v[at(i)] = body.initial.velocity + cross(w, s.model.rest_position[at(i)] - about);
    if (s.model.kind(i) != FrameKind::vertex) s.initial.Q_dot[at(i)] = skew(w);
  }
}

/// Dependent nodes start as their hosts do, frames that turn by themselves with the hosts' mean spin.
void start_dependents(Simulation& s) {
  place_dependent_rates(s.model.points, s.initial);
  for (const DependentNode& d : s.model.points.dependents) {
    if (d.turns || s.model.kind(d.node) == FrameKind::vertex) continue;
    Mat3d rate;
    for (std::size_t k = 0; k < d.hosts.size(); ++k) rate += s.initial.Q_dot[at(d.hosts[k])] * d.w[k];
    s.initial.Q_dot[at(d.node)] = rate;
  }
}

FrameInertia added(const FrameInertia& before, const FrameInertia& after) {
  return {after.mass - before.mass, after.first - before.first, after.second - before.second};
}

/// Of a node; zero where the model has none, or none there yet.
FrameInertia mass_damping_of(const std::vector<FrameInertia>& mass_damping, int node) {
  return at(node) < mass_damping.size() ? mass_damping[at(node)] : FrameInertia{};
}

/// @throws SceneError  a host that would lose its mass
void give_inertia_to_hosts(Simulation& s) {
  const std::vector<FrameInertia> damping = s.model.mass_damping;
  for (const DependentNode& d : s.model.points.dependents) s.dependent_inertia.push_back(s.model.inertia[at(d.node)]);
  try {
    const bool idle = s.scene.solver.kind == SolverKind::statics && squared_norm(s.scene.world.gravity) == 0;
    if (idle)
      move_idle_inertia_to_hosts(s.model);
    else
      move_inertia_to_hosts(s.model);
  } catch (const InputError& e) {
    throw SceneError({{s.scene.couplings.empty() ? s.scene.bodies[0].place : s.scene.couplings[0].place, e.what()}});
  }
  if (damping.empty()) return;
  for (const DependentNode& d : s.model.points.dependents)
    s.dependent_damping.push_back(added(s.model.mass_damping[at(d.node)], damping[at(d.node)]));
}

/// Far from the origin coordinates are rounded to more than a part of the body that answers can do without.
std::string lost_digits(const ModelBody& body, std::span<const Vec3d> nodes) {
  constexpr double fine = 1e-8;  // of the body's size: a fiftieth of it, the width of an element, keeps six digits
  double farthest = 0;
  for (const Vec3d& x : nodes) farthest = std::max(farthest, norm(x));
  const double apart = farthest * std::numeric_limits<double>::epsilon();
  if (!(apart > fine * body.size())) return "";
  return fmt::format(
      "lies {:.3g} m from the origin, where coordinates are {:.2g} m apart: they keep {} digits of its size, {:.3g} m, "
      "and answers fewer; move it nearer with transform.translate, and all that goes with it",
      farthest, apart, std::max(0, static_cast<int>(std::floor(std::log10(body.size() / apart)))), body.size());
}

SimulatedBody built_body(Simulation& s, const Body& body, PointSetBuilder& points, const SampleStore* store) {
  try {
    BodyBuild build{s.model, points, {}, {}, {}, {}, {}, s.scene.solver.threads, store};
    gather_neighbours(s, body, build);
    SimulatedBody b;
    b.name = body.name;
    std::vector<FrameInertia> before, damping;
    if (!build.shared.empty()) before = s.model.inertia;
    if (!build.shared.empty()) damping = s.model.mass_damping;
    b.body = build_body(body, build);
    check_size(body, b.body->size());
    for (const int node : b.body->shared_nodes()) {
      b.shared_inertia.push_back(added(before[at(node)], s.model.inertia[at(node)]));
      b.shared_damping.push_back(added(mass_damping_of(damping, node), mass_damping_of(s.model.mass_damping, node)));
    }
    for (std::size_t i = 0; i < b.body->weights().size(); ++i)
      b.lumped_mass.push_back(s.model.inertia[at(b.body->first_node()) + i].mass);
    give_rotations(s.model, build.shared, *b.body);
    for (const std::string& m : build.messages) s.warnings.add("mesh", body.place, m);
    const char* topic = body.model == BodyModel::meshless ? "sampling" : "mesh";
    for (const std::string& m : b.body->messages()) s.warnings.add(topic, body.place, m);
    for (int i = 0; i < b.body->node_count(); ++i) b.node_ids.push_back(b.body->first_node() + i);
    b.node_ids.insert(b.node_ids.end(), b.body->shared_nodes().begin(), b.body->shared_nodes().end());
    for (const int node : b.node_ids) b.nodes.push_back(s.model.rest_position[at(node)]);
    if (const std::string lost = lost_digits(*b.body, b.nodes); !lost.empty())
      s.warnings.add("far", body.domain_place, lost);
    b.node_on_boundary = b.body->nodes_on_boundary();
    b.surface_on_boundary.assign(b.body->surface().points.size(), 1);
    b.interfaces = std::move(build.interfaces);
    b.gap = std::move(build.gap);
    b.vertices = is_mesh_model(body) || body.model == BodyModel::surface;
    return b;
  } catch (const InputError& e) {
    const Place& place = e.blame == Blame::frames    ? body.frames_place
                         : e.blame == Blame::points  ? body.points_place
                         : e.blame == Blame::weights ? body.weights_place
                                                     : body.domain_place;
    throw SceneError({{place, e.what()}});
  }
}

/// Registers the schedules of muscles, before bodies are built with their numbers.
void add_activations(Simulation& s) {
  for (Body& body : s.scene.bodies)
    for (MaterialUse& use : body.materials) {
      if (!use.material.activation) continue;
      Activation& activation = *use.material.activation;
      if (s.scene.solver.kind == SolverKind::central_differences)
        throw SceneError({{activation.place,
                           "is not available with explicit steps, which do not count its work; use an implicit solver, "
                           "such as kind = \"implicit-euler\""}});
      activation.factor = new_schedule(s, activation.schedule, activation.place);
    }
}

}  // namespace

Simulation build_simulation(Scene scene, const SampleStore* store) {
  Simulation s;
  s.scene = std::move(scene);
  s.warnings = Warnings(s.scene.silenced);
  add_activations(s);
  PointSetBuilder points;
  s.bodies.resize(s.scene.bodies.size());
  for (const std::size_t index : build_order(s.scene)) {
    s.bodies[index] = built_body(s, s.scene.bodies[index], points, store);
    s.bodies[index].body->blocks = points.take_body();
  }
  SceneErrors errors;
  errors.gather([&] { add_constraints(s, points); });
  errors.gather([&] { add_couplings(s, points); });
  s.model.points = std::move(points).finish(s.model.frame_kind);
  for (const SimulatedBody& b : s.bodies) b.body->find_memories(s.model.points);
  if (!s.model.mass_damping.empty()) s.model.mass_damping.resize(s.model.rest_position.size());
  errors.gather([&] { give_inertia_to_hosts(s); });
  s.initial = State::at_rest(s.model);
  for (std::size_t b = 0; b < s.bodies.size(); ++b)
    errors.gather([&] { set_initial_motion(s, s.scene.bodies[b], s.bodies[b]); });
  stop_held(s.model, s.initial);
  start_dependents(s);
  s.initial.turned.resize(s.model.constraints.size());
  errors.gather([&] { add_loads(s); });
  errors.gather([&] { resolve_probes(s); });
  errors.tell();
  if (s.model.constrained_dof_count() == s.model.dof_count() && s.scene.solver.kind == SolverKind::modes)
    throw SceneError(
        {{s.scene.solver.place, "the constraints hold every degree of freedom; leave some free for modes"}});
  const PointSet& set = s.model.points;
  if (s.scene.solver.kind == SolverKind::modes && set.group_count() == 0 && set.blocks.empty() && set.shells.empty() &&
      set.springs.empty())
    throw SceneError({{s.scene.solver.place,
                       "nothing in the scene is elastic, so that nothing vibrates; add springs or a body of another "
                       "model, or use kind = \"implicit-euler\""}});
  if (set.memory.acts()) s.initial.factors = s.factors(0);
  if (s.scene.solver.kind == SolverKind::statics) check_support(s);
  if (s.scene.solver.kind == SolverKind::modes &&
      !(s.model.loads.empty() && s.model.followers.empty() && s.model.surfaces.empty() && !set.memory.acts()))
    s.warnings.add("no-effect",
                   "modes are those of the unloaded rest state: gravity, loads, fluids and active stresses are not "
                   "used");
  const Solver& solver = s.scene.solver;
  const bool path = solver.kind == SolverKind::statics && solver.control != StaticControl::load;
  if (solver.preconditioner != PreconditionerKind::automatic && (solver.linear == LinearMethod::cholesky || path))
    s.warnings.add("no-effect", s.scene.place_of("solver.linear.preconditioner"),
                   fmt::format("does nothing {}, which makes factors: it is of conjugate gradients",
                               path ? "on a path" : "with linear.kind = \"cholesky\""));
  resolve_controlled(s);
  return s;
}

Simulation build_checked(Scene scene) {
  name_places(scene);
  check_specification(scene);
  return build_simulation(std::move(scene));
}

}  // namespace fascia
