#include "assembly/simulation/simulation.hpp"

#include "assembly/simulation/regions.hpp"
#include "assembly/specification/errors.hpp"
#include "assembly/specification/schedule.hpp"
#include "core/base/index.hpp"
#include "core/geometry/bounds.hpp"
#include "meshless/scattered/neighbours.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fascia {

std::vector<double> Simulation::factors(double time, std::span<const double> dials_then) const {
  std::vector<double> f;
  const bool statics = scene.solver.kind == SolverKind::statics, path = scene.solver.control != StaticControl::load;
  for (const Schedule& s : schedules) f.push_back(path ? path_factor(s, time) : schedule_factor(s, time, statics));
  for (std::size_t d = 0; d < dials.size(); ++d)
    for (const int schedule : dials[d].schedules) f[at(schedule)] *= dials_then[d];
  return f;
}

int new_schedule(Simulation& s, const Schedule& schedule, const Place& place) {
  if (s.scene.solver.kind == SolverKind::statics && std::holds_alternative<SineProfile>(schedule.profile))
    throw SceneError({{place, "a sine profile needs time; use a dynamic solver, or a table of [load factor, factor]"}});
  if (s.scene.solver.control != StaticControl::load && std::holds_alternative<SmoothProfile>(schedule.profile))
    throw SceneError({{place,
                       "a smooth profile does not go with a load factor that the path decides (solver.control); "
                       "use \"linear\" or a table"}});
  s.schedules.push_back(schedule);
  const int index = static_cast<int>(s.schedules.size()) - 1;
  if (schedule.dial.empty()) return index;
  auto dial = std::find_if(s.dials.begin(), s.dials.end(), [&](const Dial& d) { return d.name == schedule.dial; });
  if (dial == s.dials.end()) {
    dial = s.dials.insert(dial, {schedule.dial, {}});
    s.dial_values.push_back(1);
  }
  dial->schedules.push_back(index);
  return index;
}

int body_index(const Simulation& s, const std::string& name) {
  const auto found =
      std::find_if(s.bodies.begin(), s.bodies.end(), [&](const SimulatedBody& b) { return b.name == name; });
  return static_cast<int>(found - s.bodies.begin());
}

const std::vector<BodyGroup>* SimulatedBody::groups() const {
  return body->cells().nodes.empty() ? nullptr : &body->groups();
}

std::size_t SimulatedBody::index_of(int node) const {
  const int own = node - body->first_node();
  if (own >= 0 && own < body->node_count()) return at(own);
  const std::vector<int>& shared = body->shared_nodes();
  return at(body->node_count()) +
         static_cast<std::size_t>(std::lower_bound(shared.begin(), shared.end(), node) - shared.begin());
}

Selectable SimulatedBody::selectable_nodes() const { return {nodes, node_on_boundary, groups(), {}, body->size()}; }

Selectable SimulatedBody::selectable_surface() const {
  return {body->surface().points, surface_on_boundary, groups(), {}, body->size()};
}

double mean_spacing(const SimulatedBody& b) {
  if (b.nodes.size() < 2) return b.body->size();
  const FrameSearch search(b.nodes);
  double sum = 0;
  for (const Vec3d& x : b.nodes) sum += norm(b.nodes[at(search.nearest(x, 2)[1])] - x);
  return sum / static_cast<double>(b.nodes.size());
}

std::vector<int> find_nodes(const Simulation& s, int body, const Region& region) {
  const SimulatedBody& b = s.bodies[at(body)];
  const std::vector<bool> chosen = select(region, b.selectable_nodes());
  std::vector<int> nodes;
  for (std::size_t i = 0; i < chosen.size(); ++i)
    if (chosen[i]) nodes.push_back(b.node_ids[i]);
  std::sort(nodes.begin(), nodes.end());  // shared ones come last, with lower numbers
  if (!nodes.empty() || s.scene.bodies[at(body)].model != BodyModel::rigid) return nodes;
  const std::vector<bool> surface = select(region, b.selectable_surface());
  if (std::find(surface.begin(), surface.end(), true) != surface.end()) nodes.push_back(b.node_ids[0]);
  return nodes;
}

std::vector<int> select_nodes(const Simulation& s, int body, const Region& region) {
  std::vector<int> nodes = find_nodes(s, body, region);
  if (nodes.empty()) {
    const SimulatedBody& b = s.bodies[at(body)];
    const auto [low, high] = bounds_of(b.nodes);
    throw SceneError(
        {{region.place,
          fmt::format("the region selects no {} of body \"{}\"; its {}s lie between ({:.6g}, "
                      "{:.6g}, {:.6g}) and ({:.6g}, {:.6g}, {:.6g})",
                      b.node_word(), b.name, b.node_word(), low[0], low[1], low[2], high[0], high[1], high[2])}});
  }
  return nodes;
}

}  // namespace fascia
