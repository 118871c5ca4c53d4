#include "core/space/pool_space.hpp"
#include "core/step/dependents_body.hpp"

namespace fascia {

template class Dependents<PoolSpace>;

void place_dependents(const PointSet& set, State& state) {
  Dependents<PoolSpace>(set).place(state.u.data(), state.D.data());
}

void place_dependent_rates(const PointSet& set, State& state) {
  Dependents<PoolSpace>(set).place_rates(state.v.data(), state.Q_dot.data());
}

}  // namespace fascia
