#include "gpu/tiles/tile_points.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace fascia {

namespace {

/// Influences must fit their form to this, relative to their own size.
constexpr double kConsistent = 1e-10;

/// Materials have 16-bit numbers on the device.
constexpr std::size_t kMostMaterials = 65535;

struct Lane {
  double w = 0;
  Vec3d g{};
  Mat3d B{};
  int node = 0;
  bool empty() const { return w == 0 && squared_norm(g) == 0 && contract(B, B) == 0; }
};

Lane read_lane(const PointSet& set, int slot, int lane) {
  const double* row = set.shape_of_slot(slot) + lane;
  Lane r;
  r.w = row[0];
  for (int k = 0; k < 3; ++k) r.g[k] = row[(1 + k) * kGroupSize];
  for (int k = 0; k < 9; ++k) r.B(k / 3, k % 3) = row[(4 + k) * kGroupSize];
  r.node = set.slot_node[at(slot)];
  return r;
}

/// The blend factor: across g, B is c w I.
double blend_of(std::span<const Lane> lanes) {
  double sum = 0, weight = 0;
  for (const Lane& l : lanes) {
    const double gg = squared_norm(l.g);
    const double along = gg > 0 ? dot(l.g, l.B * l.g) / gg : 0.0;
    const double across = gg > 0 ? 2 : 3;
    sum += l.w * (trace(l.B) - along);
    weight += across * l.w * l.w;
  }
  const double c = weight > 0 ? sum / weight : 1.0;
  const double nearest = std::round(2 * c) / 2;
  return std::abs(c - nearest) < 1e-9 ? nearest : c;
}

/// Least squares over all influences of (B / c − w I) = (X − x_i) gᵀ.
Vec3d place_of(std::span<const Lane> lanes, double c, std::span<const Vec3d> rest_position) {
  Vec3d sum;
  double weight = 0;
  for (const Lane& l : lanes) {
    sum += (l.B * (1 / c) - Mat3d::diagonal(l.w)) * l.g + rest_position[at(l.node)] * squared_norm(l.g);
    weight += squared_norm(l.g);
  }
  return weight > 0 ? sum * (1 / weight) : rest_position[at(lanes[0].node)];
}

bool fits(const Lane& l, double c, const Vec3d& d) {
  const Mat3d expected = (outer(d, l.g) + Mat3d::diagonal(l.w)) * c;
  const double size = norm(l.B) + std::abs(l.w) + norm(d) * norm(l.g);
  return norm(l.B - expected) <= kConsistent * size;
}

}  // namespace

std::string not_for_tiles(const PointSet& set) {
  if (!set.blocks.empty() || !set.shells.empty() || !set.user_blocks.empty())
    return "the model has finite elements, shells or user blocks";
  if (!set.memory.empty()) return "the model has materials with a viscosity or an active stress";
  if (!set.dependents.empty()) return "the model has nodes that depend on others";
  for (int node = 0; node < set.node_count(); ++node)
    if (set.dofs.kind(node) != FrameKind::rigid) return "the model has nodes that are not rigid frames";
  for (const GroupRule& group : set.rule)
    if (group.rule.law != Law::st_venant_kirchhoff || group.rule.stabilization == Stabilization::affine)
      return "the model has points of another law than the St Venant-Kirchhoff solid";
  return {};
}

int TilePoints::most_influences() const {
  int most = 0;
  for (int q = 0; q < point_count(); ++q) most = std::max(most, influence_count(q));
  return most;
}

TilePointsResult tile_points(const PointSet& set, std::span<const Vec3d> rest_position) {
  TilePointsResult result;
  result.refusal = not_for_tiles(set);
  if (!result.refusal.empty()) return result;
  TilePoints& out = result.points;
  out.rest_position.assign(rest_position.begin(), rest_position.end());
  std::vector<Lane> lanes;
  std::map<TileMaterial, int> numbers;
  for (int group = 0; group < set.group_count(); ++group) {
    const double* material = set.material_of_group(group);
    const bool drills = set.rule[at(group)].rule.stabilization == Stabilization::drilling;
    for (int lane = 0; lane < kGroupSize; ++lane) {
      const auto row = [&](MaterialRow r) { return material[r * kGroupSize + lane]; };
      if (set.lane_point[at(group) * kGroupSize + at(lane)] < 0 || row(kVolume) == 0) continue;
      lanes.clear();
      for (int slot = set.slot_begin[at(group)]; slot < set.slot_begin[at(group) + 1]; ++slot)
        if (const Lane l = read_lane(set, slot, lane); !l.empty()) lanes.push_back(l);
      if (lanes.empty()) continue;
      const double c = blend_of(lanes);
      const Vec3d X = c > 0 ? place_of(lanes, c, rest_position) : Vec3d{};
      const auto consistent = [&](const Lane& l) { return fits(l, c, X - rest_position[at(l.node)]); };
      if (!(c > 0) || !std::all_of(lanes.begin(), lanes.end(), consistent)) {
        result.refusal = "the model has points whose influences are not w (X - x) times one factor";
        return result;
      }
      const TileMaterial own{row(kLambda), row(kMu), drills ? row(kStabilization) : 0.0, row(kStiffnessDamping)};
      const auto [known, added] = numbers.try_emplace(own, static_cast<int>(out.materials.size()));
      if (added) out.materials.push_back(own);
      if (out.materials.size() > kMostMaterials) {
        result.refusal = "the model has more than 65535 materials";
        return result;
      }
      out.material.push_back(known->second);
      out.drilling = out.drilling || own.stabilization > 0;
      out.X.push_back(X);
      out.volume.push_back(row(kVolume));
      out.blend.push_back(c);
      out.source.push_back(group * kGroupSize + lane);
      for (const Lane& l : lanes) {
        out.node.push_back(l.node);
        out.w.push_back(l.w);
        out.g.push_back(l.g);
      }
      out.begin.push_back(out.node.size());
    }
  }
  return result;
}

}  // namespace fascia
