#include "core/run/explicit_nodes.hpp"

namespace fascia {

namespace {

std::array<double, 16> inverse_affine_mass(const FrameInertia& inertia) {
  std::array<double, 16> mass{}, inverse{};
  mass[0] = inertia.mass > 0 ? inertia.mass : 1.0;
  for (int p = 0; p < 3; ++p) {
    mass[at(1 + p)] = mass[at(4 + 4 * p)] = inertia.first[p];
    for (int q = 0; q < 3; ++q) mass[at(5 + 4 * p + q)] = inertia.second(p, q);
  }
  SmallFactor factor;
  factor.factorize(mass.data(), 4);
  for (std::size_t j = 0; j < 4; ++j) {
    inverse[5 * j] = 1;
    factor.solve(inverse.data() + 4 * j);
  }
  return inverse;
}

}  // namespace

ExplicitNodes::ExplicitNodes(const Model& model, double dt) {
  const auto n = at(model.node_count());
  turning.resize(n);
  center.resize(n);
  damping.resize(n);
  affine.resize(n);
  std::vector<char> held(n, 0);
  for (const FrameConstraint& c : model.constraints) held[at(c.node)] = 1;
  const std::vector<DependentNode>& dependents = model.points.dependents;
  if (!dependents.empty()) follows.assign(n, 0);
  for (const DependentNode& d : dependents)
    follows[at(d.node)] = dependent_dofs(d, model.points.dofs) == model.points.dofs.size(d.node) ? 1 : 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (skips(static_cast<int>(i))) continue;
    const FrameInertia& inertia = model.inertia[i];
    const bool massive = inertia.mass > 0;  // else its place depends on others, and it turns by itself
    if (!model.mass_damping.empty()) {
      const FrameInertia& damped = model.mass_damping[i];
      const double turn = trace(inertia.second);
      if (massive)
        damping[i] = damped.mass / inertia.mass;
      else if (turn > 0)
        damping[i] = trace(damped.second) / turn;
    }
    const double still = 1e-10 * model.points.part_length[at(model.points.node_part[i])] / dt;
    rounding_energy += inertia.mass * still * still;
    if (held[i] != 0) continue;
    if (model.frame_kind[i] == FrameKind::rigid) {
      turning[i] = SpinInertia(inertia);
      if (massive) center[i] = inertia.first * (1 / inertia.mass);
    }
    if (model.frame_kind[i] != FrameKind::affine) continue;
    affine[i] = static_cast<int>(inverse_mass.size());
    inverse_mass.push_back(inverse_affine_mass(inertia));
  }
  if (!dependents.empty() && !model.mass_damping.empty()) find_uneven_damping(model);
}

void ExplicitNodes::find_uneven_damping(const Model& model) {
  uneven_damping.resize(damping.size());
  for (const DependentNode& d : model.points.dependents)
    for (const int host : d.hosts) {
      const std::size_t i = at(host);
      if (model.frame_kind[i] == FrameKind::vertex || skips(host)) continue;
      const double alpha = damping[i];
      const FrameInertia &damped = model.mass_damping[i], &inertia = model.inertia[i];
      uneven_damping[i] = {damped.mass - alpha * inertia.mass, damped.first - inertia.first * alpha,
                           damped.second - inertia.second * alpha};
    }
}

}  // namespace fascia
