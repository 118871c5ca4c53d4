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
#include <set>

namespace fascia {

namespace {

/// A point that takes a share of a total load.
struct Share {
  Vec3d X{};
  Attachment attachment;
  double part = 0;
  Vec3d force{}, torque{};
};

void add_gravity(Simulation& s) {
  const Vec3d& g = s.scene.world.gravity;
  if (squared_norm(g) == 0) return;
  DeadLoad load;
  load.schedule = new_schedule(s, s.scene.world.schedule, {s.scene.path.string(), 1, 1, "world.gravity"});
  for (int i = 0; i < s.model.node_count(); ++i) {
    const FrameInertia& inertia = s.model.inertia[at(i)];
    load.nodes.push_back({i, g * inertia.mass, outer(g, inertia.first), {}});
  }
  // Free fall must not strain a body: in dynamics weight is shared as mass is. Other bodies may add to a node's mass,
  // and hosts may have taken it.
  for (const SimulatedBody& b : s.bodies)
    for (std::size_t i = 0; i < b.lumped_mass.size() && s.scene.solver.kind == SolverKind::statics; ++i)
      load.nodes[at(b.body->first_node()) + i].force += g * (b.body->weights()[i] - b.lumped_mass[i]);
  s.gravity_load = static_cast<int>(s.model.loads.size());
  s.model.loads.push_back(std::move(load));
}

/// Faces of the body's surface whose vertices are all selected.
std::vector<Share> surface_shares(const SimulatedBody& owner, const Region& region) {
  if (owner.body->surface().triangles.empty()) return {};
  const std::vector<bool> chosen = select(region, owner.selectable_surface());
  std::vector<Share> shares;
  for (FacePoint& p : owner.body->face_points())
    if (std::all_of(p.nodes.begin(), p.nodes.end(), [&](int node) { return chosen[at(node)]; }))
      shares.push_back({p.X, std::move(p.attachment), p.area, {}, {}});
  return shares;
}

std::vector<Share> volume_shares(const SimulatedBody& owner, const Region& region) {
  const ModelBody& body = *owner.body;
  std::vector<Vec3d> positions;
  std::vector<int> cells;
  for (const BodyPoint& p : body.points()) {
    positions.push_back(p.middle);
    cells.push_back(p.cell);
  }
  const std::vector<bool> chosen = select(region, {positions, {}, owner.groups(), cells, body.size()});
  std::vector<Share> shares;
  for (std::size_t q = 0; q < positions.size(); ++q)
    if (chosen[q]) shares.push_back({body.points()[q].X, body.attach_point(q), body.points()[q].volume, {}, {}});
  return shares;
}

using Edges = std::set<std::pair<int, int>>;

/// Edges of the surface's triangles, and segments of lines, whose ends are selected.
/// @param among  edges of the surface that count; null for all
Edges edges_in(const SimulatedBody& owner, const Region& region, const Edges* among = nullptr) {
  const ModelBody& body = *owner.body;
  Edges edges;
  if (body.surface().points.empty()) return edges;
  const std::vector<bool> chosen = select(region, owner.selectable_surface());
  const auto add = [&](int a, int b) {
    if (chosen[at(a)] && chosen[at(b)]) edges.insert(std::minmax(a, b));
  };
  for (const auto& t : body.surface().triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (among == nullptr || among->contains(std::minmax(t[k], t[(k + 1) % 3]))) add(t[k], t[(k + 1) % 3]);
  for (const auto& s : body.segments()) add(s[0], s[1]);
  return edges;
}

/// Two Gauss points of each edge, whose parts are lengths.
std::vector<Share> edge_shares(const SimulatedBody& owner, const Edges& edges) {
  const ModelBody& body = *owner.body;
  const std::vector<Vec3d>& points = body.surface().points;
  std::vector<Share> shares;
  for (const auto& [i, j] : edges) {
    const Vec3d &a = points[at(i)], &b = points[at(j)];
    for (const double t : {0.5 - std::sqrt(1.0 / 12), 0.5 + std::sqrt(1.0 / 12)}) {
      const Vec3d X = a + (b - a) * t;
      shares.push_back({X, body.attach(X), 0.5 * norm(b - a), {}, {}});
    }
  }
  return shares;
}

/// Of an open surface its free edges count, and segments of lines; of a closed one every edge, if they make up lines.
std::vector<Share> line_shares(const SimulatedBody& owner, const Region& region) {
  Edges free;
  for (const auto& [a, b] : free_edges(owner.body->faces())) free.insert({a, b});
  std::vector<Share> shares = edge_shares(owner, edges_in(owner, region, free.empty() ? nullptr : &free));
  const auto fail = [&](const char* what) {
    throw SceneError({{region.place, fmt::format(fmt::runtime(what), owner.name)}});
  };
  if (shares.empty())
    fail(free.empty() ? "the region holds no edge of body \"{}\" with both its ends; enlarge it"
                      : "the region holds no free edge of body \"{}\" with both its ends; a line_force loads "
                        "free edges, inside use total_force, traction or pressure");
  if (free.empty() && !surface_shares(owner, region).empty())
    fail(
        "the region holds whole faces of body \"{}\", which is closed; must hold edges along a line only, for faces "
        "use traction");
  return shares;
}

/// The frames that `nearest` or `ids` pick, each with the same part.
std::vector<Share> frame_shares(const Simulation& s, int body, const Region& region) {
  std::vector<Share> shares;
  const SimulatedBody& b = s.bodies[at(body)];
  for (const int node : select_nodes(s, body, region)) {
    const Vec3d& X = s.model.rest_position[at(node)];
    Attachment place;
    if (b.vertices) {  // a vertex takes no torque: its element does
      place = b.body->attach(X);
    } else {
      place.nodes = {node};
      place.influences.resize(1);
      place.influences[0].w = 1;
    }
    shares.push_back({X, std::move(place), 1.0, {}, {}});
  }
  return shares;
}

/// They do not run around something: a vertex has an odd number of them.
bool has_ends(const Edges& edges) {
  std::map<int, int> count;
  for (const auto& [a, b] : edges) ++count[a], ++count[b];
  return std::any_of(count.begin(), count.end(), [](const auto& c) { return c.second % 2 != 0; });
}

/// Shares of a total load.
struct Spread {
  std::vector<Share> shares;
  bool open_chain = false;  ///< along edges that end somewhere, of nodes that turn
};

/// By frames where the region picks single ones; by volume where it holds material points, unless it asks for the
/// boundary; else by area of the faces, by length of the edges, by frames: the first that it holds. Parts add to 1.
Spread spread_of(const Simulation& s, int index, const Load& load) {
  const SimulatedBody& body = s.bodies[at(index)];
  Spread spread;
  std::vector<Share>& shares = spread.shares;
  if (names_frames(*load.where))
    shares = frame_shares(s, index, *load.where);
  else if (!names_boundary(*load.where))
    shares = volume_shares(body, *load.where);
  if (shares.empty()) shares = surface_shares(body, *load.where);
  if (shares.empty()) {
    const Edges edges = edges_in(body, *load.where);
    shares = edge_shares(body, edges);
    spread.open_chain = has_ends(edges) && !body.vertices;
  }
  if (shares.empty() && !find_nodes(s, index, *load.where).empty()) shares = frame_shares(s, index, *load.where);
  if (shares.empty())
    throw SceneError({{load.where->place,
                       fmt::format("the region holds no material and no face of body \"{}\"; enlarge it", body.name)}});
  double total = 0;
  for (const Share& share : shares) total += share.part;
  for (Share& share : shares) share.part /= total;
  return spread;
}

/// Forces without resultant that make up a torque: part (a × r) about the centre c, with a from the shares' inertia.
/// Where the shares lie on a line or a point, forces cannot: each takes its part of the torque itself. So do edges
/// that end somewhere and whose nodes turn: their rise over the chord is no lever to bend a wall by. Long arcs have
/// one.
void spread_torque(Spread& spread, const Vec3d& torque) {
  // det I over (tr I)³ of an arc, which is 0 of a line: 0.005 of 90°, 0.017 of 180°.
  constexpr double kLine = 1e-9, kArc = 0.01;
  std::vector<Share>& shares = spread.shares;
  Vec3d center;
  for (const Share& s : shares) center += s.X * s.part;
  Mat3d inertia;
  for (const Share& s : shares) {
    const Vec3d r = s.X - center;
    inertia += (Mat3d::diagonal(squared_norm(r)) - outer(r, r)) * s.part;
  }
  if (determinant(inertia) <= (spread.open_chain ? kArc : kLine) * std::pow(trace(inertia), 3)) {
    for (Share& s : shares) s.torque += torque * s.part;
    return;
  }
  const Vec3d a = inverse(inertia) * torque;
  for (Share& s : shares) s.force += cross(a, s.X - center) * s.part;
}

/// J^T of forces and torques at material points, summed by frame; or followers, one a point.
/// @param vertices  the body's nodes do not turn, whatever rotation some have from other bodies
void add_shares(Simulation& s, const std::vector<Share>& shares, bool vertices, bool follower, int schedule) {
  std::map<int, NodeLoad> by_node;
  for (const Share& share : shares) {
    const Attachment& a = share.attachment;
    FollowerLoad f{schedule, share.force, share.torque, a.nodes, {}, {}, {}};
    for (std::size_t k = 0; k < a.nodes.size(); ++k) {
      const Influence& i = a.influences[k];
      f.w.push_back(i.w);
      f.b.push_back(i.b);
      if (vertices) f.g.push_back(i.g);
      NodeLoad& n = by_node[a.nodes[k]];
      n.node = a.nodes[k];
      n.force += f.force * i.w;
      n.couple += outer(f.force, i.b);
      if (!vertices && s.model.kind(n.node) == FrameKind::rigid) {
        n.torque += f.torque * i.w;
      } else {  // of affine frames and vertices through the spin of the field: that of one A alone is held by
                // stabilisation only
        const Mat3d P = skew(f.torque) * 0.5;
        n.force += P * i.g;
        n.couple += times_transpose(P, i.B);
      }
    }
    if (follower) s.model.followers.push_back(std::move(f));
  }
  if (follower) return;
  DeadLoad load;
  load.schedule = schedule;
  for (const auto& [node, n] : by_node) load.nodes.push_back(n);
  s.model.loads.push_back(std::move(load));
}

/// A force on each vertex of a rigid body's surface that the region holds. @return  whether there is one
bool add_vertex_forces(Simulation& s, const SimulatedBody& owner, const Load& load, int schedule) {
  if (owner.body->surface().points.empty()) return false;
  const std::vector<bool> chosen = select(*load.where, owner.selectable_surface());
  std::vector<Share> shares;
  for (std::size_t i = 0; i < chosen.size(); ++i)
    if (chosen[i])
      shares.push_back({owner.body->surface().points[i], owner.body->attach_surface(i), 1, *load.force_per_node, {}});
  if (!shares.empty()) add_shares(s, shares, false, load.follower, schedule);
  return !shares.empty();
}

void add_node_forces(Simulation& s, int body, const Load& load, int schedule) {
  const bool of_vertices =
      s.scene.bodies[at(body)].model == BodyModel::rigid && !std::holds_alternative<AllRegion>(load.where->shape);
  if (of_vertices && add_vertex_forces(s, s.bodies[at(body)], load, schedule)) return;
  DeadLoad dead;
  dead.schedule = schedule;
  if (load.follower && s.bodies[at(body)].vertices)
    throw SceneError({{load.place, "turns with single nodes, which vertices do not; use total_force"}});
  for (const int node : select_nodes(s, body, *load.where)) {
    if (load.follower)
      s.model.followers.push_back({schedule, *load.force_per_node, {}, {node}, {1.0}, {Vec3d{}}});
    else
      dead.nodes.push_back({node, *load.force_per_node, {}, {}});
  }
  if (!load.follower) s.model.loads.push_back(std::move(dead));
}

void add_load(Simulation& s, const Load& load) {
  const int body = body_index(s, load.body), schedule = new_schedule(s, load.schedule, load.place);
  const SimulatedBody& b = s.bodies[at(body)];
  if (load.total_force || load.total_torque) {
    Spread spread = spread_of(s, body, load);
    if (load.total_force)
      for (Share& share : spread.shares) share.force = *load.total_force * share.part;
    if (load.total_torque) spread_torque(spread, *load.total_torque);
    add_shares(s, spread.shares, b.vertices, load.follower, schedule);
  }
  if (load.traction) {
    std::vector<Share> shares = surface_shares(b, *load.where);
    if (shares.empty())
      throw SceneError({{load.where->place, fmt::format("the region holds no face of body \"{}\" with all its "
                                                        "corners; enlarge it",
                                                        b.name)}});
    for (Share& share : shares) share.force = *load.traction * share.part;
    add_shares(s, shares, b.vertices, false, schedule);
  }
  if (load.pressure) add_pressure(s, body, load, schedule);
  if (load.line_force) {
    std::vector<Share> shares = line_shares(b, *load.where);
    for (Share& share : shares) share.force = *load.line_force * share.part;
    add_shares(s, shares, b.vertices, load.follower, schedule);
  }
  if (load.force_per_node) add_node_forces(s, body, load, schedule);
  if (load.at) {
    const Vec3d X = place_on_body(s, body, *load.at, load.at_place);
    add_shares(s, {{X, b.body->attach(X), 1.0, load.force.value_or(Vec3d{}), load.torque.value_or(Vec3d{})}},
               b.vertices, load.follower, schedule);
  }
}

}  // namespace

void add_loads(Simulation& s) {
  add_gravity(s);
  SceneErrors errors;
  for (const Load& load : s.scene.loads) errors.gather([&] { add_load(s, load); });
  errors.gather([&] { add_fluids(s); });
  errors.tell();
}

}  // namespace fascia
