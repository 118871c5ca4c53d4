#include "core/cpu/executor.hpp"
#include "core/math/index.hpp"
#include "core/physics/spring_law.hpp"

/// The springs of CpuExecutor: few beside points and elements, one after the other.
namespace fascia {

void CpuExecutor::add_spring_forces(const State& state, std::span<double> gradient) const {
  for (const Spring& spring : set_.springs) {
    const Vec3d g = spring_gradient(spring, state.u[at(spring.node)]);
    double* out = gradient.data() + set_.dofs.begin(spring.node);
    for (int k = 0; k < 3; ++k) out[k] += g[k];
  }
}

/// Elastic energy of all; adds their rounding by part [N²].
double CpuExecutor::note_springs(const State& state) {
  double sum = 0;
  spring_energy_.resize(set_.springs.size());
  for (std::size_t k = 0; k < set_.springs.size(); ++k) {
    const Spring& spring = set_.springs[k];
    sum += spring_energy_[k] = fascia::spring_energy(spring, state.u[at(spring.node)]);
    const auto part = at(set_.node_part[at(spring.node)]);
    const double force = spring.stiffness * part_motion_[part];
    part_rounding_[part] += force * force;
  }
  return sum;
}

void CpuExecutor::linearize_springs(const State& state, Linearization& out) const {
  for (const Spring& spring : set_.springs) {
    const Mat3d K = spring_tangent(spring, state.u[at(spring.node)], out.tangent == Tangent::full);
    const int n = set_.dofs.size(spring.node);
    double* block = out.node_blocks.data() + set_.dofs.block_begin(spring.node);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) block[n * i + j] += K(i, j);
  }
}

Vec3d CpuExecutor::spring_force(const Spring& spring, const State& state) {
  return -spring_gradient(spring, state.u[at(spring.node)]);
}

}  // namespace fascia
