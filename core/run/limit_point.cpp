#include "core/run/path_following.hpp"
#include "core/run/path_measure.hpp"

#include <cmath>

namespace fascia {

bool near_limit_point(MechanicalSystem& system, const State& state, const FactorFunction& factors, double reached) {
  constexpr double kSofter = 4, kSlopeWidth = 2e-4;
  constexpr int kMostUnknowns = 15000;  // whose factor takes a few seconds, whoever solved until here
  if (!system.linear().direct() && system.linear().tangent().free_count() > kMostUnknowns) return false;
  // How far a unit of the loads' growth moves the nodes.
  const Translations dots(system.model());
  const auto answer = [&](const State& from, double ahead, double behind, int& unstable) {
    const std::vector<double> a = factors(ahead), b = factors(behind);
    system.begin_step(from, 0);
    system.set_factors(factors(from.time));
    if (!system.evaluate().finite()) return 0.0;
    const PathDirections d = system.path_directions(a, b, ahead - behind);
    unstable = d.unstable;
    double slope = 0;
    for (std::size_t k = 0; k < a.size(); ++k) slope += (a[k] - b[k]) * (a[k] - b[k]);
    return d.usable && slope > 0 ? dots.norm(d.d_f) / std::sqrt(slope) : 0.0;
  };
  int unstable = 0, at_rest = 0;
  const double now = answer(state, reached, reached - kSlopeWidth, unstable);
  const double first = answer(State::at_rest(system.model()), kSlopeWidth, 0, at_rest);
  return unstable > at_rest || (first > 0 && now > kSofter * first);
}

}  // namespace fascia
