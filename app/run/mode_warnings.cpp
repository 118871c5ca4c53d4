#include "app/run/mode_warnings.hpp"

#include "assembly/simulation/mechanisms.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fascia::app {

namespace {

/// Stabilisation holds a hundredth of a body's own modes, and a tenth and more of those of badly coupled frames.
constexpr double kHollow = 0.1;
/// More than this part of a frequency is worth a word.
constexpr double kOpen = 1e-6;
/// Zeros are free motions where there are no more than that of them, and what rounding hides is so far below the body's
/// own frequencies.
constexpr double kFarBelow = 0.01;

}  // namespace

void warn_of_modes(const Modes& modes, const Simulation& simulation, Warnings& warnings) {
  if (modes.uncertainty > kOpen)
    warnings.add("rounding",
                 fmt::format("rounding leaves {:.0e} of a frequency open: soft parts move beside stiff ones",
                             modes.uncertainty));
  const auto& f = modes.frequency;
  const auto own = std::find_if(f.begin(), f.end(), [](double value) { return value > 0; });
  const std::ptrdiff_t zeros = own - f.begin();
  const bool is_near = own != f.end() && modes.least > kFarBelow * *own;
  if (zeros > 0 && (is_near || zeros > free_motion_count(find_mechanisms(simulation))))
    warnings.add(
        "rounding",
        fmt::format("frequencies below {:.2g} Hz cannot be told from 0, for rounding of stiff parts", modes.least));
  const auto is_hollow = [](double part) { return part > kHollow; };
  const auto& parts = modes.stabilization;
  const auto first = std::find_if(parts.begin(), parts.end(), is_hollow);
  if (first != parts.end())
    warnings.add(
        "hollow",
        fmt::format("{} modes (the first: number {}) are motions of frames that the material hardly feels, held by "
                    "stabilisation: they are no modes of the body; use more rigid frames, on a grid",
                    std::count_if(parts.begin(), parts.end(), is_hollow), first - parts.begin() + 1));
}

}  // namespace fascia::app
