#pragma once

#include "meshless/cloud_build.hpp"
#include "meshless/scattered/scatter.hpp"

/// Steps of scatter_cloud() and grid_cloud().
namespace fascia {

std::string text(const Vec3d& x);  ///< "(x, y, z)", for messages

/// Pieces fine enough for samples of this spacing: a quarter of it for frames in solids, a third for points there, a
/// sixth in sheets and lines; larger where there would be too many.
Matter matter_for(const MatterParts& parts, double spacing, PieceUse use, ThreadPool& pool);
/// Spacing at which a body without features would have `count` samples [m].
double rough_spacing(const MatterParts& parts, int count);
double size_of(const MatterParts& parts);  ///< diagonal of the bounding box [m]
/// Smallest side of the bounding box, or 4 volume / area where that is less: of a rod its thickness, of a curved plate
/// twice that [m].
double thickness_of(const SolidDomain& solid);
inline Vec3d to_world(const MatterParts& parts, const Vec3d& x) { return parts.rotation * x + parts.translation; }
/// Gauss points of the cells of a thin grid. @param axes  of the matter, before placement
std::vector<CloudPoint> gauss_cells(const ThinGridSpec& choice, const Mat3d& axes);
/// What is carried along, and where a position lies; wants the points.
void finish_cloud(const MatterParts& parts, CloudSpec& spec);

}  // namespace fascia
