#include "core/structure/stress_memory.hpp"

#include <algorithm>

namespace fascia {

void MemoryLayout::add_block(const std::vector<std::shared_ptr<const Viscosity>>& of_lane) {
  for (const auto& kind : of_lane) {
    if (kind == nullptr) {
      viscosity.push_back(-1);
      continue;
    }
    const auto known =
        std::find_if(kinds.begin(), kinds.end(), [&](const auto& other) { return fade_alike(other, kind); });
    viscosity.push_back(static_cast<int>(known - kinds.begin()));
    if (known != kinds.end()) continue;
    kinds.push_back(kind);
    branches = std::max(branches, static_cast<int>(kind->branches.size()));
  }
  begin.push_back(lanes());
}

}  // namespace fascia
