#include "assembly/actions/actions.hpp"
#include "assembly/simulation/regions.hpp"
#include "assembly/specification/errors.hpp"

#include "assembly/simulation/simulation.hpp"
#include "core/base/index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <numeric>

namespace fascia {

namespace {

/// The integration point whose material counts at a place: the nearest of its cell, or of the body.
std::size_t nearest_point(const ModelBody& body, const Vec3d& X, int cell) {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::max();
  for (std::size_t q = 0; q < body.points().size(); ++q) {
    const BodyPoint& p = body.points()[q];
    const double distance = squared_norm(p.X - X);
    if (distance >= least * (1 - 1e-9) || (p.cell >= 0 && p.cell != cell)) continue;
    least = distance;
    best = q;
  }
  return best;
}

/// Tethers of the probe's region; of all its bodies without one.
void select_tethers(const Simulation& s, ResolvedProbe& r) {
  if (r.probe->quantity != Quantity::force && r.probe->quantity != Quantity::moment) return;
  for (std::size_t t = 0; t < s.tethered.size(); ++t) {
    const TetheredMaterial& m = s.tethered[t];
    if (r.body >= 0 && m.body != r.body) continue;
    bool chosen = true;
    if (r.probe->where && names_frames(*r.probe->where)) {
      const std::vector<int> nodes = find_nodes(s, m.body, *r.probe->where);
      chosen = std::find(nodes.begin(), nodes.end(), m.frame) != nodes.end();
    } else if (r.probe->where) {
      const char on_boundary = 1;
      const Selectable place{std::span(&s.model.tethers[at(m.tether)].X, 1),
                             std::span(&on_boundary, 1),
                             nullptr,
                             {},
                             s.bodies[at(m.body)].body->size()};
      chosen = select(*r.probe->where, place)[0];
    }
    if (chosen) r.tethered.push_back(static_cast<int>(t));
  }
}

bool over_time_only(Quantity q) { return q == Quantity::velocity || q == Quantity::kinetic_energy; }

/// The fluid of the probe's body, or the only one of the scene; −1 where another quantity is asked for.
int find_fluid(const Simulation& s, const ResolvedProbe& r) {
  const Quantity q = r.probe->quantity;
  if (q != Quantity::fluid_volume && q != Quantity::fluid_pressure) return -1;
  std::vector<int> found;
  for (std::size_t f = 0; f < s.fluids.size(); ++f)
    if (!r.probe->body || s.fluids[f].body == r.body) found.push_back(static_cast<int>(f));
  if (found.size() == 1) return found[0];
  throw SceneError(
      {{r.probe->place, found.empty() ? "asks for a fluid where there is none; give the body a fluid"
                                      : fmt::format("asks for one of {} fluids; name its body", found.size())}});
}

/// Nodes of a probe without a region: those of its body, or of the scene.
std::vector<int> nodes_of(const Simulation& s, const ResolvedProbe& r) {
  const ModelBody* body = r.body >= 0 ? s.bodies[at(r.body)].body.get() : nullptr;
  std::vector<int> nodes(at(body ? body->node_count() : s.model.node_count()));
  std::iota(nodes.begin(), nodes.end(), body ? body->first_node() : 0);
  return nodes;
}

/// Inertia lies at nodes: at shared ones that of all their bodies, at followed ones that of what follows.
void warn_of_shared_mass(Simulation& s, const ResolvedProbe& r) {
  const Quantity q = r.probe->quantity;
  if (r.body < 0 || (q != Quantity::kinetic_energy && q != Quantity::total_energy && q != Quantity::momentum &&
                     q != Quantity::angular_momentum))
    return;
  const ModelBody& body = *s.bodies[at(r.body)].body;
  const auto own = [&](int node) { return node >= body.first_node() && node < body.first_node() + body.node_count(); };
  const bool shares = std::any_of(s.bodies.begin(), s.bodies.end(), [&](const SimulatedBody& b) {
    const std::vector<int>& shared = b.body->shared_nodes();
    return b.body.get() == &body ? !shared.empty() : std::any_of(shared.begin(), shared.end(), own);
  });
  const std::vector<DependentNode>& dependents = s.model.points.dependents;
  const bool follows = std::any_of(dependents.begin(), dependents.end(), [&](const DependentNode& d) {
    return std::any_of(d.hosts.begin(), d.hosts.end(), [&](int host) { return own(host) != own(d.node); });
  });
  if (shares || follows)
    s.warnings.add(
        "masses", r.probe->place,
        fmt::format("masses of what is coupled count at the nodes that move them, whichever their body: this is "
                    "not all of \"{}\", or more; leave body out for the whole scene",
                    s.bodies[at(r.body)].name));
}

/// The matter of a rigid body is at its one frame, which a region holds or does not.
void warn_of_rigid_matter(Simulation& s, const ResolvedProbe& r) {
  if (!r.probe->where || r.body < 0 || s.scene.bodies[at(r.body)].model != BodyModel::rigid) return;
  const SimulatedBody& b = s.bodies[at(r.body)];
  if (b.body->surface().points.empty()) return;
  const std::vector<bool> chosen = select(*r.probe->where, b.selectable_surface());
  if (std::all_of(chosen.begin(), chosen.end(), [](bool in) { return in; })) return;
  switch (r.probe->quantity) {
    case Quantity::volume:
    case Quantity::mass:
    case Quantity::energy:
    case Quantity::kinetic_energy:
    case Quantity::total_energy:
    case Quantity::momentum:
    case Quantity::angular_momentum:
      s.warnings.add("rigid", r.probe->place,
                     fmt::format("is that of the whole of rigid body \"{}\", whatever part of it the region holds; "
                                 "leave where out",
                                 b.name));
      break;
    default:
      break;
  }
}

}  // namespace

Vec3d place_on_body(Simulation& s, int body, const Vec3d& X, const Place& place) {
  const ModelBody& b = *s.bodies[at(body)].body;
  const double distance = b.distance(X);
  if (distance <= 1e-9 * b.size()) return X;
  if (distance > 1e-3 * b.size())
    throw SceneError(
        {{place,
          fmt::format("({:.6g}, {:.6g}, {:.6g}) lies {:.4g} m outside body \"{}\"; give a point of its rest shape",
                      X[0], X[1], X[2], distance, s.bodies[at(body)].name)}});
  s.warnings.add("place", place, fmt::format("lies {:.3g} m outside the body and was taken as on it", distance));
  return X;
}

void resolve_controlled(Simulation& s) {
  if (!s.scene.solver.controlled) return;
  const ControlledDisplacement& wanted = *s.scene.solver.controlled;
  const int body = body_index(s, wanted.body);
  Attachment place = s.bodies[at(body)].body->attach(place_on_body(s, body, wanted.at, wanted.at_place));
  s.controlled = {std::move(place.nodes), std::move(place.influences), normalized(wanted.direction), wanted.to};
}

namespace {

void resolve_probe(Simulation& s, const Probe& probe) {
  ResolvedProbe r;
  r.probe = &probe;
  if (probe.body)
    r.body = body_index(s, *probe.body);
  else if (s.bodies.size() == 1)
    r.body = 0;
  for (const Vec3d& X0 : probe.at) {
    ProbePoint p;
    p.X = place_on_body(s, r.body, X0, probe.at_place);
    const ModelBody& body = *s.bodies[at(r.body)].body;
    p.field = body.attach(p.X);
    p.nearest = nearest_point(body, p.X, p.field.cell);
    r.points.push_back(std::move(p));
  }
  select_tethers(s, r);
  r.fluid = find_fluid(s, r);
  if (probe.where) {
    r.nodes = r.tethered.empty() ? select_nodes(s, r.body, *probe.where) : find_nodes(s, r.body, *probe.where);
  } else {
    r.nodes = nodes_of(s, r);
  }
  warn_of_shared_mass(s, r);
  warn_of_rigid_matter(s, r);
  r.about = probe.about.value_or(Vec3d{});
  if (s.scene.solver.kind == SolverKind::statics && over_time_only(probe.quantity))
    s.warnings.add("no-effect", probe.place, "is zero in a static solve");
  const bool modes = s.scene.solver.kind == SolverKind::modes, frequency = probe.quantity == Quantity::frequency;
  if (frequency && !modes) throw SceneError({{probe.place, "quantity \"frequency\" needs solver.kind = \"modes\""}});
  if (modes && !frequency && probe.quantity != Quantity::mass && probe.quantity != Quantity::volume)
    throw SceneError({{probe.place, "solver.kind = \"modes\" knows frequency, mass and volume only"}});
  s.probes.push_back(std::move(r));
}

}  // namespace

void resolve_probes(Simulation& s) {
  SceneErrors errors;
  for (const Probe& probe : s.scene.probes) errors.gather([&] { resolve_probe(s, probe); });
  errors.tell();
}

}  // namespace fascia
