#pragma once

#include "core/structure/point_set.hpp"

#include <vector>

namespace fascia {

/// Neighbours whose stiffness differs by more are judged apart: an error that is tiny beside the forces in the stiff
/// one may be all of the load on the soft one.
inline constexpr double kContrast = 1e3;

/// Fills node_part, part_length and part_whole. Nodes that share a group, an element, a shell's triangle, a host or a
/// joint hang together in a whole; a part is what of a whole hangs together without a jump in stiffness above
/// kContrast. Both are numbered in the order of their first nodes. A node is as stiff as the stiffest material that
/// moves it.
///
/// @param group_length  spacing of the frames of each group [m]
void find_parts(PointSet& set, const std::vector<double>& group_length, const std::vector<Joint>& joints);

}  // namespace fascia
