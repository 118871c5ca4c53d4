#pragma once

#include "meshless/cloud_build.hpp"

/// Frames of other bodies among those of a cloud.
namespace fascia {

/// All frames that the points of a body may follow.
struct CloudFrames {
  std::vector<CloudFrame> frames;  ///< own, then shared
  std::size_t own = 0;
  std::vector<SharedFrame> shared;
  Reach reach;

  std::vector<Vec3d> positions() const;
};

/// Where shared frames are in the axes of the parts.
std::vector<Vec3d> positions_in_parts(const MatterParts& parts, std::span<const SharedFrame> shared);

/// What is left of listed positions where others stand already.
/// @param tolerance  between places that coincide [m]
ListedChoice unoccupied(const ListedChoice& choice, std::span<const Vec3d> occupied, double tolerance,
                        std::vector<std::string>& messages);

/// Adds shared frames to a body's own, with the dimension and normal of the matter nearest to each.
void add_shared(std::span<const SharedFrame> shared, const std::vector<CloudPoint>& points, CloudFrames& set);

/// Widens supports until every frame near the matter reaches a few points, and every point enough frames; so shared
/// frames may be far denser than own ones, or far coarser. Of nodes denser than the points some are left out.
void widen_supports(ScatteredKind kind, const std::vector<CloudPoint>& points, CloudFrames& set, ThreadPool& pool);

/// Leaves out frames that move no point, which would be free. @returns  the weights of the others at the points
std::shared_ptr<const KeptWeights> drop_idle_frames(ScatteredKind kind, const std::vector<CloudPoint>& points,
                                                    CloudFrames& set, std::vector<std::string>& messages,
                                                    ThreadPool& pool);

/// Replaces frames of a thin grid by the shared ones that stand there.
void share_grid_frames(std::span<const SharedFrame> shared, double size, CloudSpec& spec);

}  // namespace fascia
