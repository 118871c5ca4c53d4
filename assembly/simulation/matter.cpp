#include "assembly/simulation/matter.hpp"

#include "assembly/simulation/regions.hpp"
#include "core/base/index.hpp"
#include "core/physics/ellipticity.hpp"

#include <algorithm>

namespace fascia {

void MatterDisplacement::add(const Vec3d& u, double volume) {
  largest_ = std::max(largest_, norm(u));
  weighted_ += u * volume;
  volume_ += volume;
  sum_ += u;
  ++places_;
}

void MatterDisplacement::add(const SimulatedBody& b, const State& state) {
  const ModelBody& body = *b.body;
  for (std::size_t q = 0; q < body.points().size(); ++q)
    add(field_at(body.attach_point(q), state).u, body.points()[q].volume);
  if (b.groups() != nullptr || body.surface().points.empty())
    for (const int node : b.node_ids) add(state.u[at(node)], 0);
  else
    for (std::size_t i = 0; i < body.surface().points.size(); ++i) add(field_at(body.attach_surface(i), state).u, 0);
}

void MatterDisplacement::add_surface(const SimulatedBody& b, const Region& region, const State& state) {
  if (b.body->surface().points.empty()) return;
  const std::vector<bool> chosen = select(region, b.selectable_surface());
  for (std::size_t i = 0; i < chosen.size(); ++i)
    if (chosen[i]) add(field_at(b.body->attach_surface(i), state).u, 0);
}

Vec3d MatterDisplacement::mean() const {
  if (volume_ > 0) return weighted_ * (1 / volume_);
  return sum_ * (1 / static_cast<double>(std::max<std::size_t>(1, places_)));
}

FoldedPoints folded_points(const SimulatedBody& b, const State& state) {
  FoldedPoints folded;
  const auto look = [&](const Mat3d& H) {
    const double J = determinant(Mat3d::identity() + H);
    folded.inverted += J <= 0 ? 1 : 0;
    folded.flat += J > 0 && J < kFlat ? 1 : 0;
  };
  if (b.vertices) {  // nothing turns
    for (const Mat3d& H : b.body->gradients(state)) look(H);
    return folded;
  }
  for (std::size_t q = 0; q < b.body->points().size(); ++q) {
    const FieldValue f = field_at(b.body->attach_point(q), state);
    look(f.H);
    folded.unresolved += determinant(Mat3d::identity() + f.D) < kResolved ? 1 : 0;
  }
  return folded;
}

std::string yielding_sentence(const Simulation& s, std::size_t body, const State& state) {
  constexpr double kCompressible = 0.4;
  const SimulatedBody& b = s.bodies[body];
  const Body& described = s.scene.bodies[body];
  const bool own = described.formulation == Formulation::large_strain && described.locking != Locking::f_bar &&
                   !b.body->selective() && s.model.points.memory.empty();
  int count = 0;
  for (std::size_t q = 0; own && q < b.body->points().size(); ++q) {
    const BodyPoint& p = b.body->points()[q];
    if (p.law != Law::st_venant_kirchhoff || p.poisson() > kCompressible) continue;
    const Mat3d F = Mat3d::identity() + field_at(b.body->attach_point(q), state).H;
    count += is_strongly_elliptic(p, F) ? 0 : 1;
  }
  if (count == 0) return "";
  return "body \"" + b.name + "\" is pressed or sheared so far at " + std::to_string(count) + " of " +
         std::to_string(b.body->points().size()) +
         " integration points that St Venant-Kirchhoff materials give way (law = \"neo-hookean\" does not)";
}

MatterDisplacement displacement_of_matter(const Simulation& s, const ResolvedProbe& probe, const State& state) {
  MatterDisplacement displacement;
  if (probe.probe->where && s.scene.bodies[at(probe.body)].model == BodyModel::rigid) {
    displacement.add_surface(s.bodies[at(probe.body)], *probe.probe->where, state);
    if (!displacement.empty()) return displacement;
  }
  if (probe.probe->where) {
    for (const int node : probe.nodes) displacement.add(state.u[at(node)], 0);
    return displacement;
  }
  for (std::size_t b = 0; b < s.bodies.size(); ++b)
    if (probe.body < 0 || at(probe.body) == b) displacement.add(s.bodies[b], state);
  return displacement;
}

}  // namespace fascia
