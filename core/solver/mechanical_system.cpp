#include "core/solver/mechanical_system.hpp"

#include "core/base/index.hpp"
#include "core/node/node_force.hpp"
#include "core/node/node_load.hpp"
#include "core/solver/boundary_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace fascia {

MechanicalSystem::MechanicalSystem(const Model& model, ThreadPool& pool, const SolverSettings& settings)
    : model_(model),
      settings_(settings),
      filter_(model),
      executor_(model.points, pool),
      tangent_(model, executor_, filter_, settings),
      dependents_(model.points),
      conservative_(model.loads_are_conservative()),
      extrapolates_(extrapolates_stresses(model.points, settings.tangent)),
      surfaces_(model),
      masses_(part_masses(model)),
      driven_(driven_parts(model)),
      state_(State::at_rest(model)) {
  const auto n = at(model.dof_count());
  gradient_.resize(n);
  load_.resize(n);
  inertia_.resize(n);
  direction_.resize(n);
  work_.resize(n);
  dependent_forces_.resize(6 * model.points.dependents.size());
  factors_ = reached_factors_ = zero_factors(model);
}

std::vector<double> zero_factors(const Model& model) {
  int schedules = 0;
  for (const DeadLoad& l : model.loads) schedules = std::max(schedules, l.schedule + 1);
  for (const FollowerLoad& l : model.followers) schedules = std::max(schedules, l.schedule + 1);
  for (const SurfaceLoad& l : model.surfaces) schedules = std::max({schedules, l.schedule + 1, l.weight_schedule + 1});
  for (const PrescribedMotion& m : model.motions) schedules = std::max(schedules, m.schedule + 1);
  return std::vector<double>(at(schedules), 0.0);
}

void MechanicalSystem::add(std::vector<double>& out, int node, const Vec3d& force, const Mat3d& N,
                           const Vec3d& torque) const {
  add_node_force(model_.kind(node), state_.D[at(node)], force, N, torque, out.data() + model_.points.dofs.begin(node));
}

void MechanicalSystem::set_factors(std::span<const double> factors) {
  known_.reset();
  note_stretches();
  factors_.assign(factors.begin(), factors.end());
  place_tethers(model_, factors_, executor_.targets());
}

void MechanicalSystem::rebuild_state() {
  known_.reset();
  state_.u.resize(start_.u.size());
  if (state_.D.size() != start_.D.size()) state_.D = start_.D;
  for (std::size_t i = 0; i < start_.u.size(); ++i) {
    state_.u[i] = start_.u[i] + increment_.du[i];
    state_.D[i] = incremented(model_.frame_kind[i], increment_.Ds[i], start_.D[i]);
  }
  if (!dependents_.empty()) place_dependents_of_step();
}

/// In the present state, and their increments by those of their hosts, which keep the digits of small steps.
void MechanicalSystem::place_dependents_of_step() {
  for (const DependentNode& d : model_.points.dependents) {
    Vec3d du;
    for (std::size_t k = 0; k < d.hosts.size(); ++k) {
      const PoseMotion host = node_motion(at(d.hosts[k]));
      du += host.u * d.w[k] + host.Q * d.b[k];
    }
    increment_.du[at(d.node)] = du;
    if (d.turns) increment_.Ds[at(d.node)] = increment_.Ds[at(d.hosts[0])];
  }
  place_dependents(model_.points, state_);
  dependents_.turn(state_.D);
}

/// Energy of the step where it starts. The strain energy of vertices is what the step before left.
double MechanicalSystem::energy_at_start() {
  const bool same = reached_ && !model_.has_frames() && !model_.points.damped && model_.tethers.empty() &&
                    reached_->first == start_.u;
  if (!same) return evaluate().energy;
  add_loads();
  add_inertia();
  return reached_->second + load_energy_ + inertia_energy_;
}

void MechanicalSystem::start_from_prediction() {
  const double at_old_state = energy_at_start();
  save();
  std::vector<char> held(start_.u.size(), 0);
  for (const FrameConstraint& c : model_.constraints) held[at(c.node)] = 1;
  for (std::size_t i = 0; i < start_.u.size(); ++i) {
    if (held[i] != 0) continue;
    increment_.du[i] = start_.v[i] * form_.reach;
    increment_.Ds[i] = increment_along(model_.frame_kind[i], start_.D[i], start_.Q_dot[i], form_.reach);
  }
  rebuild_state();
  const Evaluation predicted = evaluate();
  if (predicted.energy < at_old_state)
    known_ = predicted;  // Newton asks for it next
  else
    restore();
}

PoseMotion MechanicalSystem::node_motion(std::size_t i) const {
  return motion_of(model_.frame_kind[i], increment_.du[i], increment_.Ds[i], start_.D[i]);
}

StepNode MechanicalSystem::step_node(std::size_t i) const {
  return {model_.frame_kind[i], model_.inertia[i], start_.D[i], {start_.v[i], start_.Q_dot[i]},
          increment_.du[i],     increment_.Ds[i],  form_.q[i],  form_.w[i]};
}

const FrameInertia* MechanicalSystem::damping_of(std::size_t i) const {
  return model_.mass_damping.empty() ? nullptr : &model_.mass_damping[i];
}

/// A point mass asks for less.
StepInertia MechanicalSystem::node_inertia(std::size_t i) const {
  const FrameInertia* damping = damping_of(i);
  if (model_.frame_kind[i] == FrameKind::vertex)
    return step_inertia(form_, model_.inertia[i].mass, damping != nullptr ? damping->mass : 0, increment_.du[i],
                        form_.q[i].u, form_.w[i].u, start_.v[i]);
  return step_inertia(form_, step_node(i), damping, model_.points.part_length[at(model_.points.node_part[i])]);
}

void MechanicalSystem::add_loads() {
  std::fill(load_.begin(), load_.end(), 0.0);
  load_energy_ = 0;
  for (const DeadLoad& load : model_.loads) {
    const double s = factors_[at(load.schedule)];
    for (const NodeLoad& n : load.nodes) {
      const Mat3d& D = state_.D[at(n.node)];
      load_energy_ -= s * dead_load_work(n, state_.u[at(n.node)], D);
      add_dead_load(model_.kind(n.node), n, s, D, load_.data() + model_.points.dofs.begin(n.node));
    }
  }
  for (const FollowerLoad& load : model_.followers)
    for_each_share(load, state_, factors_[at(load.schedule)],
                   [&](int node, const Vec3d& force, const Mat3d& couple, const Vec3d& torque) {
                     add(load_, node, force, couple, torque);
                   });
  load_energy_ += surfaces_.add_forces(state_, factors_, load_);
}

void MechanicalSystem::add_inertia() {
  std::fill(inertia_.begin(), inertia_.end(), 0.0);
  inertia_energy_ = 0;
  inertia_cancelled_.assign(at(model_.points.part_count()), 0.0);
  if (form_.h <= 0) return;
  for (int i = 0; i < model_.node_count(); ++i) {
    const StepInertia f = node_inertia(at(i));
    inertia_energy_ += f.energy;
    inertia_energy_ += f.damping_energy;
    add(inertia_, i, f.force, f.moment, {});
    inertia_cancelled_[at(model_.points.node_part[at(i)])] += f.cancelled_force * f.cancelled_force;
  }
}

/// @param turning  false leaves out how forces on dependent nodes turn their hosts, tethers' pull among them
void MechanicalSystem::add_node_blocks(Linearization& lin, bool turning) const {
  const bool full = lin.tangent == Tangent::full;
  const DofLayout& dofs = model_.points.dofs;
  if (full) {
    for (const DeadLoad& load : model_.loads) {
      const double s = factors_[at(load.schedule)];
      for (const NodeLoad& n : load.nodes) {
        if (!rigid(at(n.node))) continue;
        add_dead_load_block(n, s, lin.Q[at(n.node)], lin.node_blocks.data() + dofs.block_begin(n.node));
        if (squared_norm(n.torque) > 0) lin.torques.push_back({n.node, n.torque * s});
      }
    }
    for (const FollowerLoad& load : model_.followers)
      lin.followers.emplace_back(load, state_, factors_[at(load.schedule)]);
    if (turning) dependents_.add_turning(dependent_forces_, lin.node_blocks);
  }
  surfaces_.linearize(state_, factors_, lin);
  for (RankOne& term : lin.low_rank) dependents_.transfer(term.g);
  if (form_.h <= 0) return;
  for (int i = 0; i < model_.node_count(); ++i)
    add_step_inertia_block(form_, step_node(at(i)), damping_of(at(i)), lin.Q[at(i)], full,
                           lin.node_blocks.data() + dofs.block_begin(i));
}

Evaluation MechanicalSystem::evaluate() {
  if (known_) return *std::exchange(known_, std::nullopt);
  internal_ = executor_.gradient(state_, history_, gradient_);
  evaluate_loads();
  add_inertia();
  for (std::size_t i = 0; i < gradient_.size(); ++i) gradient_[i] += inertia_[i] - load_[i];
  dependents_.transfer(gradient_, dependent_forces_);
  Evaluation e;
  e.energy = internal_.total() + load_energy_ - load_work_ + inertia_energy_;
  sum_squares();
  e.energy_scale = std::abs(internal_.total()) + std::abs(load_energy_) + inertia_energy_;
  judge(part_forces(), model_.points.part_whole, settings_.tolerance, e);
  return e;
}

/// After a step, the work that its loads did and that their potential does not show.
void MechanicalSystem::evaluate_loads() {
  add_loads();
  if (applied_ != 0) load_work_ += 0.5 * applied_ * (start_power_ + load_power()) + load_energy_ - start_potential_;
  applied_ = 0;
}

/// Work of the present loads along the direction, for a step of 1 [J].
double MechanicalSystem::load_power() const {
  return std::inner_product(load_.begin(), load_.end(), direction_.begin(), 0.0);
}

DirectionReport MechanicalSystem::direction() {
  const TakenStep* taken = has_taken_ ? &taken_ : nullptr;
  executor_.linearize(state_, history_, settings_.tangent, lin_, true, taken);
  add_node_blocks(lin_);
  std::vector<double> rhs(gradient_.size()), prescribed;
  for (std::size_t i = 0; i < rhs.size(); ++i) rhs[i] = -gradient_[i];
  filter_.to_local(rhs);
  if (has_prescribed_increment()) prescribed = work_;
  Linearization fallback;
  const TangentReport solved = tangent_.solve(
      lin_, prescribed, rhs, direction_, [&](TamerTangent kind) -> auto& {
        const bool material = kind == TamerTangent::material;
        executor_.linearize(state_, history_, material ? Tangent::material : settings_.tangent, fallback, false);
        add_node_blocks(fallback, false);
        return fallback;
      });
  DirectionReport report;
  report.usable = solved.usable;
  report.linear_iterations = solved.iterations;
  report.trouble = solved.trouble;
  report.indefinite = solved.indefinite;
  report.unsolved = solved.unsolved;
  report.linear_residual = solved.residual;
  report.cg_seconds = solved.seconds;
  filter_.to_global(direction_);
  dependents_.expand(direction_);
  surfaces_.aim(lin_, direction_);
  for (std::size_t i = 0; i < direction_.size(); ++i) report.slope += gradient_[i] * direction_[i];
  report.largest_rotation = std::max(largest_rotation_in(direction_), executor_.largest_spin(direction_));
  if (!conservative_) {
    start_power_ = load_power();
    start_potential_ = load_energy_;
  }
  return report;
}

void MechanicalSystem::linearize_loads() {
  lin_.tangent = settings_.tangent;
  lin_.surfaces.clear();
  lin_.low_rank.clear();
  lin_.followers.clear();
  lin_.torques.clear();
  lin_.node_blocks.assign(model_.points.dofs.block_total(), 0.0);
  lin_.Q.resize(state_.D.size());
  for (std::size_t i = 0; i < lin_.Q.size(); ++i) lin_.Q[i] = Mat3d::identity() + state_.D[i];
  add_node_blocks(lin_);
}

Stability MechanicalSystem::stability(const State& end, long made, bool current) {
  return stability_of(*this, end, State::at_rest(model_), [&](bool at_end) {
    executor_.linearize(state_, history_, Tangent::full, lin_);
    add_node_blocks(lin_);
    return tangent_.softest(lin_, made, current && at_end && settings_.tangent == Tangent::full);
  });
}

TangentCondition MechanicalSystem::condition(double most_flops) {
  executor_.linearize(state_, history_, settings_.tangent, lin_);
  add_node_blocks(lin_);
  return tangent_.condition(lin_, most_flops);
}

const Multigrid* MechanicalSystem::levels(bool material) {
  Linearization tamer;
  Linearization& lin = material ? tamer : lin_;
  const TakenStep* taken = has_taken_ && !material ? &taken_ : nullptr;
  executor_.linearize(state_, history_, material ? Tangent::material : settings_.tangent, lin, !material, taken);
  add_node_blocks(lin, !material);
  return tangent_.levels(lin, material);
}

void MechanicalSystem::add_unsymmetric(std::span<const double> x, std::span<double> y) {
  std::vector<double> all(x.begin(), x.end()), product(x.size());
  filter_.to_global(all);
  dependents_.expand(all);
  add_unsymmetric_product(lin_, model_.points.dofs, all, product);
  dependents_.transfer(product);
  filter_.to_local(product);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] += product[i];
}

std::vector<double> MechanicalSystem::product(std::span<const double> d) {
  executor_.linearize(state_, history_, settings_.tangent, lin_);
  add_node_blocks(lin_);
  std::vector<double> all(d.begin(), d.end()), y(d.size());
  dependents_.expand(all);
  executor_.multiply(lin_, all, y);
  dependents_.transfer(y);
  return y;
}

/// Keeps where a step starts, and along what it goes.
void MechanicalSystem::note_step(double step) {
  has_taken_ = extrapolates_;
  if (!has_taken_) return;
  taken_.u = state_.u;
  taken_.D = state_.D;
  taken_.d = direction_;
  for (double& d : taken_.d) d *= step;
}

void MechanicalSystem::apply(double step) {
  note_step(step);
  if (!conservative_) applied_ = step;
  surfaces_.approach(step);
  for (int i = 0; i < model_.node_count(); ++i) {
    const double* d = direction_.data() + model_.points.dofs.begin(i);
    advance_increment(model_.kind(i), d, step, increment_.du[at(i)], increment_.Ds[at(i)]);
  }
  for (std::size_t k = 0; k < model_.constraints.size(); ++k) {
    const FrameConstraint& c = model_.constraints[k];
    if (!rigid(at(c.node))) continue;
    const double* d = direction_.data() + model_.points.dofs.begin(c.node);
    advance_turned(c, d, step, increment_.turned[k].data());
  }
  rebuild_state();
}

void MechanicalSystem::save() {
  saved_ = increment_;
  saved_work_ = load_work_;
  surfaces_.save();
}

void MechanicalSystem::restore() {
  has_taken_ = false;
  increment_ = saved_;
  load_work_ = saved_work_;
  applied_ = 0;
  surfaces_.restore();
  rebuild_state();
}

}  // namespace fascia
