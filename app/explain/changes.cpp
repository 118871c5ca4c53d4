#include "app/explain/changes.hpp"

#include "app/study/richardson.hpp"

#include <algorithm>
#include <map>

namespace fascia::app {
namespace {

/// Values below this part of the largest of their kind are zeros with rounding.
constexpr double kZero = 1e-10;

}  // namespace

const ProbeChange* Part::largest_change() const {
  const ProbeChange* largest = nullptr;
  for (const ProbeChange& c : changes)
    if (c.relative && (largest == nullptr || *c.relative > *largest->relative)) largest = &c;
  return largest;
}

Ratio ratio_of_pairs(const std::vector<double>& v, const std::vector<double>& b) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < std::min(v.size(), b.size()); ++i)
    if (b[i] > 0) ratios.push_back(v[i] / b[i]);
  if (ratios.empty()) return {};
  const Spread spread = spread_of(std::move(ratios));
  return {spread.median, spread.low, spread.high};
}

Ratio widened(const Ratio& ratio, const Spread& runs) {
  if (!(runs.low > 0)) return ratio;
  return {ratio.median, ratio.low * runs.low / runs.median, ratio.high * runs.high / runs.median};
}

VariantProbes::VariantProbes(const Scene& scene, const RunRecord& base, const std::filesystem::path& directory) {
  std::map<Quantity, double> largest;
  for (const Probe& probe : scene.probes) {
    Compared& compared = probes_.emplace_back();
    compared.measure.name = compared.measure.probe = probe.name;
    compared.measure.moment = is_dynamic(scene.solver.kind) ? Moment::curve : Moment::end;
    compared.base = measure_run(compared.measure, base, directory);
    double& most = largest[probe.quantity];
    most = std::max(most, norm_of(compared.base.value));
  }
  for (std::size_t i = 0; i < probes_.size(); ++i) probes_[i].largest = largest[scene.probes[i].quantity];
}

std::vector<ProbeChange> VariantProbes::changes(const RunRecord& record, const std::filesystem::path& directory) const {
  std::vector<ProbeChange> changes;
  for (const Compared& compared : probes_) {
    const RunMeasure value = measure_run(compared.measure, record, directory);
    std::optional<double> relative;
    if (norm_of(compared.base.value) > kZero * compared.largest) {
      relative = relative_error(value, compared.base);
    } else if (!value.value.empty()) {
      const double size = norm_of(value.value);
      relative = compared.largest > 0 ? size / compared.largest : size > 0 ? 1 : 0;
    }
    changes.push_back({compared.measure.name, relative});
  }
  return changes;
}

}  // namespace fascia::app
