#include "coupling/gap_surface.hpp"
#include "coupling/rigid_body.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {

using namespace gap_parts;

GapVolume gap_volume(const GapSide& first, const GapSide& second) {
  constexpr double most_folded = 1.01;  // of the volume, with the folds counted as if they were none
  const CheckedSides sides = checked_sides(first, second);
  GapPatch patch = gap_patch(sides);
  double volume = 0, amount = 0;
  for (std::size_t t = 0; t < patch.triangles.size(); ++t) {
    const double prism = prism_volume(patch, t);
    volume += prism;
    amount += std::abs(prism);
  }
  GapVolume gap;
  gap.smallest = gap.largest = patch.gap(0);
  for (std::size_t i = 0; i < patch.points.size(); ++i) {
    gap.smallest = std::min(gap.smallest, patch.gap(static_cast<int>(i)));
    gap.largest = std::max(gap.largest, patch.gap(static_cast<int>(i)));
  }
  gap.touching = drop_touching(patch, sides.touching);
  if (patch.triangles.empty()) fail_touching(first.body, second.body);
  if (amount > most_folded * volume) fail_facing(first.body, second.body);
  separate(patch, sides);
  gap.surface = surface_over(patch, sides);
  gap.volume = properties_of_volume(gap.surface).measure;
  if (!(gap.volume > 0)) fail_facing(first.body, second.body);
  return gap;
}

}  // namespace fascia
