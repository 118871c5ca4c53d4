#include "app/matter.hpp"

#include "core/math/index.hpp"

#include <algorithm>

namespace fascia::app {
namespace {

Vec3d displacement(const MatterPoint& p, const State& state) { return field_at(p.field, state).u; }

}  // namespace

MatterPoint matter_at(int node) {
  Influence whole{};
  whole.w = 1;
  return {{{node}, {whole}, -1}, 0};
}

std::vector<MatterPoint> matter_of(const SimulatedBody& b) {
  const ModelBody& body = *b.body;
  std::vector<MatterPoint> matter;
  for (std::size_t q = 0; q < body.points().size(); ++q)
    matter.push_back({body.attach_point(q), body.points()[q].volume});
  if (b.groups() != nullptr || body.surface().points.empty())
    for (const int node : b.node_ids) matter.push_back(matter_at(node));
  else
    for (std::size_t i = 0; i < body.surface().points.size(); ++i) matter.push_back({body.attach_surface(i), 0});
  return matter;
}

double largest_displacement(const std::vector<MatterPoint>& matter, const State& state) {
  double largest = 0;
  for (const MatterPoint& p : matter) largest = std::max(largest, norm(displacement(p, state)));
  return largest;
}

Vec3d mean_displacement(const std::vector<MatterPoint>& matter, const State& state) {
  Vec3d weighted, sum;
  double volume = 0;
  for (const MatterPoint& p : matter) {
    const Vec3d u = displacement(p, state);
    weighted += u * p.volume;
    volume += p.volume;
    sum += u;
  }
  return volume > 0 ? weighted * (1 / volume)
                    : sum * (1 / static_cast<double>(std::max<std::size_t>(1, matter.size())));
}

}  // namespace fascia::app
