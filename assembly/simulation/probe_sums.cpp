#include "assembly/simulation/probe_sums.hpp"

#include "core/base/index.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace fascia {

namespace {

/// The part of each of a body's integration points that a probe's nodes move: Σ w of them, of weights that are negative
/// at some nodes Σ w² over that of all. All of it without a region.
std::vector<double> parts_of_points(const ModelBody& body, const ResolvedProbe& probe) {
  std::vector<double> parts(body.points().size(), 1.0);
  if (!probe.probe->where) return parts;
  for (std::size_t q = 0; q < parts.size(); ++q) {
    const Attachment place = body.attach_point(q);
    const bool negative =
        std::any_of(place.influences.begin(), place.influences.end(), [](const Influence& i) { return i.w < 0; });
    double all = 0, own = 0;
    for (std::size_t k = 0; k < place.nodes.size(); ++k) {
      const double w = place.influences[k].w, part = negative ? w * w : w;
      all += part;
      if (std::binary_search(probe.nodes.begin(), probe.nodes.end(), place.nodes[k])) own += part;
    }
    parts[q] = own / all;
  }
  return parts;
}

/// The part of a body's elastic energy that a probe's nodes hold: energy densities say how it spreads over points.
double part_of_energy(const ModelBody& body, const ResolvedProbe& probe, const State& state) {
  if (!probe.probe->where) return 1;
  const std::vector<PointTensors> tensors = body.tensors(state);
  const std::vector<double> parts = parts_of_points(body, probe);
  double all = 0, chosen = 0;
  for (std::size_t q = 0; q < tensors.size(); ++q) {
    const double energy = body.points()[q].volume * tensors[q].energy_density;
    all += energy;
    chosen += parts[q] * energy;
  }
  return all > 0 ? chosen / all : 0;
}

/// Groups of points that tether the material of a body, or of all, and the part of their tethers that stand at the
/// probe's nodes.
std::map<int, double> tether_groups(const Simulation& s, const ResolvedProbe& probe) {
  std::map<int, std::pair<int, int>> count;  // of all tethers, and of those
  for (const TetheredMaterial& m : s.tethered) {
    if (probe.body >= 0 && m.body != probe.body) continue;
    auto& [all, chosen] = count[s.model.tethers[at(m.tether)].group];
    ++all;
    chosen += !probe.probe->where || std::binary_search(probe.nodes.begin(), probe.nodes.end(), m.frame) ? 1 : 0;
  }
  std::map<int, double> parts;
  for (const auto& [group, of] : count) parts[group] = 1.0 * of.second / of.first;
  return parts;
}

}  // namespace

double deformed_volume(const Simulation& s, const ResolvedProbe& probe, const State& state) {
  double volume = 0;
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    if (probe.body >= 0 && static_cast<std::size_t>(probe.body) != b) continue;
    const ModelBody& body = *s.bodies[b].body;
    if (s.scene.bodies[b].model == BodyModel::rigid) {
      volume += body.volume();
      continue;
    }
    const std::vector<Mat3d> H = body.gradients(state);
    const std::vector<double> parts = parts_of_points(body, probe);
    for (std::size_t q = 0; q < H.size(); ++q)
      volume += parts[q] * body.points()[q].volume * determinant(Mat3d::identity() + H[q]);
  }
  return volume;
}

Energies energies(const Simulation& s, const ResolvedProbe& probe, const ProbedState& snap) {
  Energies e;
  const BlockEnergies& of = snap.acting->energies;
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    if (probe.body >= 0 && static_cast<std::size_t>(probe.body) != b) continue;
    const ModelBody& body = *s.bodies[b].body;
    const double part = part_of_energy(body, probe, *snap.state);
    of.for_each(body.blocks, [&](double elastic, double stabilization) {
      e.elastic += part * elastic;
      e.stabilization += part * stabilization;
    });
  }
  for (const auto& [group, part] : tether_groups(s, probe)) e.stabilization += part * of.stabilization[at(group)];
  const std::vector<Spring>& springs = s.model.points.springs;
  for (std::size_t k = 0; k < springs.size(); ++k)
    if (std::binary_search(probe.nodes.begin(), probe.nodes.end(), springs[k].node)) e.elastic += of.springs[k];
  const std::vector<double> factors = s.factors(snap.state->time);
  std::vector<char> chosen(at(s.model.node_count()), 0);
  for (const int i : probe.nodes) chosen[at(i)] = 1;
  for (const DeadLoad& load : s.model.loads)
    for (const NodeLoad& n : load.nodes)
      if (chosen[at(n.node)] != 0)
        e.potential -= factors[at(load.schedule)] *
                       (dot(n.force, snap.state->u[at(n.node)]) + contract(n.couple, snap.state->D[at(n.node)]));
  SurfaceForces forces;
  for (const SurfaceLoad& load : s.model.surfaces) {
    if (chosen[at(load.shares[0].node)] == 0) continue;
    evaluate(load, *snap.state, factors, forces);
    e.potential += forces.energy;
  }
  return e;
}

double kinetic_energy(const Simulation& s, const ResolvedProbe& probe, const State& state) {
  double energy = 0;
  for (const int i : probe.nodes)
    energy += 0.5 * inertia_product(s.model.inertia[at(i)], state.v[at(i)], state.Q_dot[at(i)]);
  return energy;
}

Momentum momentum(const Simulation& s, const ResolvedProbe& probe, const State& state) {
  Momentum sum;
  for (const int i : probe.nodes) {
    const Momentum m = momentum_of(s.model.inertia[at(i)], s.model.rest_position[at(i)] + state.u[at(i)],
                                   Mat3d::identity() + state.D[at(i)], state.v[at(i)], state.Q_dot[at(i)], probe.about);
    sum.linear += m.linear;
    sum.angular += m.angular;
  }
  return sum;
}

}  // namespace fascia
