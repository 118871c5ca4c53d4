#include "core/solver/mechanical_system.hpp"
#include "core/step/step_loops.hpp"

#include <algorithm>
#include <cmath>

/// The part of MechanicalSystem that path following needs.
namespace fascia {

double MechanicalSystem::largest_rotation_in(std::span<const double> vector) const {
  double largest[1];
  space_.sum<0, 1>(model_.node_count(), loops::LargestRotation{data_.view().nodes, vector.data()},
                   loops::StoreSums<0, 1>{largest});
  return largest[0];
}

PathDirections MechanicalSystem::path_directions(std::span<const double> ahead, std::span<const double> behind,
                                                 double width) {
  PathDirections out;
  executor_.linearize(now_, history_, settings_.tangent, lin_);
  add_node_blocks(lin_);
  const std::optional<int> unstable = tangent_.factorize_as_is(lin_);
  if (!unstable) return out;
  out.unstable = *unstable;
  const std::size_t n = gradient_.size();
  std::vector<double> rhs(n), prescribed(n), other(n);
  out.d_r.resize(n);
  out.d_f.resize(n);
  for (std::size_t i = 0; i < n; ++i) rhs[i] = -gradient_[i];
  filter_.to_local(rhs);
  find_prescribed(factors_, prescribed);
  out.usable = tangent_.solve_as_is(prescribed, rhs, out.d_r);

  // Loads are linear in their factors: −∂r/∂λ is the load of the factors' slopes.
  const std::vector<double> present = factors_;
  for (std::size_t k = 0; k < present.size(); ++k) factors_[k] = (ahead[k] - behind[k]) / width;
  data_.set_factors(factors_);
  add_loads_and_inertia();
  rhs = load_;
  factors_ = present;
  data_.set_factors(factors_);
  add_loads_and_inertia();
  const bool moving_tethers =
      std::any_of(model_.tethers.begin(), model_.tethers.end(), [](const Tether& t) { return t.motion >= 0; });
  if (moving_tethers || memory_.acts()) {
    for (const auto& [factors, sign] : {std::pair{ahead, -1.0}, std::pair{behind, 1.0}}) {
      fascia::place_tethers(model_, factors, executor_.targets());
      act(factors.data());
      executor_.forces(now_, history_, other);
      for (std::size_t i = 0; i < n; ++i) rhs[i] += sign * other[i] / width;
    }
    place_tethers();
    act(factors_.data());
  }
  dependents_.transfer(data_.view().nodes, rhs.data());
  filter_.to_local(rhs);
  find_prescribed(ahead, prescribed);
  find_prescribed(behind, other);
  for (std::size_t i = 0; i < n; ++i) prescribed[i] = (prescribed[i] - other[i]) / width;
  out.usable = tangent_.solve_as_is(prescribed, rhs, out.d_f) && out.usable;
  filter_.to_global(out.d_r);
  filter_.to_global(out.d_f);
  dependents_.expand(data_.view().nodes, out.d_r.data());
  dependents_.expand(data_.view().nodes, out.d_f.data());
  out.largest_rotation = largest_rotation_in(out.d_f);
  return out;
}

void MechanicalSystem::keep_loads() {
  kept_loads_.resize(masses_.size(), 0.0);
  for (std::size_t p = 0; p < kept_loads_.size(); ++p)
    kept_loads_[p] = std::max(kept_loads_[p], node_sums_[p * kNodeQuantities + kLoad]);
}

double MechanicalSystem::steer(const PathDirections& directions, double weight, double rate) {
  for (std::size_t i = 0; i < direction_.size(); ++i)
    direction_[i] = weight * directions.d_r[i] + rate * directions.d_f[i];
  return largest_rotation_in(direction_);
}

}  // namespace fascia
