#include "assembly/simulation/probe_values.hpp"

#include "assembly/simulation/held_forces.hpp"
#include "assembly/simulation/matter.hpp"
#include "assembly/simulation/probe_sums.hpp"
#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "core/math/rotation.hpp"
#include "core/structure/inertia.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace fascia {

namespace {

using enum ProbeShape;

struct QuantityInfo {
  Quantity quantity;
  const char* name;
  const char* unit;
  ProbeShape shape;
};

constexpr QuantityInfo kQuantities[] = {
    {Quantity::displacement, "displacement", "m", vector},
    {Quantity::position, "position", "m", vector},
    {Quantity::rotation, "rotation", "rad", vector},
    {Quantity::velocity, "velocity", "m/s", vector},
    {Quantity::strain, "strain", "1", matrix},
    {Quantity::stress, "stress", "Pa", matrix},
    {Quantity::force, "force", "N", vector},
    {Quantity::moment, "moment", "N m", vector},
    {Quantity::volume, "volume", "m3", scalar},
    {Quantity::mass, "mass", "kg", scalar},
    {Quantity::energy, "energy", "J", scalar},
    {Quantity::kinetic_energy, "kinetic_energy", "J", scalar},
    {Quantity::total_energy, "total_energy", "J", scalar},
    {Quantity::momentum, "momentum", "kg m/s", vector},
    {Quantity::angular_momentum, "angular_momentum", "kg m2/s", vector},
    {Quantity::max_displacement, "max_displacement", "m", scalar},
    {Quantity::mean_displacement, "mean_displacement", "m", vector},
    {Quantity::frequency, "frequency", "Hz", scalar},
    {Quantity::fluid_volume, "fluid_volume", "m3", scalar},
    {Quantity::fluid_pressure, "fluid_pressure", "Pa", scalar},
};

const QuantityInfo& info(Quantity q) {
  return *std::find_if(std::begin(kQuantities), std::end(kQuantities),
                       [&](const QuantityInfo& i) { return i.quantity == q; });
}

void push(std::vector<double>& out, const Vec3d& v) { out.insert(out.end(), v.v, v.v + 3); }
void push(std::vector<double>& out, const Mat3d& m) {
  for (int i = 0; i < 3; ++i) push(out, m.row(i));
}

/// Strains and stresses of bodies in one state, each made when it is first asked for.
using TensorFields = std::map<int, TensorField>;

void push_point_value(std::vector<double>& out, const ResolvedProbe& probe, const SimulatedBody& owner,
                      const ProbePoint& p, const State& state, TensorFields& fields) {
  const ModelBody& body = *owner.body;
  const FieldValue f = field_at(p.field, state);
  switch (probe.probe->quantity) {
    case Quantity::displacement:
      push(out, f.u);
      break;
    case Quantity::position:
      push(out, p.X + f.u);
      break;
    case Quantity::rotation:
      push(out, rotation_vector(polar_increment(owner.vertices ? f.H : f.D)));
      break;
    case Quantity::velocity: {
      Vec3d v;
      for (std::size_t k = 0; k < p.field.nodes.size(); ++k)
        v += state.v[at(p.field.nodes[k])] * p.field.influences[k].w +
             state.Q_dot[at(p.field.nodes[k])] * p.field.influences[k].b;
      push(out, v);
      break;
    }
    case Quantity::strain:
      push(out, body.strain_at(p.field, state));
      break;
    default: {
      TensorField& tensors = fields[probe.body];
      if (!tensors) tensors = body.tensor_field(state);
      push(out, tensors(p.field, p.nearest).stress);
      break;
    }
  }
}

/// Force and moment that supports (or, where nothing is held, loads) exert on the nodes.
Wrench support_force(const Simulation& s, const ResolvedProbe& probe, const ProbedState& snap,
                     std::vector<double>& held) {
  std::vector<char> chosen(at(s.model.node_count()), 0);
  for (const int i : probe.nodes) chosen[at(i)] = 1;
  Wrench sum;
  const auto add = [&](int node, const Vec3d& f, const Vec3d& torque) {
    sum.add(s.model.rest_position[at(node)] + snap.state->u[at(node)] - probe.about, f, torque);
  };
  bool any = false;
  if (held.empty()) held = held_forces(s, *snap.acting);
  for (const FrameConstraint& c : s.model.constraints) {
    if (chosen[at(c.node)] == 0) continue;
    any = true;
    const Wrench there = held_at(s, *snap.state, held, c);
    add(c.node, there.force, there.moment);
  }
  for (const int t : probe.tethered) {
    any = true;
    sum += held_material(s, *snap.state, *snap.acting, s.tethered[at(t)], probe.about);
  }
  if (any) return sum;
  const std::vector<double> factors = s.factors(snap.state->time);
  for (std::size_t l = 0; l < s.model.loads.size(); ++l) {
    if (static_cast<int>(l) == s.gravity_load) continue;
    const DeadLoad& load = s.model.loads[l];
    for (const NodeLoad& n : load.nodes) {
      if (chosen[at(n.node)] == 0) continue;
      const Mat3d Q = Mat3d::identity() + snap.state->D[at(n.node)];
      const double factor = factors[at(load.schedule)];
      add(n.node, n.force * factor, (axl(Q * transpose(n.couple)) + n.torque) * factor);
    }
  }
  for (const FollowerLoad& load : s.model.followers)
    for_each_share(load, *snap.state, factors[at(load.schedule)],
                   [&](int node, const Vec3d& f, const Mat3d& couple, const Vec3d& torque) {
                     if (chosen[at(node)] == 0) return;
                     const Mat3d Q = Mat3d::identity() + snap.state->D[at(node)];
                     add(node, f, axl(Q * transpose(couple)) + torque);
                   });
  SurfaceForces forces;
  for (const SurfaceLoad& load : s.model.surfaces) {
    evaluate(load, *snap.state, factors, forces);
    for (int v = 0; v < load.vertex_count(); ++v)
      for (const SurfaceShare& share : load.shares_of(v)) {
        if (chosen[at(share.node)] == 0) continue;
        const Mat3d Q = Mat3d::identity() + snap.state->D[at(share.node)];
        add(share.node, forces.force[at(v)] * share.w, cross(Q * share.b, forces.force[at(v)]));
      }
  }
  return sum;
}

/// Values of a probe, finite or not.
std::vector<double> raw_values_of(const Simulation& s, const ResolvedProbe& probe, const ProbedState& snap,
                                  TensorFields& fields, std::vector<double>& held) {
  std::vector<double> out;
  const Quantity q = probe.probe->quantity;
  const State& state = *snap.state;
  if (!probe.points.empty()) {
    for (const ProbePoint& p : probe.points) push_point_value(out, probe, s.bodies[at(probe.body)], p, state, fields);
    return out;
  }
  switch (q) {
    case Quantity::force:
    case Quantity::moment: {
      const Wrench support = support_force(s, probe, snap, held);
      push(out, q == Quantity::force ? support.force : support.moment);
      break;
    }
    case Quantity::volume:
      out.push_back(deformed_volume(s, probe, state));
      break;
    case Quantity::mass: {
      double mass = 0;  // of nodes, or of whole bodies: nodes that bodies share carry the mass of both
      for (const int i : probe.nodes) mass += probe.probe->where ? s.model.inertia[at(i)].mass : 0.0;
      for (std::size_t b = 0; b < s.bodies.size() && !probe.probe->where; ++b)
        if (probe.body < 0 || static_cast<std::size_t>(probe.body) == b) mass += s.bodies[b].body->mass();
      out.push_back(mass);
      break;
    }
    case Quantity::energy:
      out.push_back(energies(s, probe, snap).elastic);
      break;
    case Quantity::kinetic_energy:
      out.push_back(kinetic_energy(s, probe, state));
      break;
    case Quantity::total_energy: {
      const Energies e = energies(s, probe, snap);
      out.push_back(e.elastic + e.stabilization + kinetic_energy(s, probe, state) + e.potential);
      break;
    }
    case Quantity::momentum:
      push(out, momentum(s, probe, state).linear);
      break;
    case Quantity::angular_momentum:
      push(out, momentum(s, probe, state).angular);
      break;
    case Quantity::max_displacement:
      out.push_back(displacement_of_matter(s, probe, state).largest());
      break;
    case Quantity::mean_displacement:
      push(out, displacement_of_matter(s, probe, state).mean());
      break;
    case Quantity::fluid_volume:
      out.push_back(fluid_state(s, probe.fluid, state).volume);
      break;
    case Quantity::fluid_pressure:
      out.push_back(fluid_state(s, probe.fluid, state).pressure);
      break;
    default:
      out.push_back(snap.frequency);
      break;
  }
  return out;
}

std::vector<double> values_of(const Simulation& s, const ResolvedProbe& probe, const ProbedState& snap,
                              TensorFields& fields, std::vector<double>& held) {
  std::vector<double> out = raw_values_of(s, probe, snap, fields, held);
  if (std::any_of(out.begin(), out.end(), [](double value) { return !std::isfinite(value); }))
    throw StateError(fmt::format("probe \"{}\": {} is not finite; the state that it shows is wrong", probe.probe->name,
                                 quantity_name(probe.probe->quantity)));
  return out;
}

}  // namespace

ReachedParts needed_parts(const Simulation& s) {
  ReachedParts parts;
  for (const ResolvedProbe& probe : s.probes) {
    const Quantity q = probe.probe->quantity;
    parts.forces = parts.forces || q == Quantity::force || q == Quantity::moment;
    parts.energies = parts.energies || q == Quantity::energy || q == Quantity::total_energy;
  }
  for (const SimulatedBody& b : s.bodies) parts.slots = parts.slots || !b.interfaces.empty();
  if (parts.slots || !s.couplings.empty()) parts.forces = parts.energies = true;
  return parts;
}

ProbeValues probe_values(const Simulation& s, const ProbedState& snap) {
  TensorFields fields;
  std::vector<double> held;  // of all probes, made for the first that asks
  ProbeValues values;
  for (const ResolvedProbe& probe : s.probes) values.push_back(values_of(s, probe, snap, fields, held));
  return values;
}

std::size_t probe_index(const Simulation& s, std::string_view name) {
  const auto found =
      std::find_if(s.probes.begin(), s.probes.end(), [&](const ResolvedProbe& r) { return r.probe->name == name; });
  if (found == s.probes.end()) throw InputError(fmt::format("the scene has no probe \"{}\"", name));
  return static_cast<std::size_t>(found - s.probes.begin());
}

std::vector<double> probe_value(const Simulation& s, std::size_t probe, const ProbedState& snap) {
  TensorFields fields;
  std::vector<double> held;
  return values_of(s, s.probes[probe], snap, fields, held);
}

ProbeShape probe_shape(Quantity quantity) { return info(quantity).shape; }
std::string probe_unit(Quantity quantity) { return info(quantity).unit; }
std::string unit_of_quantity(std::string_view name) {
  return std::find_if(std::begin(kQuantities), std::end(kQuantities),
                      [&](const QuantityInfo& i) { return i.name == name; })
      ->unit;
}
std::string quantity_name(Quantity quantity) { return info(quantity).name; }

std::vector<std::string> probe_columns(const ResolvedProbe& probe) {
  const ProbeShape shape = info(probe.probe->quantity).shape;
  const char* axes[3] = {"x", "y", "z"};
  std::vector<std::string> parts;
  if (shape == scalar) parts = {""};
  if (shape == vector)
    for (const char* a : axes) parts.push_back(std::string(".") + a);
  if (shape == matrix)
    for (const char* a : axes)
      for (const char* b : axes) parts.push_back(std::string(".") + a + b);
  std::vector<std::string> columns;
  const std::size_t points = std::max<std::size_t>(1, probe.points.size());
  for (std::size_t i = 0; i < points; ++i)
    for (const std::string& part : parts)
      columns.push_back(probe.probe->name + (probe.probe->at_is_list ? "[" + std::to_string(i) + "]" : "") + part);
  return columns;
}

}  // namespace fascia
