#pragma once

#include "core/step/explicit_loops.hpp"
#include "gpu/blocks/blocks.hpp"
#include "gpu/system/tether_kernels.hpp"

/// Loops of a step of central differences that see blocks or tethers.
namespace fascia::gpu::kernels {

/// Nodes between two steps, with the blocks about them. Where there is no gradient, blocks have it.
struct ExplicitBlocksView : ExplicitView {
  BlocksView blocks;

  /// The gradient of the internal energy, from what blocks left. @param g  zero before
  FASCIA_HD void gather(FrameKind kind, int i, const Mat3d& at, double* g) const {
    NodeSums sums;
    blocks.add_sums(i, sums);
    if (blocks.has_springs) blocks.springs.add_sums(i, sums);
    for (int k = 0; k < 3; ++k) g[k] = sums.force[k];
    if (kind == FrameKind::vertex) return;
    add_moment(kind, sums.N, Mat3d::identity() + at, g + 3);
    if (kind == FrameKind::rigid)
      for (int k = 0; k < 3; ++k) g[3 + k] += sums.torque[k];
  }
  FASCIA_HD Vec3d vertex_gradient(int i) const {
    if (gradient != nullptr) return ExplicitView::vertex_gradient(i);
    NodeSums sums;
    blocks.add_sums(i, sums);
    if (blocks.has_springs) blocks.springs.add_sums(i, sums);
    return sums.force;
  }
  FASCIA_HD void forces(const ExplicitNode& n, int i, const HalfStepVelocity& w, double* acting_load,
                        double* force) const {
    if (gradient != nullptr) return ExplicitView::forces(n, i, w, acting_load, force);
    double g[kMostDofs] = {};
    gather(n.kind, i, n.D, g);
    act(n, i, w, g, acting_load, force);
  }
};

/// Where followers, surfaces or dependent nodes add to them: dead loads; and the gradient, where it is kept.
template <bool Frames>
struct GatherLoads {
  ExplicitBlocksView s;
  FASCIA_HD void operator()(int i) const {
    loops::StoreDeadLoads{s.m, {s.u, s.D}, s.load}(i);
    if (s.gradient == nullptr) return;
    const FrameKind kind = Frames ? s.m.nodes.kind[i] : FrameKind::vertex;
    double* g = s.gradient + s.m.nodes.dof[i];
    for (int k = 0; k < dof_count(kind); ++k) g[k] = 0;
    s.gather(kind, i, Frames ? s.D[i] : Mat3d{}, g);
  }
};

/// Moves what tethers pull to; the work that this takes.
struct MoveTethers {
  const Tether* tethers;
  const PrescribedMotion* motions;
  const double* factors;
  PointsView points;
  PoseView pose;
  double* targets;

  FASCIA_HD void operator()(int i, Sums<1>& sums) const {
    const Tether& t = tethers[i];
    const Vec3d before = force(t), old = target(t), next = tether_target(t, motions, factors);
    for (int k = 0; k < 3; ++k) targets[entry(t, k)] = next[k];
    sums.v[0] += dot((before + force(t)) * 0.5, next - old);
  }

 private:
  FASCIA_HD std::size_t entry(const Tether& t, int k) const {
    return at(points.rule[t.group].axes * 3 + k) * kGroupSize + at(t.lane);
  }
  FASCIA_HD Vec3d target(const Tether& t) const {
    return {{targets[entry(t, 0)], targets[entry(t, 1)], targets[entry(t, 2)]}};
  }
  /// Force with which a tether pulls, as PointExecutor::tether_force().
  FASCIA_HD Vec3d force(const Tether& t) const {
    const double* axes = points.axes + at(points.rule[t.group].axes) * 9 * kGroupSize + t.lane;
    const Vec3d apart = tether_stretch(points, pose, t, targets);
    Vec3d pull;
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j) pull[k] += axes[(3 * k + j) * kGroupSize] * apart[j];
    return pull * points.material[(at(t.group) * 6 + kVolume) * kGroupSize + at(t.lane)];
  }
};

struct EndTethers {
  ExplicitProgress* progress;
  FASCIA_HD void operator()(const Sums<1>& total) const {
    progress->work += total.v[0];
    progress->end_step();
  }
};

}  // namespace fascia::gpu::kernels
