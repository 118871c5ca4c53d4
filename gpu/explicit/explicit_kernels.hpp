#pragma once

#include "core/node/node_drift.hpp"
#include "core/node/node_load.hpp"
#include "core/solver/boundary_motion.hpp"
#include "gpu/blocks/blocks.hpp"
#include "gpu/space/space.hpp"
#include "gpu/system/boundary_kernels.hpp"
#include "gpu/system/model_data.hpp"

/// Loops of a step of central differences. Each is the counterpart of a member function of ExplicitStepper, and calls
/// the same formulas of one node. Frames: the model has nodes that turn.
namespace fascia::gpu::kernels {

/// How far a run has come, and its energies; in the space.
struct ExplicitProgress {
  int unsound = 0;  ///< the first step with more kinetic energy than was given; 0: none
  int row = 0;      ///< of the table of factors, of the next step
  int step = 0;
  double kinetic = 0, work = 0, largest_work = 0;  ///< [J]
  double given = 0;                                ///< at the start, with what rounding may show [J]
  double motion = 0;                               ///< Σ v² + Q̇², where it was asked for

  FASCIA_HD void end_step() {
    if (largest_work < work) largest_work = work;
    ++row;
    ++step;
    if (unsound == 0 && !is_sound_energy(kinetic, given + largest_work)) unsound = step;
  }
};

/// Nodes between two steps. Arrays of what turns are there where the model has frames.
struct ExplicitView {
  ModelView m;  ///< with the factors of the state
  BlocksView blocks;
  double last_step = 0;  ///< the one that ended at the state [s]
  LeapTimes times;       ///< about the state
  const double* damping = nullptr;
  const SpinInertia* turning = nullptr;
  const Vec3d* center = nullptr;
  const int* affine = nullptr;
  const double* inverse_mass = nullptr;
  const FrameInertia* uneven = nullptr;  ///< as in ExplicitNodes, as all of these; none where it is empty
  const char* follows = nullptr;
  double *increments = nullptr, *last_increments = nullptr;
  /// By degrees of freedom, with what dependent nodes hand on. Where there is no load, only dead loads act; where there
  /// is no gradient, blocks have it.
  double *load = nullptr, *gradient = nullptr;
  Vec3d *u = nullptr, *v = nullptr;
  Mat3d *D = nullptr, *Q_dot = nullptr;
  double* turned = nullptr;                       ///< (constraints × 3)
  Vec3d *half_v = nullptr, *half_spin = nullptr;  ///< HalfStepVelocity
  Mat3d* half_rate = nullptr;

  FASCIA_HD bool skips(int i) const { return follows != nullptr && follows[i] != 0; }

  template <bool Frames>
  FASCIA_HD ExplicitNode node(int i) const {
    ExplicitNode n;
    n.damping = 0.5 * times.kick * damping[i];
    n.inertia = m.inertia + i;
    if constexpr (Frames) {
      n.kind = m.nodes.kind[i];
      n.turning = turning + i;
      n.center = center[i];
      n.D = D[i];
      if (inverse_mass != nullptr) n.inverse_mass = inverse_mass + 16 * affine[i];
    }
    n.held = m.held(i);
    if (n.held == nullptr) return n;
    n.turn = m.turn[i] < 0 ? nullptr : m.turns + m.turn[i];
    n.fixed = m.fixed[i];
    n.increments = increments + m.nodes.dof[i];
    return n;
  }
  template <bool Frames>
  FASCIA_HD HalfStepVelocity velocity(int i) const {
    if constexpr (Frames) return {half_v[i], half_spin[i], half_rate[i]};
    return {half_v[i], {}, {}};
  }
  template <bool Frames>
  FASCIA_HD void set_velocity(int i, const HalfStepVelocity& w) const {
    half_v[i] = w.v;
    if constexpr (Frames) {
      half_spin[i] = w.spin;
      half_rate[i] = w.rate;
    }
  }
  /// The velocity half a step later, of what a model's nodes may be.
  template <bool Frames>
  FASCIA_HD HalfStepVelocity kick(const ExplicitNode& n, const HalfStepVelocity& old, const double* f) const {
    if constexpr (Frames) return kicked(n, old, f, times);
    if (n.held != nullptr) return kicked_held_vertex(n, old, f, times);
    return {kicked_vertex(n.damping, n.inertia->mass, old.v, Vec3d{{f[0], f[1], f[2]}}, times.kick), {}, {}};
  }
  template <bool Frames>
  FASCIA_HD PoseMotion given_velocity(int i) const {
    if constexpr (Frames) return {v[i], Q_dot[i]};
    return {v[i], {}};
  }

  FASCIA_HD void add_dead_loads(FrameKind kind, int i, const Mat3d& at, double* out) const {
    for (int k = m.load_begin[i]; k < m.load_begin[i + 1]; ++k)
      add_dead_load(kind, m.loads[k].load, m.factors[m.loads[k].schedule], at, out);
  }
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
  /// What loads do on a node, and all that acts on it. @param w  its velocity
  FASCIA_HD void forces(const ExplicitNode& n, int i, const HalfStepVelocity& w, double* acting_load,
                        double* force) const {
    const int count = dof_count(n.kind), first = m.nodes.dof[i];
    for (int k = 0; k < count; ++k) acting_load[k] = load == nullptr ? 0 : load[first + k];
    if (load == nullptr) add_dead_loads(n.kind, i, n.D, acting_load);
    double g[kMostDofs] = {};
    if (gradient == nullptr) gather(n.kind, i, n.D, g);
    for (int k = 0; k < count; ++k) force[k] = acting_load[k] - (gradient == nullptr ? g[k] : gradient[first + k]);
    if (uneven != nullptr && n.kind != FrameKind::vertex) add_uneven_damping(n, uneven[i], w, force);
  }
};

/// Where followers, surfaces or dependent nodes add to them: dead loads; and the gradient, where it is kept.
template <bool Frames>
struct GatherLoads {
  ExplicitView s;
  FASCIA_HD void operator()(int i) const {
    const FrameKind kind = Frames ? s.m.nodes.kind[i] : FrameKind::vertex;
    const Mat3d D = Frames ? s.D[i] : Mat3d{};
    const int first = s.m.nodes.dof[i], n = dof_count(kind);
    for (int k = 0; k < n; ++k) s.load[first + k] = 0;
    s.add_dead_loads(kind, i, D, s.load + first);
    if (s.gradient == nullptr) return;
    for (int k = 0; k < n; ++k) s.gradient[first + k] = 0;
    s.gather(kind, i, D, s.gradient + first);
  }
};

/// What the prescribed degrees of freedom still lack, in constraint axes.
struct ExplicitPrescribed {
  ExplicitView s;
  const double* factors;  ///< where the boundary goes
  double* local;
  FASCIA_HD void operator()(int k) const {
    const ModelView& m = s.m;
    const FrameConstraint& c = m.constraints[k];
    prescribed_increment(m.nodes.kind[c.node], c, m.fixed[c.node], m.motions, factors, m.rest_position[c.node],
                         s.u[c.node], s.D == nullptr ? Mat3d{} : s.D[c.node], s.turned + 3 * k,
                         local + m.nodes.dof[c.node]);
  }
};

/// A kick and a drift. Sums: kinetic energy and work.
template <bool Frames>
struct KickAndDrift {
  ExplicitView s;
  FASCIA_HD void operator()(int i, Sums<2>& sums) const {
    if (s.skips(i)) return;
    const ExplicitNode node = s.node<Frames>(i);
    double load[kMostDofs], force[kMostDofs];
    const HalfStepVelocity old = s.velocity<Frames>(i);
    s.forces(node, i, old, load, force);
    const HalfStepVelocity next = s.kick<Frames>(node, old, force);
    s.set_velocity<Frames>(i, next);
    double* turned = node.held == nullptr ? nullptr : s.turned + 3 * s.m.constraint[i];
    Mat3d D = node.D;
    ExplicitSums own;
    drift(node, next, s.times.drift, load, s.u[i], D, turned, own);
    if (Frames && node.kind != FrameKind::vertex) s.D[i] = D;
    if (node.held != nullptr) add_boundary_work(node, force, s.last_increments + s.m.nodes.dof[i], own);
    sums.v[0] += own.kinetic;
    sums.v[1] += own.work;
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
  /// As CpuExecutor::tether_force().
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
template <bool Frames>
struct StartVelocity {
  ExplicitView s;
  FASCIA_HD void operator()(int i, Sums<1>& sums) const {
    const PoseMotion given = s.given_velocity<Frames>(i);
    sums.v[0] += 0.5 * inertia_product(s.m.inertia[i], given.u, given.Q);
    if (s.skips(i)) return s.set_velocity<Frames>(i, {});
    const ExplicitNode node = s.node<Frames>(i);
    const HalfStepVelocity now = velocity_of(node, given);
    double load[kMostDofs], force[kMostDofs];
    s.forces(node, i, now, load, force);
    s.set_velocity<Frames>(i, kicked_back(node, now, force, s.last_step));
  }
};

/// Velocities at a whole step, and accelerations of what is held.
template <bool Frames>
struct ReportVelocity {
  ExplicitView s;
  PoseMotion* held_acceleration;  ///< (constraints)
  FASCIA_HD void operator()(int i) const {
    if (s.skips(i)) return;
    const ExplicitNode node = s.node<Frames>(i);
    const HalfStepVelocity old = s.velocity<Frames>(i);
    double load[kMostDofs], force[kMostDofs];
    s.forces(node, i, old, load, force);
    const HalfStepVelocity next = s.kick<Frames>(node, old, force);
    const double later = s.times.share_of_later();
    const PoseMotion v = pose_velocity(node, old * (1 - later) + next * later);
    if (node.held != nullptr)
      held_acceleration[s.m.constraint[i]] =
          (pose_velocity(node, next) - pose_velocity(node, old)) * (1 / s.times.kick);
    s.v[i] = v.u;
    if constexpr (Frames) s.Q_dot[i] = v.Q;
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

}  // namespace fascia::gpu::kernels
