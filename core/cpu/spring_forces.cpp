#include "core/cpu/executor.hpp"
#include "core/math/index.hpp"
#include "core/physics/spring_law.hpp"
#include "core/solver/node_force.hpp"

/// The springs of CpuExecutor: few beside points and elements, one after the other.
namespace fascia {

namespace {

/// Displacement of the place that a spring is attached to.
Vec3d end_of(const Spring& spring, const State& state) {
  return state.u[at(spring.node)] + state.D[at(spring.node)] * spring.arm;
}

}  // namespace

void CpuExecutor::add_spring_forces(const State& state, std::span<double> gradient) const {
  for (const Spring& spring : set_.springs) {
    const Vec3d g = spring_gradient(spring, end_of(spring, state));
    add_node_force(set_.dofs.kind(spring.node), state.D[at(spring.node)], g, outer(g, spring.arm), {},
                   gradient.data() + set_.dofs.begin(spring.node));
  }
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
  for (const Spring& spring : set_.springs) {
    const Vec3d u = end_of(spring, state);
    const bool full = out.tangent == Tangent::full;
    const Mat3d K = spring_tangent(spring, u, full);
    const int n = set_.dofs.size(spring.node);
    double* block = out.node_blocks.data() + set_.dofs.block_begin(spring.node);
    const auto add = [&](int row, int column, const Mat3d& part) {
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) block[n * (row + i) + column + j] += part(i, j);
    };
    add(0, 0, K);
    if (squared_norm(spring.arm) == 0) continue;
    const Vec3d arm = spring.arm + state.D[at(spring.node)] * spring.arm;
    const Mat3d W = skew(arm) * -1.0;  // du of the end for a small rotation
    add(0, 3, K * W);
    add(3, 0, transpose(W) * K);
    add(3, 3, transpose(W) * K * W);
    if (full) add_rotation_block(block, rotation_tangent(outer(spring_gradient(spring, u), arm)));
  }
}

Vec3d CpuExecutor::spring_force(const Spring& spring, const State& state) {
  return -spring_gradient(spring, end_of(spring, state));
}

}  // namespace fascia
