#include "app/results/probes.hpp"

#include <nlohmann/json.hpp>

#include <utility>

namespace fascia::app {

nlohmann::json probe_json(const ResolvedProbe& probe, const std::vector<double>& values) {
  if (values.empty()) return nullptr;  // no state was shown
  const ProbeShape shape = probe_shape(probe.probe->quantity);
  const std::size_t size = shape == ProbeShape::scalar ? 1 : shape == ProbeShape::vector ? 3 : 9;
  const auto one = [&](std::size_t i) -> nlohmann::json {
    if (shape == ProbeShape::scalar) return values[i];
    nlohmann::json rows = nlohmann::json::array();
    for (std::size_t k = 0; k < size; k += 3) {
      nlohmann::json row = {values[i + k], values[i + k + 1], values[i + k + 2]};
      if (shape == ProbeShape::vector) return row;
      rows.push_back(row);
    }
    return rows;
  };
  const bool list = probe.probe->at_is_list || values.size() > size;
  if (!list) return one(0);
  nlohmann::json all = nlohmann::json::array();
  for (std::size_t i = 0; i < values.size(); i += size) all.push_back(one(i));
  return all;
}

void take_row(const Simulation& s, const ProbeValues& row, std::vector<nlohmann::json>& summary) {
  for (std::size_t i = 0; i < s.probes.size(); ++i) {
    nlohmann::json value = probe_json(s.probes[i], row[i]);
    if (s.probes[i].probe->quantity == Quantity::frequency)
      summary[i].push_back(std::move(value));
    else
      summary[i] = std::move(value);
  }
}

}  // namespace fascia::app
