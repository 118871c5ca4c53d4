#include "core/math/rotation.hpp"
#include "core/node/node_finish.hpp"
#include "core/node/small_factor.hpp"
#include "core/solver/boundary_motion.hpp"
#include "core/solver/mechanical_system.hpp"
#include "core/structure/inertia.hpp"

#include <algorithm>

/// The part of MechanicalSystem in which time schemes differ.
namespace fascia {

void MechanicalSystem::begin_step(const State& start, double dt, TimeScheme scheme, const StepMemory& memory) {
  const std::size_t n = start.u.size();
  start_ = start;
  start_.turned.resize(model_.constraints.size());  // a state made before the constraints has none
  place_dependents(model_.points, start_);
  place_dependent_rates(model_.points, start_);
  increment_.du.assign(n, Vec3d{});
  increment_.Ds = start_.D;
  increment_.Ds.set_zero();
  increment_.turned = start_.turned;
  has_taken_ = false;
  load_work_ = saved_work_ = applied_ = 0;
  surfaces_.begin_step();
  executor_.start_from(start_);
  static_cast<StepConstants&>(form_) = StepConstants::of(scheme, dt, memory.step);
  form_.q.assign(n, {});
  form_.w.assign(n, {});
  history_.inverse_step = 0;
  if (dt > 0) {
    const auto entry = [](const std::vector<PoseMotion>& of, std::size_t i) {
      return i < of.size() ? &of[i] : nullptr;
    };
    for (std::size_t i = 0; i < n; ++i) {
      StepNode node = step_node(i);
      predict(form_, {entry(memory.motion, i), entry(memory.velocity, i), entry(memory.acceleration, i)}, node);
      form_.q[i] = node.q;
      form_.w[i] = node.w;
    }
    if (scheme == TimeScheme::midpoint)
      for (const FrameConstraint& c : model_.constraints) straighten_held(c, form_.q[at(c.node)].u);
    if (model_.points.damped) predict_strain(memory);
  }
  rebuild_state();
}

/// Where the present velocities lead: rotations along arcs, origins of frames in the midpoint rule as their q says.
State MechanicalSystem::moved_by_velocity(double time) const {
  State moved = start_;
  for (std::size_t i = 0; i < moved.u.size(); ++i) {
    const MovedNode node = fascia::moved_by_velocity(form_, step_node(i), time);
    moved.u[i] += node.du;
    moved.D[i] = node.D;
  }
  place_dependents(model_.points, moved);
  return moved;
}

/// Ê of the step. The rate and the second derivative of the strain come from strains along the velocity,
/// h dE/dt = (E(h) − E(−h)) / 2 and h² d²E/dt² = E(h) − 2 E + E(−h).
void MechanicalSystem::predict_strain(const StepMemory& memory) {
  history_.inverse_step = 1 / form_.h;
  executor_.store_strain(start_, history_);
  if (form_.scheme == TimeScheme::implicit_euler) return;
  AlignedVector<double>& E = history_.E;
  start_strain_ = E;
  if (form_.scheme == TimeScheme::bdf2) {
    const double c = form_.memory_factor();
    for (std::size_t k = 0; k < E.size(); ++k) E[k] += c * (E[k] - memory.E[k]);
    return;
  }
  StrainHistory ahead, behind;
  executor_.store_strain(moved_by_velocity(form_.h), ahead);
  executor_.store_strain(moved_by_velocity(-form_.h), behind);
  const bool rate = form_.scheme == TimeScheme::newmark;
  for (std::size_t k = 0; k < E.size(); ++k)
    E[k] += rate ? 0.5 * (ahead.E[k] - behind.E[k]) : -0.5 * (ahead.E[k] - 2 * E[k] + behind.E[k]);
}

State MechanicalSystem::finish_step(double end_time, StepMemory& memory) {
  reached_factors_ = factors_;
  surfaces_.finish_step();
  reached_.reset();
  if (form_.scheme == TimeScheme::implicit_euler && !model_.has_frames()) reached_ = {state_.u, internal_.total()};
  const std::size_t n = start_.u.size();
  State end = state_;
  end.turned = increment_.turned;
  end.time = end_time;
  end.v.assign(n, Vec3d{});
  end.Q_dot = end.D;
  end.Q_dot.set_zero();
  const bool same_step = memory.step == form_.step && memory.motion.size() == n;
  const std::vector<PoseMotion> before = same_step ? std::move(memory.motion) : std::vector<PoseMotion>{};
  memory.motion.resize(n);
  for (std::size_t i = 0; i < n; ++i) memory.motion[i] = node_motion(i);
  if (form_.scheme == TimeScheme::midpoint) finish_middle(end, memory.motion);
  if (form_.scheme == TimeScheme::newmark) memory.acceleration.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (rigid(i)) end.D[i] = orthonormalized_increment(end.D[i]);
    if (form_.h <= 0 || form_.scheme == TimeScheme::midpoint) continue;
    const EndRates rates = rates_at_end(form_, step_node(i), end.D[i]);
    end.v[i] = rates.v.u;
    end.Q_dot[i] = rates.v.Q;
    if (form_.scheme == TimeScheme::newmark) memory.acceleration[i] = rates.a;
  }
  const bool remembers = form_.h > 0 && form_.scheme != TimeScheme::implicit_euler;
  if (remembers && form_.scheme != TimeScheme::bdf2) follow_boundaries(end, before, memory);
  place_dependents(model_.points, end);
  place_dependent_rates(model_.points, end);
  if (!remembers) return end;
  memory.step = form_.step;
  memory.velocity.resize(n);
  for (std::size_t i = 0; i < n; ++i) memory.velocity[i] = {start_.v[i], start_.Q_dot[i]};
  if (history_.inverse_step > 0) memory.E = start_strain_;
  return end;
}

/// @param before  motion in the step before, of the same length; or empty
void MechanicalSystem::follow_boundaries(State& end, const std::vector<PoseMotion>& before, StepMemory& memory) const {
  const bool accelerates = form_.scheme == TimeScheme::newmark;
  for (const FrameConstraint& c : model_.constraints) {
    const std::size_t i = at(c.node);
    const PoseMotion& x = memory.motion[i];
    EndRates rates{{end.v[i], end.Q_dot[i]}, accelerates ? memory.acceleration[i] : PoseMotion{}};
    follow_boundary(form_, model_.kind(c.node), c, x, before.empty() ? x.u : before[i].u, end.D[i], rates);
    end.v[i] = rates.v.u;
    end.Q_dot[i] = rates.v.Q;
    if (accelerates) memory.acceleration[i] = rates.a;
  }
}

/// From the middle of the step to its end. @param motion  of the nodes to the middle, then to the end
void MechanicalSystem::finish_middle(State& end, std::vector<PoseMotion>& motion) const {
  std::vector<const FrameConstraint*> constraint(start_.u.size(), nullptr);
  for (const FrameConstraint& c : model_.constraints) constraint[at(c.node)] = &c;
  for (std::size_t i = 0; i < start_.u.size(); ++i) {
    const MiddleEnd finished = fascia::finish_middle(form_, step_node(i), constraint[i], state_.D[i]);
    motion[i] = finished.motion;
    end.v[i] = finished.v.u;
    end.Q_dot[i] = finished.v.Q;
    end.u[i] = start_.u[i] + motion[i].u;
    end.D[i] = start_.D[i] + motion[i].Q;
  }
  for (std::size_t k = 0; k < end.turned.size(); ++k)
    for (std::size_t a = 0; a < 3; ++a) end.turned[k][a] += end.turned[k][a] - start_.turned[k][a];
  if (model_.constraints.empty()) return;
  prescribed_increments(model_, filter_, end, end.turned, factors_, work_);
  filter_.to_global(work_);
  move_state(model_, work_, end);
  for (const FrameConstraint& c : model_.constraints) {
    const std::size_t i = at(c.node);
    motion[i] = {end.u[i] - start_.u[i], end.D[i] - start_.D[i]};
  }
}

void MechanicalSystem::start_acceleration(const State& start, double dt, StepMemory& memory) {
  memory.acceleration.assign(start.u.size(), {});
  begin_step(start, dt, TimeScheme::newmark, memory);
  // Nothing has moved yet: (E − Ê) / h is dE/dt with the Ê of a step that comes from where velocities lead back to.
  if (model_.points.damped)
    for (std::size_t k = 0; k < history_.E.size(); ++k) history_.E[k] = 2 * start_strain_[k] - history_.E[k];
  executor_.gradient(state_, history_, gradient_);
  add_loads();
  std::vector<double>& force = work_;
  for (std::size_t k = 0; k < force.size(); ++k) force[k] = load_[k] - gradient_[k];
  for (int i = 0; i < model_.node_count(); ++i) {
    const InertiaForce f = inertia_of_velocity(model_.kind(i), model_.inertia[at(i)], damping_of(at(i)),
                                               state_.D[at(i)], {start.v[at(i)], start.Q_dot[at(i)]});
    add(force, i, -f.force, f.moment * -1.0, {});
  }
  dependents_.transfer(force);
  filter_.to_local(force);
  filter_.clear_fixed(force);
  const DofLayout& dofs = model_.points.dofs;
  for (int i = 0; i < model_.node_count(); ++i) {
    const Mat3d Q = Mat3d::identity() + state_.D[at(i)];
    double* a = force.data() + dofs.begin(i);
    SmallFactor factor;
    if (!factor.factorize(free_mass_block(model_, filter_, i, Q).data(), dofs.size(i)))
      std::fill_n(a, dofs.size(i), 0.0);
    else
      factor.solve(a);
  }
  filter_.to_global(force);
  for (int i = 0; i < model_.node_count(); ++i) {
    memory.acceleration[at(i)] =
        acceleration_of(model_.kind(i), force.data() + dofs.begin(i), state_.D[at(i)], start.Q_dot[at(i)]);
  }
}

}  // namespace fascia
