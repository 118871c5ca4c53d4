#include "assembly/actions/actions.hpp"
#include "assembly/simulation/regions.hpp"
#include "assembly/simulation/simulation.hpp"
#include "assembly/specification/errors.hpp"
#include "core/base/index.hpp"
#include "core/geometry/triangle_tree.hpp"
#include "meshless/scattered/neighbours.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

/// Welds, embeddings and springs of the scene.
namespace fascia {

namespace {

std::string text(const Vec3d& x) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", x[0], x[1], x[2]); }

/// Collects the nodes that depend on others, each with the coupling that made it.
class DependentNodes {
 public:
  explicit DependentNodes(const Simulation& s) : s_(s) {
    for (const FrameConstraint& c : s.model.constraints) held_[c.node] = &c;
  }

  bool is_free(int node) const {
    const auto held = held_.find(node);
    return !by_node_.contains(node) && (held == held_.end() || held->second->translations == 0);
  }

  bool follows(int node) const { return by_node_.contains(node); }

  bool is_held(int node) const { return held_.contains(node); }

  /// A tissue's own frame on the surface of another body.
  void add_follower(DependentNode d) {
    const int node = d.node;
    by_node_[node] = {nullptr, std::move(d)};
  }

  void add(const Coupling& coupling, DependentNode d) {
    const Vec3d& X = s_.model.rest_position[at(d.node)];
    if (const auto known = by_node_.find(d.node); known != by_node_.end())
      throw SceneError({{coupling.place, fmt::format("the node at {} follows couplings.{} already; let each node "
                                                     "follow one body",
                                                     text(X), known->second.coupling->name)}});
    if (const auto held = held_.find(d.node); held != held_.end() && (held->second->translations > 0 || d.turns))
      throw SceneError(
          {{coupling.place, fmt::format("the node at {} of body \"{}\" is held by a constraint, and cannot "
                                        "follow \"{}\" too; leave it out of one of the regions",
                                        text(X), coupling.body, coupling.to)}});
    const int node = d.node;
    by_node_[node] = {&coupling, std::move(d)};
  }

  /// @throws SceneError  nodes that follow one another in a circle
  void check_circles() const {
    std::map<int, int> state;  // 1: on the way, 2: done
    for (const auto& [node, made] : by_node_) follow(node, nullptr, state);
  }

  void give_to(PointSetBuilder& points) {
    for (auto& [node, made] : by_node_) points.add_dependent(std::move(made.node));
  }

 private:
  struct Made {
    const Coupling* coupling = nullptr;
    DependentNode node;
  };

  /// @param last  the coupling that led here, null where a tissue's frames did
  void follow(int node, const Coupling* last, std::map<int, int>& state) const {
    const auto made = by_node_.find(node);
    if (made == by_node_.end() || state[node] == 2) return;
    const Coupling* c = made->second.coupling != nullptr ? made->second.coupling : last;
    if (state[node] == 1 && c != nullptr)
      throw SceneError(
          {{c->place, fmt::format("closes a circle: body \"{}\" follows \"{}\", which follows \"{}\" in turn, "
                                  "at {}; leave one of the couplings out",
                                  c->body, c->to, c->body, text(s_.model.rest_position[at(node)]))}});
    state[node] = 1;
    for (const int host : made->second.node.hosts) follow(host, c, state);
    state[node] = 2;
  }

  const Simulation& s_;
  std::map<int, const FrameConstraint*> held_;
  std::map<int, Made> by_node_;
};

/// The frames of a body that others are welded to.
class WeldHosts {
 public:
  WeldHosts(const Simulation& s, const Coupling& c, const SimulatedBody& host) {
    std::vector<Vec3d> positions;
    for (std::size_t i = 0; i < host.nodes.size(); ++i) {
      if (s.model.kind(host.node_ids[i]) == FrameKind::vertex) continue;
      frames_.push_back(host.node_ids[i]);
      positions.push_back(host.nodes[i]);
    }
    if (frames_.empty())
      throw SceneError({{c.to_place, fmt::format("body \"{}\" has no frames, only nodes without rotation; use kind = "
                                                 "\"embed\"",
                                                 host.name)}});
    search_.emplace(positions);
  }

  int nearest(const Vec3d& X) const { return frames_[at(search_->nearest(X, 1)[0])]; }

 private:
  std::vector<int> frames_;
  std::optional<FrameSearch> search_;
};

DependentNode welded(const Simulation& s, const Coupling& c, int node, const WeldHosts& hosts) {
  const Vec3d& X = s.model.rest_position[at(node)];
  const int nearest = hosts.nearest(X);
  const FrameKind kind = s.model.kind(node), host_kind = s.model.kind(nearest);
  if (kind == FrameKind::affine || (kind == FrameKind::rigid && host_kind == FrameKind::affine))
    throw SceneError({{c.place, "welds affine frames; use kind = \"embed\", or frames of kind \"rigid\""}});
  return {node, {nearest}, {1.0}, {X - s.model.rest_position[at(nearest)]}, kind == FrameKind::rigid};
}

/// The node in the field of a body, without what does not move it.
DependentNode follower(const Simulation& s, int node, const SimulatedBody& host) {
  constexpr double kNothing = 1e-14;
  const Attachment a = host.body->attach(s.model.rest_position[at(node)]);
  DependentNode d;
  d.node = node;
  // A place beside the host's matter moves with its frames: with the full lever.
  Vec3d beside = s.model.rest_position[at(node)];
  double turning = 0;
  for (std::size_t k = 0; k < a.nodes.size(); ++k) {
    const Influence& i = a.influences[k];
    beside -= s.model.rest_position[at(a.nodes[k])] * i.w + i.b;
    if (!host.vertices) turning += i.w;
  }
  for (std::size_t k = 0; k < a.nodes.size(); ++k) {
    Influence i = a.influences[k];
    if (turning > 0.5) i.b += beside * (i.w / turning);
    if (std::abs(i.w) <= kNothing && norm(i.b) <= kNothing * host.body->size()) continue;
    d.hosts.push_back(a.nodes[k]);
    d.w.push_back(i.w);
    d.b.push_back(s.model.kind(a.nodes[k]) == FrameKind::vertex ? Vec3d{} : i.b);
  }
  return d;
}

DependentNode embedded(const Simulation& s, const Coupling& c, int node, const SimulatedBody& host) {
  constexpr double kOnBody = 1e-3;
  const Vec3d& X = s.model.rest_position[at(node)];
  const double distance = host.body->distance(X);
  if (distance > kOnBody * host.body->size())
    throw SceneError({{c.place, fmt::format("the node at {} of body \"{}\" lies {:.4g} m outside body \"{}\", which "
                                            "should carry it; choose where so that all its nodes lie in that body",
                                            text(X), c.body, distance, host.name)}});
  DependentNode d = follower(s, node, host);
  if (std::find(d.hosts.begin(), d.hosts.end(), node) != d.hosts.end())
    throw SceneError(
        {{c.place, fmt::format("the node at {} belongs to body \"{}\" and to \"{}\"; leave it out of where", text(X),
                               c.body, host.name)}});
  return d;
}

/// The node takes the rotation of the host that moves it most; of equals, as between the ends of an edge, the first.
void turn_with_nearest(const Simulation& s, DependentNode& d) {
  constexpr double tie = 1e-6;
  const double largest = *std::max_element(d.w.begin(), d.w.end());
  std::size_t most = d.w.size();
  for (std::size_t k = 0; k < d.w.size(); ++k)
    if (d.w[k] >= (1 - tie) * largest && (most == d.w.size() || d.hosts[k] < d.hosts[most])) most = k;
  if (s.model.kind(d.hosts[most]) != FrameKind::rigid) return;
  std::swap(d.hosts[0], d.hosts[most]);
  std::swap(d.w[0], d.w[most]);
  std::swap(d.b[0], d.b[most]);
  d.turns = true;
}

/// A tissue's own frames on the faces of another body, between the nodes that it shares there, follow that body.
void attach_interfaces(const Simulation& s, const SimulatedBody& tissue, DependentNodes& dependents) {
  constexpr double kOnFace = 0.05;  // spacings
  const double tolerance = tissue.interfaces.empty() ? 0 : kOnFace * mean_spacing(tissue);
  for (const Interface& face : tissue.interfaces) {
    if (face.faces.triangles.empty()) continue;
    const SimulatedBody& host = s.bodies[at(face.body)];
    const TriangleTree faces(face.faces);
    for (int i = 0; i < tissue.body->node_count(); ++i) {
      const int node = tissue.node_ids[at(i)];
      if (!dependents.is_free(node) || faces.distance(tissue.nodes[at(i)]) > tolerance) continue;
      DependentNode d = follower(s, node, host);
      if (s.model.kind(node) == FrameKind::rigid && !host.vertices && !dependents.is_held(node))
        turn_with_nearest(s, d);
      dependents.add_follower(std::move(d));
    }
  }
}

/// From the selected nodes; of a rigid body from the selected points of its surface, if there are any; from its mass
/// centre where all of it is selected.
void add_springs(const Simulation& s, const Coupling& c, PointSetBuilder& points, BuiltCoupling& built) {
  constexpr double kAtPoint = 1e-9;  // of the body's size
  const int body = body_index(s, c.body);
  const SimulatedBody& b = s.bodies[at(body)];
  std::vector<Spring> springs;
  if (s.scene.bodies[at(body)].model == BodyModel::rigid && !std::holds_alternative<AllRegion>(c.where.shape)) {
    const std::vector<bool> chosen = select(c.where, b.selectable_surface());
    const std::vector<Vec3d>& X = b.body->surface().points;
    for (std::size_t i = 0; i < X.size(); ++i)
      if (chosen[i]) springs.push_back({b.node_ids[0], 0, X[i], c.point, {}, X[i] - b.nodes[0]});
  }
  if (springs.empty())
    for (const int node : built.nodes) springs.push_back({node, 0, s.model.rest_position[at(node)], c.point, {}, {}});
  for (Spring& spring : springs) {
    spring.stiffness = c.stiffness / static_cast<double>(springs.size());
    spring.direction = c.direction.value_or(Vec3d{});
    if (norm(spring.X - spring.point) <= kAtPoint * b.body->size()) spring.point = spring.X;
    built.springs.push_back(points.spring_count());
    points.add_spring(spring);
  }
}

/// @throws SceneError  a vertex of a surface that rides on nothing, which neither forces nor mass would move
void check_surfaces_ride(const Simulation& s, const DependentNodes& dependents) {
  for (const SimulatedBody& b : s.bodies) {
    const Body& described = s.scene.bodies[static_cast<std::size_t>(&b - s.bodies.data())];
    if (described.model != BodyModel::surface) continue;
    const auto follows = [&](int node) { return dependents.follows(node); };
    const auto first = std::find_if_not(b.node_ids.begin(), b.node_ids.end(), follows);
    if (first == b.node_ids.end()) continue;
    throw SceneError(
        {{described.place,
          fmt::format("{} of its {} vertices ride on nothing, the first at {}; a surface has no matter of its own: let "
                      "its couplings select every vertex (where = \"all\")",
                      std::count_if(first, b.node_ids.end(), [&](int node) { return !follows(node); }),
                      b.node_ids.size(), text(s.model.rest_position[at(*first)]))}});
  }
}

void add_coupling(Simulation& s, const Coupling& c, PointSetBuilder& points, DependentNodes& dependents) {
  const int body = body_index(s, c.body);
  if (c.kind != CouplingKind::spring && !s.bodies[at(body)].body->interpolates())
    s.warnings.add("scattered", c.place,
                   "holds scattered frames, whose weights do not interpolate: the material between them parts from the "
                   "other body (the gap in the results tells how far); let the body share the frames of the other one "
                   "(frames.share), or take a grid or finer frames");
  BuiltCoupling& built = s.couplings.emplace_back();
  built.nodes = select_nodes(s, body, c.where);
  if (c.kind == CouplingKind::spring) return add_springs(s, c, points, built);
  const SimulatedBody& host = s.bodies[at(body_index(s, c.to))];
  if (c.kind == CouplingKind::weld) {
    const WeldHosts hosts(s, c, host);
    for (const int node : built.nodes) dependents.add(c, welded(s, c, node, hosts));
  } else {
    for (const int node : built.nodes) dependents.add(c, embedded(s, c, node, host));
  }
}

}  // namespace

void add_couplings(Simulation& s, PointSetBuilder& points) {
  DependentNodes dependents(s);
  SceneErrors errors;
  for (const Coupling& c : s.scene.couplings) errors.gather([&] { add_coupling(s, c, points, dependents); });
  errors.tell();
  for (const SimulatedBody& b : s.bodies) attach_interfaces(s, b, dependents);
  dependents.check_circles();
  check_surfaces_ride(s, dependents);
  dependents.give_to(points);
}

}  // namespace fascia
