#pragma once

#include "core/space/space.hpp"
#include "core/step/explicit_view.hpp"

/// Loops over nodes of a step of central differences. A View is an ExplicitView, or one with forces() and
/// vertex_gradient() of its own.
/// Frames: the model has nodes that turn.
namespace fascia::loops {

/// Dead loads by degrees of freedom, where others join them.
struct StoreDeadLoads {
  ModelView m;
  PoseView pose;
  double* load;
  FASCIA_HD void operator()(int i) const {
    double* own = load + m.nodes.dof[i];
    for (int k = 0; k < m.nodes.size(i); ++k) own[k] = 0;
    m.add_dead_loads(m.nodes.kind[i], i, pose.D_of(i), own);
  }
};

/// A kick and a drift; free vertices beside frames go as those of other models. Sums: kinetic energy and work.
template <class View, bool Frames>
struct KickAndDrift {
  View s;
  FASCIA_HD void operator()(int i, Sums<2>& sums) const {
    if (s.skips(i)) return;
    ExplicitSums own;
    if ((!Frames || s.is_vertex(i)) && s.m.constraint[i] < 0)
      step_free_vertex(i, own);
    else
      step(i, own);
    sums.v[0] += own.kinetic;
    sums.v[1] += own.work;
  }

 private:
  FASCIA_HD void step_free_vertex(int i, ExplicitSums& own) const {
    const Vec3d load = s.vertex_load(i);
    fascia::step_free_vertex(0.5 * s.times.kick * s.damping[i], s.m.inertia[i].mass, load, load - s.vertex_gradient(i),
                             s.times, s.u[i], s.half_v[i], own);
  }
  FASCIA_HD void step(int i, ExplicitSums& own) const {
    const ExplicitNode node = s.template node<Frames>(i);
    double load[kMostDofs], force[kMostDofs];
    const HalfStepVelocity old = s.template velocity<Frames>(i);
    s.forces(node, i, old, load, force);
    const HalfStepVelocity next = s.template kick<Frames>(node, old, force);
    s.template set_velocity<Frames>(i, next);
    double* turned = node.held == nullptr ? nullptr : s.turned + 3 * s.m.constraint[i];
    Mat3d D = node.D;
    drift(node, next, s.times.drift, load, s.u[i], D, turned, own);
    if (Frames && node.kind != FrameKind::vertex) s.D[i] = D;
    if (node.held != nullptr) add_boundary_work(node, force, s.last_increments + s.m.nodes.dof[i], own);
  }
};

/// A step back at the given velocities.
struct StepBack {
  ExplicitView s;
  Vec3d* u;
  Mat3d* D;
  FASCIA_HD void operator()(int i) const {
    u[i] = s.u[i] - s.v[i] * s.last_step;
    if (s.D != nullptr) D[i] = s.D[i] - s.Q_dot[i] * s.last_step;
  }
};

/// Half a step back from the given velocities. Sum: their kinetic energy.
template <class View, bool Frames>
struct StartVelocity {
  View s;
  FASCIA_HD void operator()(int i, Sums<1>& sums) const {
    const PoseMotion given = s.template given_velocity<Frames>(i);
    sums.v[0] += 0.5 * inertia_product(s.m.inertia[i], given.u, given.Q);
    if (s.skips(i)) return s.template set_velocity<Frames>(i, {});
    const ExplicitNode node = s.template node<Frames>(i);
    const HalfStepVelocity now = velocity_of(node, given);
    double load[kMostDofs], force[kMostDofs];
    s.forces(node, i, now, load, force);
    s.template set_velocity<Frames>(i, kicked_back(node, now, force, s.last_step));
  }
};

/// Velocities at a whole step, and accelerations of what is held.
template <class View, bool Frames>
struct ReportVelocity {
  View s;
  PoseMotion* held_acceleration;  ///< (constraints)
  FASCIA_HD void operator()(int i) const {
    if (s.skips(i)) return;
    const ExplicitNode node = s.template node<Frames>(i);
    const HalfStepVelocity old = s.template velocity<Frames>(i);
    double load[kMostDofs], force[kMostDofs];
    s.forces(node, i, old, load, force);
    const HalfStepVelocity next = s.template kick<Frames>(node, old, force);
    const double later = s.times.share_of_later();
    const PoseMotion v = pose_velocity(node, old * (1 - later) + next * later);
    if (node.held != nullptr)
      held_acceleration[s.m.constraint[i]] =
          (pose_velocity(node, next) - pose_velocity(node, old)) * (1 / s.times.kick);
    s.v[i] = v.u;
    if constexpr (Frames) s.Q_dot[i] = v.Q;
  }
};

/// Gathers what acts on the nodes, with the sign of a gradient.
template <class View, bool Frames>
struct GatherActing {
  View s;  ///< where blocks and loads were evaluated
  double* out;
  FASCIA_HD void operator()(int i) const {
    const ExplicitNode node = s.template node<Frames>(i);
    double load[kMostDofs], force[kMostDofs];
    s.forces(node, i, {}, load, force);
    for (int k = 0; k < dof_count(node.kind); ++k) out[s.m.nodes.dof[i] + k] = -force[k];
  }
};

/// @param last  tethers have no work to add
struct EndNodes {
  ExplicitProgress* progress;
  bool last;
  FASCIA_HD void operator()(const Sums<2>& total) const {
    progress->kinetic = total.v[0];
    progress->work += total.v[1];
    if (last) progress->end_step();
  }
};

/// The factors of the next step.
struct TakeFactors {
  const ExplicitProgress* progress;
  const double* table;  ///< (steps × schedules)
  int schedules;
  double *present, *next;
  FASCIA_HD void operator()(int i) const {
    present[i] = next[i];
    next[i] = table[progress->row * schedules + i];
  }
};

/// Σ v² + Q̇²: finite where all of them are.
struct SizeOfMotion {
  ExplicitView s;
  FASCIA_HD void operator()(int i, Sums<1>& sums) const {
    sums.v[0] += squared_norm(s.v[i]);
    if (s.Q_dot != nullptr) sums.v[0] += contract(s.Q_dot[i], s.Q_dot[i]);
  }
};

}  // namespace fascia::loops
