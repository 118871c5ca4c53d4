#pragma once

#include "core/node/prescribed.hpp"
#include "gpu/blocks/points.hpp"

/// Loops over tethers.
namespace fascia::gpu::kernels {

/// From the place that a tether holds to its target, as CpuExecutor::tether_stretch().
FASCIA_HD inline Vec3d tether_stretch(const PointsView& points, const PoseView& pose, const Tether& t,
                                      const double* targets) {
  Vec3d stretch;
  for (int k = 0; k < 3; ++k) stretch[k] = targets[at(points.rule[t.group].axes * 3 + k) * kGroupSize + at(t.lane)];
  for (int slot = points.slot_begin[t.group]; slot < points.slot_begin[t.group + 1]; ++slot) {
    const double* shape = points.shape + at(slot) * 13 * kGroupSize + t.lane;
    const Vec3d lever{{shape[4 * kGroupSize], shape[7 * kGroupSize], shape[10 * kGroupSize]}};
    stretch -= pose.u[points.slot_node[slot]] * shape[kGroupSize] + pose.D_of(points.slot_node[slot]) * lever;
  }
  return stretch;
}

/// That of all.
struct NoteStretches {
  const Tether* tethers;
  PointsView points;
  PoseView pose;
  const double* targets;
  Vec3d* stretch;
  FASCIA_HD void operator()(int i) const { stretch[i] = tether_stretch(points, pose, tethers[i], targets); }
};

/// Moves targets so that tethers are stretched as a sum of what they were in the middles of steps.
struct StretchTethers {
  const Tether* tethers;
  PointsView points;
  PoseView pose;
  const Vec3d* stretch[3];
  double weight[3];
  double* targets;
  FASCIA_HD void operator()(int i) const {
    const Tether& t = tethers[i];
    Vec3d more = tether_stretch(points, pose, t, targets) * -1.0;
    for (int k = 0; k < 3; ++k)
      if (weight[k] != 0) more += stretch[k][i] * weight[k];
    move_target(t, points.rule[t.group].axes, more, targets);
  }
};

}  // namespace fascia::gpu::kernels
