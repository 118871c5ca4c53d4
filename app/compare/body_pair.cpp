#include "app/compare/body_pair.hpp"

#include "core/geometry/bounds.hpp"

#include <algorithm>
#include <cstddef>

namespace fascia::app {
namespace {

bool same_cells(const io::VisualMesh& a, const io::VisualMesh& b) {
  const auto same_volumes = [](const io::VisualCells& x, const io::VisualCells& y) {
    return x.type == y.type && x.quadratic == y.quadratic && x.nodes == y.nodes;
  };
  return a.points.size() == b.points.size() && a.triangles == b.triangles && a.lines == b.lines &&
         a.vertices == b.vertices && a.part == b.part &&
         std::equal(a.volumes.begin(), a.volumes.end(), b.volumes.begin(), b.volumes.end(), same_volumes);
}

bool same_mesh(const io::VisualMesh& a, const io::VisualMesh& b) {
  constexpr double kSame = 1e-6;  // of the size: no mesh is moved by less, and rounding is far below
  if (!same_cells(a, b)) return false;
  const std::vector<Vec3d> x = rest_positions(a), y = rest_positions(b);
  const double apart = kSame * bounds_of(x).diagonal();
  return std::equal(x.begin(), x.end(), y.begin(),
                    [&](const Vec3d& p, const Vec3d& q) { return norm(p - q) <= apart; });
}

/// @return 0 or 1: whose samples are taken
int sampled_of(const RestField& a, const RestField& b) {
  if (a.dimension() != b.dimension()) return a.dimension() < b.dimension() ? 0 : 1;
  if (a.has_cells() != b.has_cells()) return a.has_cells() ? 0 : 1;
  return a.resolution() >= b.resolution() ? 0 : 1;
}

}  // namespace

BodyPair pair_bodies(const io::VisualMesh& a, double volume_a, const io::VisualMesh& b, double volume_b) {
  BodyPair pair;
  pair.same_mesh = same_mesh(a, b);
  const auto field_a = rest_field(a, volume_a);
  const auto field_b = pair.same_mesh ? nullptr : rest_field(b, volume_b);
  pair.size = field_a->size();
  if (field_b) {
    pair.sampled = sampled_of(*field_a, *field_b);
    pair.size = std::max(pair.size, field_b->size());
    pair.checks_a = field_a->checks();
    pair.checks_b = field_b->checks();
  }
  const RestField& own = pair.sampled == 0 ? *field_a : *field_b;
  std::vector<Sample> samples = own.samples();
  pair.dimension = own.dimension();
  const RestField* other = pair.sampled == 0 ? field_b.get() : field_a.get();
  constexpr double kOn = 1e-6;  // of the size: on it, but for rounding
  for (Sample& s : samples) {
    pair.measure += s.weight;
    Stencil there = pair.same_mesh ? s.stencil : other->stencil_at(s.X);
    if (there.distance > kReach * pair.size) {
      pair.left_out += s.weight;
      continue;
    }
    if (there.distance > kOn * pair.size) {
      pair.beside += s.weight;
      if (s.weight > 0) pair.farthest = std::max(pair.farthest, there.distance);
    }
    SharedPlace& place = pair.places.emplace_back(SharedPlace{s.X, s.weight, std::move(s.stencil), std::move(there)});
    if (pair.sampled == 1) std::swap(place.a, place.b);
  }
  if (pair.measure > 0) {
    pair.beside /= pair.measure;
    pair.left_out /= pair.measure;
  }
  return pair;
}

}  // namespace fascia::app
