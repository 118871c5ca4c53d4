#include "core/solver/surface_loads.hpp"

#include "core/base/index.hpp"
#include "core/node/node_force.hpp"

#include <cmath>

namespace fascia {

double SurfaceLoads::add_forces(const State& state, std::span<const double> factors, std::span<double> out) {
  double energy = 0;
  for (std::size_t s = 0; s < forces_.size(); ++s) {
    const SurfaceLoad& load = model_.surfaces[s];
    evaluate(load, state, factors, forces_[s]);
    gather_forces(load, forces_[s].force, state, model_.points.dofs, out);
    energy += forces_[s].energy;
  }
  return energy;
}

void SurfaceLoads::linearize(const State& state, std::span<const double> factors, Linearization& lin) const {
  const DofLayout& dofs = model_.points.dofs;
  for (std::size_t s = 0; s < forces_.size(); ++s) {
    const SurfaceLoad& load = model_.surfaces[s];
    const SurfaceForces& f = forces_[s];
    if (f.stiffness > 0) lin.low_rank.push_back({f.stiffness, volume_gradient(s, state)});
    if (lin.tangent != Tangent::full) continue;
    const double pressure = f.stiffness > 0 && !newton_.empty() ? newton_[s] : f.pressure;
    lin.surfaces.push_back({&load, f.x, pressure, load.weight * factors[at(load.weight_schedule)]});
    for (int v = 0; v < load.vertex_count(); ++v) {
      const Vec3d force = f.force[at(v)] + f.area[at(v)] * (pressure - f.pressure);
      for (const SurfaceShare& share : load.shares_of(v))
        if (model_.kind(share.node) == FrameKind::rigid)
          add_rotation_block(lin.node_blocks.data() + dofs.block_begin(share.node),
                             rotation_tangent(outer(force, lin.Q[at(share.node)] * share.b)) * -1.0);
    }
  }
}

void SurfaceLoads::begin_step() {
  reached_.resize(forces_.size(), 0.0);
  newton_ = saved_ = aimed_ = reached_;
}

void SurfaceLoads::aim(const Linearization& lin, std::span<const double> direction) {
  std::size_t term = 0;
  for (std::size_t s = 0; s < forces_.size(); ++s) {
    if (!(forces_[s].stiffness > 0)) continue;
    const RankOne& volume = lin.low_rank[term++];
    double change = 0;
    for (std::size_t i = 0; i < direction.size(); ++i) change += volume.g[i] * direction[i];
    aimed_[s] = forces_[s].pressure - volume.stiffness * change;
  }
}

void SurfaceLoads::approach(double step) {
  for (std::size_t s = 0; s < newton_.size(); ++s) newton_[s] += step * (aimed_[s] - newton_[s]);
}

std::vector<double> SurfaceLoads::volume_gradient(std::size_t surface, const State& state) const {
  std::vector<double> g(at(model_.dof_count()), 0.0);
  gather_forces(model_.surfaces[surface], forces_[surface].area, state, model_.points.dofs, g);
  return g;
}

double SurfaceLoads::rounding(int part) const {
  double squared = 0;
  for (std::size_t s = 0; s < forces_.size(); ++s)
    if (model_.points.node_part[at(model_.surfaces[s].shares[0].node)] == part)
      squared += forces_[s].rounding * forces_[s].rounding;
  return std::sqrt(squared);
}

}  // namespace fascia
