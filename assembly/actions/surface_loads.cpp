#include "assembly/actions/actions.hpp"
#include "assembly/simulation/regions.hpp"
#include "assembly/simulation/simulation.hpp"
#include "assembly/specification/errors.hpp"
#include "core/base/index.hpp"
#include "core/body/body_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

/// Pressure on the surfaces of bodies, and fluids in them.
namespace fascia {

namespace {

/// Faces whose nodes are all selected.
std::vector<BodyFace> selected_faces(const SimulatedBody& owner, const Region& region) {
  std::vector<BodyFace> faces = owner.body->faces();
  if (faces.empty()) return faces;
  const std::vector<bool> chosen = select(region, owner.selectable_surface());
  std::erase_if(faces, [&](const BodyFace& face) {
    return !std::all_of(face.begin(), face.end(), [&](int point) { return chosen[at(point)]; });
  });
  return faces;
}

/// A place that nothing moves: all its nodes are held, with their rotations where these would move it.
bool is_held(const Simulation& s, const Attachment& place) {
  constexpr double kNothing = 1e-9;
  for (std::size_t k = 0; k < place.nodes.size(); ++k) {
    const Influence& i = place.influences[k];
    const bool turns =
        norm(i.b) > kNothing * s.model.points.part_length[at(s.model.points.node_part[at(place.nodes[k])])];
    if (std::abs(i.w) <= kNothing && !turns) continue;
    const auto c = std::lower_bound(s.model.constraints.begin(), s.model.constraints.end(), place.nodes[k],
                                    [](const FrameConstraint& held, int node) { return held.node < node; });
    if (c == s.model.constraints.end() || c->node != place.nodes[k] || c->translations < 3) return false;
    const bool affine = s.model.kind(c->node) == FrameKind::affine;
    if (turns && !(affine ? c->whole : c->rotations == 3)) return false;
    if (*std::max_element(c->translation_motion.begin(), c->translation_motion.end()) >= 0) return false;
    if (turns && c->turning_motion() >= 0) return false;
  }
  return true;
}

bool free_edges_are_held(const Simulation& s, const ModelBody& body, const std::vector<BodyFace>& faces) {
  const std::vector<Vec3d>& X = body.surface().points;
  const auto edges = free_edges(faces);
  return std::all_of(edges.begin(), edges.end(), [&](const std::array<int, 2>& e) {
    return is_held(s, body.attach_surface(at(e[0]))) && is_held(s, body.attach_surface(at(e[1]))) &&
           is_held(s, body.attach((X[at(e[0])] + X[at(e[1])]) * 0.5));
  });
}

/// What the load does at rest, in directions that stay.
DeadLoad dead(const Simulation& s, const SurfaceLoad& load) {
  SurfaceForces forces;
  evaluate(load, State::at_rest(s.model), std::vector<double>(s.schedules.size(), 1.0), forces);
  std::map<int, NodeLoad> by_node;
  for (int v = 0; v < load.vertex_count(); ++v)
    for (const SurfaceShare& share : load.shares_of(v)) {
      NodeLoad& n = by_node[share.node];
      n.node = share.node;
      n.force += forces.force[at(v)] * share.w;
      n.couple += outer(forces.force[at(v)], share.b);
    }
  DeadLoad dead{load.schedule, {}};
  for (const auto& [node, n] : by_node) dead.nodes.push_back(n);
  return dead;
}

/// The faces around what a fluid fills, outward from it: the body's cavities, or all that the body's surface encloses.
std::vector<BodyFace> faces_around_fluid(const SimulatedBody& b, const Place& place) {
  const std::vector<BodyFace> faces = b.body->faces();
  if (faces.empty())
    throw SceneError({{place, fmt::format("body \"{}\" has no surface that could hold a fluid; remove it", b.name)}});
  if (const auto free = free_edges(faces); !free.empty()) {
    const std::vector<Vec3d>& X = b.body->surface().points;
    const Vec3d hole = (X[at(free[0][0])] + X[at(free[0][1])]) * 0.5;
    throw SceneError({{place, fmt::format("the surface of body \"{}\" is open: {} edges have a face on one side only, "
                                          "one of them at ({:.6g}, {:.6g}, {:.6g}); close the surface, or use pressure "
                                          "in [[loads]]",
                                          b.name, free.size(), hole[0], hole[1], hole[2])}});
  }
  std::vector<BodyFace> cavities;
  for (const std::vector<BodyFace>& part : connected_faces(faces)) {
    if (surface_of(*b.body, part).rest_volume > 0) continue;
    const std::vector<BodyFace> turned = turned_over(part);
    cavities.insert(cavities.end(), turned.begin(), turned.end());
  }
  return cavities.empty() ? faces : cavities;
}

void add_fluid(Simulation& s, int body, const Fluid& fluid) {
  if (fluid.bulk_modulus && s.scene.solver.kind == SolverKind::statics && s.scene.solver.control != StaticControl::load)
    throw SceneError({{fluid.place,
                       "has a bulk modulus, whose forces are not in proportion to the load factor that "
                       "solver.control looks for; give it a pressure, or use control = \"load\""}});
  SurfaceLoad load = surface_of(*s.bodies[at(body)].body, faces_around_fluid(s.bodies[at(body)], fluid.place));
  load.schedule = new_schedule(s, fluid.schedule, fluid.place);
  load.pressure = fluid.pressure.value_or(0);
  load.bulk_modulus = fluid.bulk_modulus.value_or(0);
  load.volume = fluid.volume.value_or(load.rest_volume);
  if (fluid.bulk_modulus && !fluid.volume && !fluid.schedule.dial.empty())
    s.warnings.add("no-effect", s.scene.place_of(fluid.place.key + ".dial"),
                   "multiplies by how much the volume differs from that at rest, and there is no volume");
  if (fluid.density > 0 && s.gravity_load >= 0) {
    load.weight = s.scene.world.gravity * fluid.density;
    load.weight_schedule = s.model.loads[at(s.gravity_load)].schedule;
  } else if (fluid.density > 0) {
    s.warnings.add("no-effect", s.scene.place_of(fluid.place.key + ".density"), "does nothing without world.gravity");
  }
  s.fluids.push_back({body, static_cast<int>(s.model.surfaces.size())});
  s.model.surfaces.push_back(std::move(load));
}

}  // namespace

void add_pressure(Simulation& s, int body, const Load& load, int schedule) {
  const SimulatedBody& b = s.bodies[at(body)];
  const std::vector<BodyFace> faces = selected_faces(b, *load.where);
  if (faces.empty())
    throw SceneError({{load.where->place, fmt::format("the region holds no face of body \"{}\" with all its "
                                                      "corners; enlarge it",
                                                      b.name)}});
  SurfaceLoad surface = surface_of(*b.body, faces);
  surface.schedule = schedule;
  surface.pressure = -*load.pressure;
  surface.has_potential = free_edges_are_held(s, *b.body, faces);
  if (load.pressure_follows)
    s.model.surfaces.push_back(std::move(surface));
  else
    s.model.loads.push_back(dead(s, surface));
}

void add_fluids(Simulation& s) {
  for (std::size_t b = 0; b < s.bodies.size(); ++b)
    if (s.scene.bodies[b].fluid) add_fluid(s, static_cast<int>(b), *s.scene.bodies[b].fluid);
}

FluidState fluid_state(const Simulation& s, int fluid, const State& state) {
  SurfaceForces forces;
  evaluate(s.model.surfaces[at(s.fluids[at(fluid)].surface)], state, s.factors(state.time), forces);
  return {forces.volume, forces.pressure};
}

}  // namespace fascia
