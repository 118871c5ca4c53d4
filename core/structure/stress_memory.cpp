#include "core/structure/stress_memory.hpp"

#include "core/physics/element_law.hpp"

#include <algorithm>

namespace fascia {

int MemoryLayout::kind_of(const std::shared_ptr<const Viscosity>& of_lane) {
  if (of_lane == nullptr) return -1;
  const auto known =
      std::find_if(kinds.begin(), kinds.end(), [&](const auto& other) { return fade_alike(other, of_lane); });
  const int kind = static_cast<int>(known - kinds.begin());
  if (known == kinds.end()) {
    kinds.push_back(of_lane);
    branches = std::max(branches, static_cast<int>(of_lane->branches.size()));
  }
  return kind;
}

void MemoryLayout::act_in_last(const ActiveStress& stress) {
  schedule.resize(lanes(), -1);
  active.resize((lanes() + kLanes - 1) / kLanes * kLanes * 6);
  schedule.back() = stress.schedule;
  for (int entry = 0; entry < 6; ++entry)
    active[place(lanes() - 1, 6, entry)] = stress.S(kSymmetricPlaces[entry][0], kSymmetricPlaces[entry][1]);
}

void MemoryLayout::add_block(const std::vector<StressBeside>& of_lane) {
  for (const StressBeside& lane : of_lane) {
    viscosity.push_back(kind_of(lane.viscosity));
    if (lane.active) act_in_last(*lane.active);
  }
  begin.push_back(lanes());
  if (!acts()) return;
  schedule.resize(lanes(), -1);
  active.resize(lanes() * 6);
}

}  // namespace fascia
