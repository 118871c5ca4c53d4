#include "assembly/simulation/held_forces.hpp"

#include "core/base/index.hpp"
#include "core/math/rotation.hpp"
#include "core/node/dof_filter.hpp"

namespace fascia {

std::vector<double> held_forces(const Simulation& s, const ReachedForces& acting) {
  std::vector<double> forces = acting.gradient;
  const DofFilter filter(s.model);
  filter.to_local(forces);
  filter.keep_fixed(forces);
  filter.to_global(forces);
  return forces;
}

Wrench held_at(const Simulation& s, const State& state, const std::vector<double>& held, const FrameConstraint& c) {
  Wrench out;
  const double* g = held.data() + s.model.points.dofs.begin(c.node);
  for (int k = 0; k < 3; ++k) out.force[k] = g[k];
  const Mat3d A = Mat3d::identity() + state.D[at(c.node)];
  if (s.model.kind(c.node) == FrameKind::rigid)
    for (int k = 0; k < 3; ++k) out.moment[k] = g[3 + k];
  else if (s.model.kind(c.node) == FrameKind::affine)
    out.moment = axl(A * transpose(frame_variation(FrameKind::affine, g + 3, A)));
  return out;
}

Wrench held_material(const Simulation& s, const State& state, const ReachedForces& acting, const TetheredMaterial& m,
                     const Vec3d& about) {
  const Tether& tether = s.model.tethers[at(m.tether)];
  const Vec3d f = acting.tether_forces[at(m.tether)], u = field_at(m.field, state).u;
  if (squared_norm(tether.arm) > 0) return {{}, cross(tether.arm + u, f)};  // a couple
  return {f, cross(tether.X + u - about, f)};
}

Wrench force_of_motion(const Simulation& s, const State& state, const ReachedForces& acting, int motion,
                       const Vec3d& about) {
  const std::vector<double> held = held_forces(s, acting);
  Wrench sum;
  for (const FrameConstraint& c : s.model.constraints) {
    const Wrench there = held_at(s, state, held, c);
    Vec3d force;
    for (int k = 0; k < c.translations; ++k) {
      const Vec3d axis = c.translation_axes.row(k);
      if (c.translation_motion[at(k)] == motion) force += axis * dot(axis, there.force);
    }
    const Vec3d torque = c.turning_motion() == motion ? there.moment : Vec3d{};
    sum.add(s.model.rest_position[at(c.node)] + state.u[at(c.node)] - about, force, torque);
  }
  for (const TetheredMaterial& m : s.tethered)
    if (s.model.tethers[at(m.tether)].motion == motion) sum += held_material(s, state, acting, m, about);
  return sum;
}

}  // namespace fascia
