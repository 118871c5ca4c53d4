#pragma once

#include "core/executor/executor.hpp"
#include "core/step/stress_memory_steps.hpp"

#include <memory>
#include <random>
#include <span>
#include <vector>

/// Materials whose stress fades, for tests.
namespace fascia::test {

/// Half of the stress fades, in two branches.
inline std::shared_ptr<const Viscosity> two_branches(bool shear_only = false) {
  return std::make_shared<const Viscosity>(Viscosity{{{0.3, 0.1}, {0.2, 2}}, shear_only, false});
}

/// A muscle whose fibres lie askew, of the first schedule.
inline std::shared_ptr<const ActiveStress> askew_muscle(double stress) {
  return std::make_shared<const ActiveStress>(ActiveStress::along(normalized(Vec3d{{2, -1, 0.5}}), stress, 0));
}

/// Holds what a step has from points that remember stresses or make them, in the midst of some motion; nothing where
/// none does.
class MidwayMemory {
 public:
  /// @param stress  size of what solids remember [Pa]; shells remember strains, of a hundredth
  MidwayMemory(const PointSet& set, double stress) : memory_(set.memory, PoolSpace()), past_(set.memory.size()) {
    if (memory_.empty()) return;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const std::size_t shells = set.memory.begin[1 + set.blocks.size()] * 6, stride = memory_.stress_size();
    for (std::size_t i = 0; i < past_.size(); ++i) past_[i] = uniform(random) * (i % stride < shells ? stress : 0.01);
    memory_.prepare(Fading::over(0.05));
    given();
  }
  std::span<const double> given() {
    if (memory_.empty()) return {};
    return {memory_.give(past_.data(), factors_.data()), memory_.given_size()};
  }
  std::span<const double> relaxing() const { return {memory_.relaxing(), memory_.given_size()}; }
  std::size_t stress_size() const { return memory_.stress_size(); }
  bool empty() const { return memory_.empty(); }

 private:
  StressMemory<PoolSpace> memory_;
  std::vector<double> past_, factors_{0.7};
};

}  // namespace fascia::test
