#include "core/executor/spring_executor.hpp"

#include "core/base/index.hpp"
#include "core/node/node_load.hpp"
#include "core/physics/spring_law.hpp"

namespace fascia {

namespace {

/// Displacement of the place that a spring is attached to.
Vec3d end_of(const Spring& spring, const State& state) {
  return spring_end(spring, state.u[at(spring.node)], state.D[at(spring.node)]);
}

}  // namespace

void SpringExecutor::add_forces(const State& state, std::span<double> gradient) const {
  for (const Spring& spring : set_.springs)
    add_spring_force(set_.dofs.kind(spring.node), spring, state.u[at(spring.node)], state.D[at(spring.node)],
                     gradient.data() + set_.dofs.begin(spring.node));
}

double SpringExecutor::note(const State& state, std::span<const double> part_motion,
                            std::span<double> squares_of_parts) {
  double sum = 0;
  for (std::size_t k = 0; k < set_.springs.size(); ++k) {
    const Spring& spring = set_.springs[k];
    sum += energy_[k] = spring_energy(spring, end_of(spring, state));
    const auto part = at(set_.node_part[at(spring.node)]);
    const double force = spring.stiffness * part_motion[part];
    squares_of_parts[part] += force * force;
  }
  return sum;
}

void SpringExecutor::add_blocks(const State& state, Tangent tangent, std::span<double> node_blocks) const {
  for (const Spring& spring : set_.springs)
    add_spring_block(set_.dofs.kind(spring.node), spring, state.u[at(spring.node)], state.D[at(spring.node)],
                     tangent == Tangent::full, node_blocks.data() + set_.dofs.block_begin(spring.node));
}

Vec3d SpringExecutor::force(const Spring& spring, const State& state) {
  return -spring_gradient(spring, end_of(spring, state));
}

}  // namespace fascia
