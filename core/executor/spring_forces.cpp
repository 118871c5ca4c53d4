#include "core/base/index.hpp"
#include "core/executor/executor.hpp"
#include "core/node/node_load.hpp"
#include "core/physics/spring_law.hpp"

/// The springs of CpuExecutor: few beside points and elements, one after the other.
namespace fascia {

namespace {

/// Displacement of the place that a spring is attached to.
Vec3d end_of(const Spring& spring, const State& state) {
  return spring_end(spring, state.u[at(spring.node)], state.D[at(spring.node)]);
}

}  // namespace

void CpuExecutor::add_spring_forces(const State& state, std::span<double> gradient) const {
  for (const Spring& spring : set_.springs)
    add_spring_force(set_.dofs.kind(spring.node), spring, state.u[at(spring.node)], state.D[at(spring.node)],
                     gradient.data() + set_.dofs.begin(spring.node));
}

/// Elastic energy of all; adds their rounding by part [N²].
double CpuExecutor::note_springs(const State& state) {
  double sum = 0;
  spring_energy_.resize(set_.springs.size());
  for (std::size_t k = 0; k < set_.springs.size(); ++k) {
    const Spring& spring = set_.springs[k];
    sum += spring_energy_[k] = fascia::spring_energy(spring, end_of(spring, state));
    const auto part = at(set_.node_part[at(spring.node)]);
    const double force = spring.stiffness * part_motion_[part];
    part_rounding_[part] += force * force;
  }
  return sum;
}

void CpuExecutor::linearize_springs(const State& state, Linearization& out) const {
  for (const Spring& spring : set_.springs)
    add_spring_block(set_.dofs.kind(spring.node), spring, state.u[at(spring.node)], state.D[at(spring.node)],
                     out.tangent == Tangent::full, out.node_blocks.data() + set_.dofs.block_begin(spring.node));
}

Vec3d CpuExecutor::spring_force(const Spring& spring, const State& state) {
  return -spring_gradient(spring, end_of(spring, state));
}

}  // namespace fascia
