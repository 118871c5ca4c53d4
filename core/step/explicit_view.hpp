#pragma once

#include "core/node/node_drift.hpp"
#include "core/step/model_view.hpp"

/// Central differences at the nodes of a model, as loops see them.
namespace fascia {

/// Nodes between two steps. Arrays of what turns are there where the model has frames.
struct ExplicitView {
  ModelView m;           ///< with the factors of the state
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
  /// By degrees of freedom, with what dependent nodes hand on. Where there is no load, only dead loads act.
  double *load = nullptr, *gradient = nullptr;
  Vec3d *u = nullptr, *v = nullptr;
  Mat3d *D = nullptr, *Q_dot = nullptr;
  double* turned = nullptr;                       ///< (constraints × 3)
  Vec3d *half_v = nullptr, *half_spin = nullptr;  ///< HalfStepVelocity
  Mat3d* half_rate = nullptr;

  FASCIA_HD bool skips(int i) const { return follows != nullptr && follows[i] != 0; }
  FASCIA_HD bool is_vertex(int i) const { return m.nodes.kind[i] == FrameKind::vertex; }
  FASCIA_HD Vec3d vertex_load(int i) const {
    return load == nullptr ? m.vertex_load(i) : vector_at(load + m.nodes.dof[i]);
  }
  FASCIA_HD Vec3d vertex_gradient(int i) const { return vector_at(gradient + m.nodes.dof[i]); }

  /// @tparam Frames  the node may be a frame, here and below
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
    n.turn = m.turn_of(i);
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
  /// The velocity half a step later.
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

  /// Finds what loads do on a node, and all that acts on it.
  /// @param w  its velocity
  /// @param g  its entries of the gradient
  FASCIA_HD void act(const ExplicitNode& n, int i, const HalfStepVelocity& w, const double* g, double* acting_load,
                     double* force) const {
    const int count = dof_count(n.kind), first = m.nodes.dof[i];
    for (int k = 0; k < count; ++k) acting_load[k] = load == nullptr ? 0 : load[first + k];
    if (load == nullptr) m.add_dead_loads(n.kind, i, n.D, acting_load);
    for (int k = 0; k < count; ++k) force[k] = acting_load[k] - g[k];
    if (uneven != nullptr && n.kind != FrameKind::vertex) add_uneven_damping(n, uneven[i], w, force);
  }
  FASCIA_HD void forces(const ExplicitNode& n, int i, const HalfStepVelocity& w, double* acting_load,
                        double* force) const {
    act(n, i, w, gradient + m.nodes.dof[i], acting_load, force);
  }

 private:
  FASCIA_HD static Vec3d vector_at(const double* v) { return {{v[0], v[1], v[2]}}; }
};

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

}  // namespace fascia
