#pragma once

#include "core/base/portability.hpp"

namespace fascia {

/// How strain makes stress, by one name in scenes, bodies, points, elements and results. Laws of solids
/// (solid_law.hpp) first; the co-rotational law of elements; plane stress and that of a rod, of points in thin bodies;
/// and of points that are no matter but springs to places in space.
enum class Law : unsigned char {
  st_venant_kirchhoff,
  neo_hookean,
  mooney_rivlin,
  linear,
  corotational,
  sheet,
  line,
  tether
};

/// Sheets, lines and tethers are thin: their points have axes.
FASCIA_HD constexpr bool is_thin(Law law) { return law == Law::sheet || law == Law::line || law == Law::tether; }

/// Solids under large strain have a law of each point alone.
FASCIA_HD constexpr bool is_of_points(Law law) {
  return !is_thin(law) && law != Law::linear && law != Law::corotational;
}

}  // namespace fascia
