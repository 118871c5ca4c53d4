#include "app/estimate/richardson.hpp"

#include <algorithm>
#include <cmath>

namespace fascia::app {

std::optional<Extrapolation> extrapolated(const LevelDifferences& levels, const OrderGuard& guard) {
  if (!levels.finer && !levels.coarser) return std::nullopt;
  Extrapolation e;
  e.by_finer = levels.finer.has_value();
  const double nearest = e.by_finer ? *levels.finer : *levels.coarser;
  const std::optional<double>& next = e.by_finer ? levels.coarser : levels.coarsest;
  e.measured = next && *next > 0 && nearest > 0;
  e.order = e.measured ? std::clamp(std::log2(*next / nearest), guard.least, guard.most) : guard.assumed;
  const double ratio = std::exp2(e.order);
  e.factor = (e.by_finer ? ratio : 1) / (ratio - 1);
  e.error = e.factor * nearest;
  return e;
}

}  // namespace fascia::app
