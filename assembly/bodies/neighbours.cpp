#include "assembly/bodies/neighbours.hpp"

#include "assembly/bodies/domains.hpp"
#include "assembly/simulation/regions.hpp"
#include "assembly/specification/errors.hpp"
#include "core/base/index.hpp"
#include "core/body/body_surface.hpp"
#include "core/geometry/bounds.hpp"
#include "core/geometry/triangle_tree.hpp"
#include "coupling/gap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <set>

namespace fascia {

namespace {

std::vector<std::string> givers_of(const Body& body) {
  std::vector<std::string> names;
  if (const auto* between = std::get_if<BetweenDomain>(&body.domain))
    names.insert(names.end(), between->bodies.begin(), between->bodies.end());
  for (const SharedNodes& share : body.shares.value_or(std::vector<SharedNodes>{})) names.push_back(share.body);
  return names;
}

/// Vertices of a rigid body's surface act as frames that move with its one frame.
void share_rigid(const SimulatedBody& giver, const Model& model, const std::vector<bool>& chosen, BodyBuild& build) {
  const int node = giver.body->first_node();
  const std::vector<Vec3d>& points = giver.body->surface().points;
  const auto key = [](const Vec3d& x) { return std::array<double, 3>{x[0], x[1], x[2]}; };
  std::set<std::array<double, 3>> known;
  for (const SharedFrame& f : build.shared)
    if (f.node == node) known.insert(key(f.x));
  for (std::size_t i = 0; i < points.size(); ++i)
    if (chosen[i] && known.insert(key(points[i])).second)
      build.shared.push_back({node, points[i], points[i] - model.rest_position[at(node)], true});
}

/// @param within  further condition on the position
/// @return how many nodes are selected; those that are shared already stay as they are
std::size_t share_nodes(const Simulation& s, const SharedNodes& share, const std::function<bool(const Vec3d&)>& within,
                        BodyBuild& build) {
  const int index = body_index(s, share.body);
  const SimulatedBody& giver = s.bodies[at(index)];
  if (s.scene.bodies[at(index)].model == BodyModel::rigid) {
    std::vector<bool> chosen = select(share.where, giver.selectable_surface());
    for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i] = chosen[i] && within(giver.body->surface().points[i]);
    share_rigid(giver, s.model, chosen, build);
    return static_cast<std::size_t>(std::count(chosen.begin(), chosen.end(), true));
  }
  std::map<int, std::size_t> known;
  for (std::size_t k = 0; k < build.shared.size(); ++k)
    if (squared_norm(build.shared[k].arm) == 0) known.emplace(build.shared[k].node, k);
  const std::vector<bool> chosen = select(share.where, giver.selectable_nodes());
  std::size_t count = 0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (!chosen[i] || !within(giver.nodes[i])) continue;
    ++count;
    const int node = giver.node_ids[i];
    const bool turns = share.rotations || s.model.kind(node) != FrameKind::vertex;
    const auto [same, fresh] = known.try_emplace(node, build.shared.size());
    if (fresh)
      build.shared.push_back({node, giver.nodes[i], {}, turns});
    else
      build.shared[same->second].turns = build.shared[same->second].turns || turns;
  }
  return count;
}

/// The faces of a body's surface whose points are all selected.
GapSide side_of(const Simulation& s, const std::string& name, const Region& where) {
  const SimulatedBody& b = s.bodies[at(body_index(s, name))];
  GapSide side{
      name, {}, b.body->surface(), !b.body->surface().triangles.empty() && free_edges(b.body->faces()).empty()};
  side.faces.points = b.body->surface().points;
  const std::vector<bool> chosen = select(where, b.selectable_surface());
  for (const auto& t : b.body->surface().triangles)
    if (std::all_of(t.begin(), t.end(), [&](int point) { return chosen[at(point)]; }))
      side.faces.triangles.push_back(t);
  return side;
}

void add_shares(const Simulation& s, const Body& body, BodyBuild& build) {
  for (const SharedNodes& share : *body.shares) {
    const int index = body_index(s, share.body);
    const SimulatedBody& giver = s.bodies[at(index)];
    build.interfaces.push_back({index, side_of(s, share.body, share.where).faces});
    const auto anywhere = [](const Vec3d&) { return true; };
    if (share_nodes(s, share, anywhere, build) > 0) continue;
    Bounds bounds = bounds_of(giver.nodes);
    bounds.include(bounds_of(giver.body->surface().points));
    throw SceneError(
        {{share.where.place.key.empty() ? share.place : share.where.place,
          fmt::format("the region selects no {} of body \"{}\", which lies between ({:.6g}, {:.6g}, {:.6g}) and "
                      "({:.6g}, {:.6g}, {:.6g})",
                      giver.node_word(), giver.name, bounds.low[0], bounds.low[1], bounds.low[2], bounds.high[0],
                      bounds.high[1], bounds.high[2])}});
  }
}

/// Nodes of both sides that lie on the selected faces, where the scene does not name the shared ones.
/// Vertices keep no rotation where the weights allow: soft tissue would turn them far.
void share_sides(const Simulation& s, const Body& body, const BetweenDomain& between,
                 const std::array<GapSide, 2>& sides, BodyBuild& build) {
  constexpr double kOnFace = 1e-3;
  for (std::size_t k = 0; k < 2; ++k) {
    const SimulatedBody& giver = s.bodies[at(body_index(s, between.bodies[k]))];
    const TriangleTree faces(sides[k].faces);
    const double tolerance = kOnFace * giver.body->size();
    SharedNodes share;
    share.body = between.bodies[k];
    share.where = {between.where.place, AllRegion{}};
    share.rotations = body.weights != WeightKind::automatic && body.weights != WeightKind::mls;
    share_nodes(
        s, share, [&](const Vec3d& X) { return faces.distance(X) <= tolerance; }, build);
  }
}

MatterParts fill_gap(const Body& body, const BetweenDomain& between, const std::array<GapSide, 2>& sides,
                     BodyBuild& build) {
  switch (between.as) {
    case BetweenKind::volume: {
      GapVolume gap = gap_volume(sides[0], sides[1]);
      build.gap = fmt::format("fills {:.4g} m3 between \"{}\" and \"{}\", {:.3g} to {:.3g} m apart", gap.volume,
                              sides[0].body, sides[1].body, gap.smallest, gap.largest);
      if (gap.touching > 0)
        build.messages.push_back(
            fmt::format("\"{}\" and \"{}\" touch over {:.2g} % of the faces of the first, where there is no "
                        "tissue between them",
                        sides[0].body, sides[1].body, 100 * gap.touching));
      return solid_parts(std::move(gap.surface), gap.volume);
    }
    case BetweenKind::sheet:
      return sheet_parts(body, gap_sheet(sides[0], sides[1], 0));
    case BetweenKind::strands: {
      GapStrands strands = gap_strands(sides[0], sides[1], 4 * *body.radius);
      return strand_parts(*body.radius, std::move(strands.points), std::move(strands.segments));
    }
  }
  return {};
}

}  // namespace

std::vector<std::size_t> build_order(const Scene& scene) {
  std::vector<std::size_t> order;
  std::vector<char> seen(scene.bodies.size(), 0);
  const std::function<void(std::size_t)> visit = [&](std::size_t index) {
    if (seen[index]++ != 0) return;
    for (const std::string& name : givers_of(scene.bodies[index]))
      for (std::size_t other = 0; other < scene.bodies.size(); ++other)
        if (scene.bodies[other].name == name) visit(other);
    order.push_back(index);
  };
  for (std::size_t index = 0; index < scene.bodies.size(); ++index) visit(index);
  return order;
}

void gather_neighbours(Simulation& s, const Body& body, BodyBuild& build) {
  if (const auto* between = std::get_if<BetweenDomain>(&body.domain)) {
    const std::array<GapSide, 2> sides{side_of(s, between->bodies[0], between->where),
                                       side_of(s, between->bodies[1], between->where)};
    build.between = fill_gap(body, *between, sides, build);
    for (const GapSide& side : sides) build.interfaces.push_back({body_index(s, side.body), side.faces});
    if (!body.shares && between->as == BetweenKind::volume) share_sides(s, body, *between, sides, build);
  }
  if (body.shares) add_shares(s, body, build);
}

void give_rotations(Model& model, const std::vector<SharedFrame>& shared, const ModelBody& body) {
  const std::vector<int>& kept = body.shared_nodes();
  for (const SharedFrame& f : shared)
    if (f.turns && model.kind(f.node) == FrameKind::vertex && std::binary_search(kept.begin(), kept.end(), f.node))
      model.frame_kind[at(f.node)] = FrameKind::rigid;
}

}  // namespace fascia
