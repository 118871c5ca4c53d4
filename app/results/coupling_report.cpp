#include "app/results/coupling_report.hpp"

#include "assembly/simulation/mechanisms.hpp"
#include "assembly/simulation/places.hpp"
#include "core/base/index.hpp"
#include "core/executor/point_executor.hpp"
#include "core/executor/spring_executor.hpp"
#include "core/math/wrench.hpp"
#include "core/structure/inertia.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

namespace fascia::app {

namespace {

nlohmann::json json_of(const Vec3d& v) {
  const auto finite = [](double x) { return std::isfinite(x) ? x : 0.0; };
  return {finite(v[0]), finite(v[1]), finite(v[2])};
}

Vec3d place_of(const Simulation& s, const State& state, int node) {
  return s.model.rest_position[at(node)] + state.u[at(node)];
}

/// Weight of what moves with a node, as all wrenches here about the origin.
Wrench weight_of(const Simulation& s, const State& state, int node, const FrameInertia& inertia) {
  if (s.gravity_load < 0) return {};
  const double factor = s.factors(state.time)[at(s.model.loads[at(s.gravity_load)].schedule)];
  const Vec3d g = s.scene.world.gravity * factor, arm = (Mat3d::identity() + state.D[at(node)]) * inertia.first;
  Wrench w;
  w.add(place_of(s, state, node), g * inertia.mass, cross(arm, g));
  return w;
}

/// Mass damping of what moves with a node.
Wrench drag_on(const Simulation& s, const State& state, int node, const FrameInertia& damping) {
  const InertiaForce f = inertia_force(damping, state.v[at(node)], state.Q_dot[at(node)]);
  const Mat3d Q = Mat3d::identity() + state.D[at(node)];
  Wrench w;
  w.add(place_of(s, state, node), -f.force, axl(Q * transpose(f.moment)) * -1.0);
  return w;
}

/// What hosts do on a dependent node, whose weight and mass damping they carry.
Wrench support_of(const Simulation& s, const ReachedForces& acting, const State& state, std::size_t dependent) {
  const double* f = acting.dependent_forces.data() + 6 * dependent;
  Wrench w;
  const int node = s.model.points.dependents[dependent].node;
  w.add(place_of(s, state, node), {{f[0], f[1], f[2]}}, {{f[3], f[4], f[5]}});
  w -= weight_of(s, state, node, s.dependent_inertia[dependent]);
  if (!s.dependent_damping.empty()) w -= drag_on(s, state, node, s.dependent_damping[dependent]);
  return w;
}

nlohmann::ordered_json entry(const Wrench& w, double gap, double energy) {
  return {{"force", json_of(w.force)}, {"moment", json_of(w.moment)}, {"gap", gap}, {"energy", energy}};
}

/// The body whose own node it is.
std::size_t owner_of(const Simulation& s, int node) { return at(body_of_node(s, node)); }

/// What a body's points do on a node that it shares, with the weight and the mass damping of its matter there.
Wrench pull_on(const Simulation& s, const SimulatedBody& tissue, const ReachedForces& acting, const State& state,
               std::size_t shared) {
  const int node = tissue.body->shared_nodes()[shared];
  const auto f = sum_of_groups(s.model.points, acting.slot_sums, tissue.body->blocks.groups, node);
  Wrench w;
  const Mat3d Q = Mat3d::identity() + state.D[at(node)];
  const bool turns = s.model.kind(node) != FrameKind::vertex;
  w.add(place_of(s, state, node), f.force * -1.0, turns ? axl(Q * transpose(f.N)) * -1.0 : Vec3d{});
  w += weight_of(s, state, node, tissue.shared_inertia[shared]);
  w += drag_on(s, state, node, tissue.shared_damping[shared]);
  return w;
}

/// Largest distance between a body's field and the nodes that it shares [m]; of a rigid body's surface there is none.
double gap_at(const Simulation& s, const SimulatedBody& tissue, const State& state, int node) {
  if (s.scene.bodies[owner_of(s, node)].model == BodyModel::rigid) return 0;
  return norm(field_at(tissue.body->attach(s.model.rest_position[at(node)]), state).u - state.u[at(node)]);
}

nlohmann::ordered_json report_tissue(const Simulation& s, const SimulatedBody& b, const ReachedForces& acting,
                                     const State& state) {
  double energy = 0, gap = 0;
  acting.energies.for_each(b.body->blocks, [&](double elastic, double) { energy += elastic; });
  std::map<std::size_t, std::pair<Wrench, int>> partners;
  std::map<std::size_t, double> gaps;
  const std::vector<DependentNode>& dependents = s.model.points.dependents;
  for (std::size_t k = 0; k < dependents.size(); ++k) {
    const int node = dependents[k].node, own = node - b.body->first_node();
    if (own < 0 || own >= b.body->node_count()) continue;
    partners[owner_of(s, dependents[k].hosts[0])].first -= support_of(s, acting, state, k);
  }
  for (std::size_t k = 0; k < b.body->shared_nodes().size(); ++k) {
    const int node = b.body->shared_nodes()[k];
    const std::size_t owner = owner_of(s, node);
    const Wrench w = pull_on(s, b, acting, state, k);
    auto& [sum, count] = partners[owner];
    sum += w;
    ++count;
    gaps[owner] = std::max(gaps[owner], gap_at(s, b, state, node));
    gap = std::max(gap, gaps[owner]);
  }
  nlohmann::ordered_json on = nlohmann::ordered_json::object();
  for (const auto& [owner, pull] : partners)
    on[s.bodies[owner].name] = {{"force", json_of(pull.first.force)},
                                {"moment", json_of(pull.first.moment)},
                                {"gap", gaps[owner]},
                                {"nodes", pull.second}};
  nlohmann::ordered_json j = entry(partners.empty() ? Wrench{} : partners.begin()->second.first, gap, energy);
  j["on"] = std::move(on);
  return j;
}

/// Distance between a body's material and its host's field [m]: at points of the faces that follow it, and at the
/// frames that follow it where these are not where their material is.
double gap_of(const Simulation& s, const Coupling& c, const BuiltCoupling& built, const State& state) {
  const SimulatedBody& b = s.bodies[at(body_index(s, c.body))];
  const SimulatedBody& host = s.bodies[at(body_index(s, c.to))];
  double gap = 0;
  if (!b.body->interpolates())
    for (const int node : built.nodes) {
      const Vec3d& X = s.model.rest_position[at(node)];
      gap = std::max(gap, norm(field_at(b.body->attach(X), state).u - field_at(host.body->attach(X), state).u));
    }
  for (const FacePoint& p : b.body->face_points()) {
    const bool follows = std::all_of(p.attachment.nodes.begin(), p.attachment.nodes.end(), [&](int node) {
      return std::binary_search(built.nodes.begin(), built.nodes.end(), node);
    });
    if (!follows || host.body->distance(p.X) > 1e-3 * host.body->size()) continue;
    gap = std::max(gap, norm(field_at(p.attachment, state).u - field_at(host.body->attach(p.X), state).u));
  }
  return gap;
}

nlohmann::ordered_json report_coupling(const Simulation& s, const Coupling& c, const BuiltCoupling& built,
                                       const ReachedForces& acting, const State& state) {
  Wrench sum;
  if (c.kind == CouplingKind::spring) {
    double energy = 0;
    for (const int index : built.springs) {
      const Spring& spring = s.model.points.springs[at(index)];
      const Vec3d end = place_of(s, state, spring.node) + spring.arm + state.D[at(spring.node)] * spring.arm;
      sum.add(end, SpringExecutor::force(spring, state), {});
      energy += acting.energies.springs[at(index)];
    }
    return entry(sum, 0, energy);
  }
  const std::vector<DependentNode>& dependents = s.model.points.dependents;
  for (std::size_t k = 0; k < dependents.size(); ++k) {
    if (!std::binary_search(built.nodes.begin(), built.nodes.end(), dependents[k].node)) continue;
    sum += support_of(s, acting, state, k);
  }
  return entry(sum, gap_of(s, c, built, state), 0);
}

void describe_tissue(const Simulation& s, const SimulatedBody& b, std::string& out) {
  std::map<std::size_t, std::size_t> shared, following;
  for (const int node : b.body->shared_nodes()) ++shared[owner_of(s, node)];
  for (const DependentNode& d : s.model.points.dependents)
    if (d.node >= b.body->first_node() && d.node < b.body->first_node() + b.body->node_count())
      ++following[owner_of(s, d.hosts[0])];
  std::string list;
  for (const auto& [owner, count] : shared)
    list += fmt::format("{}{} of \"{}\"", list.empty() ? "" : ", ", counted(count, s.bodies[owner].node_word()),
                        s.bodies[owner].name);
  for (const auto& [owner, count] : following)
    list += fmt::format("{}{} of its own frames on the surface of \"{}\"", list.empty() ? "" : "; ", count,
                        s.bodies[owner].name);
  if (!b.gap.empty()) fmt::format_to(std::back_inserter(out), "body {}: {}\n", b.name, b.gap);
  fmt::format_to(std::back_inserter(out), "body {}: {}{}\n", b.name, shared.empty() ? "is tied by " : "shares ", list);
}

void describe_support(const Simulation& s, const Mechanisms& m, std::string& out) {
  constexpr std::size_t kListed = 4;
  std::map<int, std::vector<std::size_t>> pieces;
  for (std::size_t p = 0; p < m.pieces.size(); ++p) pieces[m.pieces[p].body].push_back(p);
  const auto to_out = std::back_inserter(out);
  for (const auto& [body, list] : pieces) {
    const std::string& name = s.bodies[at(body)].name;
    if (list.size() > kListed) {
      const auto held =
          std::count_if(list.begin(), list.end(), [&](std::size_t p) { return m.own_motions[p].empty(); });
      fmt::format_to(to_out, "body {}: {} parts, {} of them alone held\n", name, list.size(), held);
      continue;
    }
    for (const std::size_t p : list) {
      const Vec3d& x = m.pieces[p].center;
      const std::string part = fmt::format(" around ({:.4g}, {:.4g}, {:.4g})", x[0], x[1], x[2]);
      fmt::format_to(to_out, "body {}{}: alone {}\n", name, m.pieces[p].whole ? "" : part,
                     m.own_motions[p].empty() ? "held" : "free in " + m.own_motions[p]);
    }
  }
  for (const Assembly& a : m.assemblies) {
    if (!a.free.empty() && a.pieces.size() > 1)
      fmt::format_to(to_out, "all coupled to {}: free in {}\n", s.bodies[at(m.pieces[at(a.pieces[0])].body)].name,
                     fmt::join(a.free, ", "));
    for (const LooseMotion& l : a.loose.motions)
      fmt::format_to(to_out, "mechanism: \"{}\": {}\n", s.bodies[at(m.pieces[at(l.piece)].body)].name, l.name);
    if (const std::size_t more = at(a.loose.count) - a.loose.motions.size(); more > 0)
      fmt::format_to(to_out, "mechanism: {} more motions\n", more);
  }
}

}  // namespace

std::string counted(std::size_t count, const char* word) {
  return fmt::format("{} {}{}", count, word, count == 1 ? "" : "s");
}

CouplingReports coupling_report(const Simulation& s, const ReachedForces& acting, const State& state) {
  CouplingReports reports;
  for (const SimulatedBody& b : s.bodies)
    if (!b.interfaces.empty()) reports.emplace_back(b.name, report_tissue(s, b, acting, state));
  for (std::size_t k = 0; k < s.couplings.size(); ++k) {
    const Coupling& c = s.scene.couplings[k];
    reports.emplace_back(c.name, report_coupling(s, c, s.couplings[k], acting, state));
  }
  return reports;
}

std::string coupling_layout(const Simulation& s) {
  std::string out;
  for (const SimulatedBody& b : s.bodies)
    if (!b.interfaces.empty()) describe_tissue(s, b, out);
  for (std::size_t k = 0; k < s.couplings.size(); ++k) {
    const Coupling& c = s.scene.couplings[k];
    const SimulatedBody& b = s.bodies[at(body_index(s, c.body))];
    const std::string nodes = counted(s.couplings[k].nodes.size(), b.node_word());
    if (c.kind == CouplingKind::spring)
      fmt::format_to(std::back_inserter(out), "coupling {}: {} of \"{}\" on springs of {:.4g} N/m in all\n", c.name,
                     nodes, b.name, c.stiffness);
    else
      fmt::format_to(std::back_inserter(out), "coupling {}: {} of \"{}\" {} \"{}\"\n", c.name, nodes, b.name,
                     c.kind == CouplingKind::weld ? "welded to frames of" : "embedded in", c.to);
  }
  if (s.bodies.size() < 2 && s.couplings.empty()) return out;
  describe_support(s, find_mechanisms(s), out);
  return out;
}

}  // namespace fascia::app
