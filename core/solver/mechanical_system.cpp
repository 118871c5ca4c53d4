#include "core/solver/mechanical_system.hpp"

#include "core/math/index.hpp"
#include "core/math/rotation.hpp"
#include "core/physics/inertia.hpp"
#include "core/solver/boundary_motion.hpp"
#include "core/solver/node_force.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
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
      surfaces_(model),
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
  factors_.assign(factors.begin(), factors.end());
  place_tethers(model_, factors_, executor_.targets());
}

void MechanicalSystem::rebuild_state() {
  known_.reset();
  state_.u.resize(start_.u.size());
  if (state_.D.size() != start_.D.size()) state_.D = start_.D;
  for (std::size_t i = 0; i < start_.u.size(); ++i) {
    state_.u[i] = start_.u[i] + increment_.du[i];
    state_.D[i] = rigid(i) ? compose_increments(increment_.Ds[i], start_.D[i]) : increment_.Ds[i] + start_.D[i];
  }
  if (!dependents_.empty()) place_dependents_of_step();
}

/// In the present state, and their increments by those of their hosts, which keep the digits of small steps.
void MechanicalSystem::place_dependents_of_step() {
  for (const DependentNode& d : model_.points.dependents) {
    Vec3d du;
    for (std::size_t k = 0; k < d.hosts.size(); ++k) {
      const PoseMotion host = motion_of(at(d.hosts[k]));
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
    const Vec3d spin = spin_of(start_.Q_dot[i], Mat3d::identity() + start_.D[i]);
    increment_.du[i] = start_.v[i] * form_.reach;
    increment_.Ds[i] = rigid(i) ? rotation_increment(spin * form_.reach) : start_.Q_dot[i] * form_.reach;
  }
  rebuild_state();
  const Evaluation predicted = evaluate();
  if (predicted.energy < at_old_state)
    known_ = predicted;  // Newton asks for it next
  else
    restore();
}

PoseMotion MechanicalSystem::motion_of(std::size_t i) const {
  const Mat3d& Ds = increment_.Ds[i];
  return {increment_.du[i], rigid(i) ? Ds + Ds * start_.D[i] : Ds};
}

void MechanicalSystem::add_loads() {
  std::fill(load_.begin(), load_.end(), 0.0);
  load_energy_ = 0;
  for (const DeadLoad& load : model_.loads) {
    const double s = factors_[at(load.schedule)];
    for (const NodeLoad& n : load.nodes) {
      const Mat3d& D = state_.D[at(n.node)];
      load_energy_ -= s * (dot(n.force, state_.u[at(n.node)]) + contract(n.couple, D));
      add(load_, n.node, n.force * s, n.couple * s, n.torque * s);
    }
  }
  for (const FollowerLoad& load : model_.followers)
    for_each_share(load, state_, factors_[at(load.schedule)],
                   [&](int node, const Vec3d& force, const Mat3d& couple, const Vec3d& torque) {
                     add(load_, node, force, couple, torque);
                   });
  load_energy_ += surfaces_.add_forces(state_, factors_, load_);
}

/// |x − q − h w|² / (2 h²) + α |x − q|² / (2 h), in the pose form of inertia.hpp.
void MechanicalSystem::add_inertia() {
  std::fill(inertia_.begin(), inertia_.end(), 0.0);
  inertia_energy_ = 0;
  inertia_rounding_.assign(at(model_.points.part_count()), 0.0);
  if (form_.h <= 0) return;
  const double scale = 1 / (form_.h * form_.h), damping_scale = 1 / form_.h;
  for (int i = 0; i < model_.node_count(); ++i) {
    if (model_.kind(i) == FrameKind::vertex) {
      add_vertex_inertia(i);
      continue;
    }
    const PoseMotion x = motion_of(at(i)), rest = form_.deviation(x, at(i));
    InertiaForce f = inertia_force(model_.inertia[at(i)], rest.u, rest.Q);
    inertia_energy_ += 0.5 * scale * inertia_product(model_.inertia[at(i)], rest.u, rest.Q);
    Vec3d force = f.force * scale;
    Mat3d moment = f.moment * scale;
    if (!model_.mass_damping.empty()) {
      const FrameInertia& damping = model_.mass_damping[at(i)];
      const PoseMotion path = x - form_.q[at(i)];
      f = inertia_force(damping, path.u, path.Q);
      inertia_energy_ += 0.5 * damping_scale * inertia_product(damping, path.u, path.Q);
      force += f.force * damping_scale;
      moment += f.moment * damping_scale;
    }
    add(inertia_, i, force, moment, {});
    const auto part = at(model_.points.node_part[at(i)]);
    // The motion and what the old velocity predicts of it cancel.
    const double cancelled = norm(x.u) + form_.reach * norm(start_.v[at(i)]) +
                             model_.points.part_length[part] * (norm(x.Q) + form_.reach * norm(start_.Q_dot[at(i)]));
    const double rounding = scale * model_.inertia[at(i)].mass * cancelled;
    inertia_rounding_[part] += rounding * rounding;
  }
  for (double& r : inertia_rounding_) r = std::numeric_limits<double>::epsilon() * std::sqrt(r);
}

/// @param turning  false leaves out how forces on dependent nodes turn their hosts, tethers' pull among them
void MechanicalSystem::add_node_blocks(Linearization& lin, bool turning) const {
  const bool full = lin.tangent == Tangent::full;
  const DofLayout& dofs = model_.points.dofs;
  if (full) {
    for (const DeadLoad& load : model_.loads)
      for (const NodeLoad& n : load.nodes)
        if (rigid(at(n.node)))
          add_rotation_block(
              lin.node_blocks.data() + dofs.block_begin(n.node),
              rotation_tangent(times_transpose(n.couple, lin.Q[at(n.node)])) * -factors_[at(load.schedule)]);
    if (turning) dependents_.add_turning(dependent_forces_, lin.node_blocks);
  }
  surfaces_.linearize(state_, factors_, lin);
  for (RankOne& term : lin.low_rank) dependents_.transfer(term.g);
  if (form_.h <= 0) return;
  const double scale = 1 / (form_.h * form_.h), damping_scale = 1 / form_.h;
  for (int i = 0; i < model_.node_count(); ++i) {
    const Mat3d& Q = lin.Q[at(i)];
    FrameInertia total = model_.inertia[at(i)];
    InertiaForce f;
    const PoseMotion x = motion_of(at(i));
    if (full) {
      const PoseMotion rest = form_.deviation(x, at(i));
      f = inertia_force(total, rest.u, rest.Q);
      f.moment *= scale;
    }
    total.mass *= scale;
    total.first *= scale;
    total.second *= scale;
    if (!model_.mass_damping.empty()) {
      FrameInertia damping = model_.mass_damping[at(i)];
      const PoseMotion path = x - form_.q[at(i)];
      if (full) f.moment += inertia_force(damping, path.u, path.Q).moment * damping_scale;
      damping.mass *= damping_scale;
      damping.first *= damping_scale;
      damping.second *= damping_scale;
      total += damping;
    }
    double* block = lin.node_blocks.data() + dofs.block_begin(i);
    add_inertia_block(dofs.kind(i), total, Q, block);
    if (full && rigid(at(i))) add_rotation_block(block, rotation_tangent(times_transpose(f.moment, Q)));
  }
}

/// The same of a node that is a point mass.
void MechanicalSystem::add_vertex_inertia(int node) {
  const auto i = at(node);
  const double mass = model_.inertia[i].mass, scale = mass / (form_.h * form_.h);
  const Vec3d &x = increment_.du[i], path = x - form_.q[i].u, rest = path - form_.w[i].u * form_.h;
  Vec3d force = rest * scale;
  inertia_energy_ += 0.5 * scale * squared_norm(rest);
  if (!model_.mass_damping.empty()) {
    const double damping = model_.mass_damping[i].mass / form_.h;
    inertia_energy_ += 0.5 * damping * squared_norm(path);
    force += path * damping;
  }
  double* out = inertia_.data() + model_.points.dofs.begin(node);
  for (int k = 0; k < 3; ++k) out[k] += force[k];
  const double rounding = scale * (norm(x) + form_.reach * norm(start_.v[i]));
  inertia_rounding_[at(model_.points.node_part[i])] += rounding * rounding;
}

/// Squares of |v| by connected part, torques divided by the part's length, over the free or the prescribed degrees.
void MechanicalSystem::add_squares(std::span<const double> global, std::vector<double>& free,
                                   std::vector<double>& fixed) {
  std::span<const double> local = global;
  if (filter_.turns()) {
    std::copy(global.begin(), global.end(), work_.begin());
    filter_.to_local(work_);
    local = work_;
  }
  free.assign(at(model_.points.part_count()), 0.0);
  fixed.assign(free.size(), 0.0);
  const DofLayout& dofs = model_.points.dofs;
  for (int node = 0; node < model_.node_count(); ++node) {
    const auto part = at(model_.points.node_part[at(node)]);
    if (!filter_.holds(node) && dofs.kind(node) == FrameKind::vertex) {
      const double* v = local.data() + dofs.begin(node);
      free[part] += v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
      continue;
    }
    for (int k = 0; k < dofs.size(node); ++k) {
      const std::size_t i = at(dofs.begin(node) + k);
      const double value = k < 3 ? local[i] : local[i] / model_.points.part_length[part];
      (filter_.is_fixed(i) ? fixed : free)[part] += value * value;
    }
  }
}

Evaluation MechanicalSystem::evaluate() {
  if (known_) return *std::exchange(known_, std::nullopt);
  internal_ = executor_.gradient(state_, history_, gradient_);
  add_loads();
  add_inertia();
  for (std::size_t i = 0; i < gradient_.size(); ++i) gradient_[i] += inertia_[i] - load_[i];
  dependents_.transfer(gradient_, dependent_forces_);
  Evaluation e;
  e.energy = internal_.total() + load_energy_ + inertia_energy_;
  add_squares(load_, part_squares_.load, part_squares_.held_load);
  add_squares(inertia_, part_squares_.inertia, part_squares_.unused);
  add_squares(gradient_, part_squares_.residual, part_squares_.reaction);
  double total = 0;
  for (std::size_t p = 0; p < part_squares_.residual.size(); ++p) {
    const int part = static_cast<int>(p);
    total += part_squares_.residual[p];
    const double residual = std::sqrt(part_squares_.residual[p]);
    const double reference =
        std::sqrt(std::max({part_squares_.load[p] + part_squares_.held_load[p], part_squares_.inertia[p],
                            part_squares_.reaction[p], executor_.squared_tether_force(part)}));
    // 4: sums of a few terms of the estimated size in each entry.
    const double leverage = dependents_.empty() ? 1.0 : dependents_.leverage()[p];
    const double floor =
        4 * leverage * std::hypot(executor_.rounding(part), inertia_rounding_[p], surfaces_.rounding(part));
    const double allowed = std::max(settings_.tolerance * reference, floor);
    const double excess = residual == 0 ? 0.0 : residual / std::max(allowed, 1e-300);
    if (excess < e.excess && p > 0) continue;
    e.excess = excess;
    const double scale = std::max({reference, floor, 1e-300});
    e.relative = residual / scale;
    e.relative_floor = floor / scale;
  }
  e.residual = std::sqrt(total);
  return e;
}

/// Angle of a frame's increment; of an affine one, the rotation that has an increment of A of that size.
double MechanicalSystem::rotation_in(int node, const double* vector) const {
  const double* d = vector + model_.points.dofs.begin(node) + 3;
  double squared = 0;
  for (int k = 0; k < model_.points.dofs.size(node) - 3; ++k) squared += d[k] * d[k];
  return std::sqrt(rigid(at(node)) ? squared : 0.5 * squared);
}

DirectionReport MechanicalSystem::direction() {
  executor_.linearize(state_, history_, settings_.tangent, lin_);
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
  report.linear_residual = solved.residual;
  report.cg_seconds = solved.cg_seconds;
  filter_.to_global(direction_);
  dependents_.expand(direction_);
  surfaces_.aim(lin_, direction_);
  for (std::size_t i = 0; i < direction_.size(); ++i) report.slope += gradient_[i] * direction_[i];
  for (int node = 0; node < model_.node_count(); ++node)
    report.largest_rotation = std::max(report.largest_rotation, rotation_in(node, direction_.data()));
  return report;
}

void MechanicalSystem::apply(double step) {
  surfaces_.approach(step);
  for (int i = 0; i < model_.node_count(); ++i) {
    const double* d = direction_.data() + model_.points.dofs.begin(i);
    increment_.du[at(i)] += Vec3d{{d[0], d[1], d[2]}} * step;
    Mat3d& Ds = increment_.Ds[at(i)];
    if (rigid(at(i)))
      Ds = compose_increments(rotation_increment(Vec3d{{d[3], d[4], d[5]}} * step), Ds);
    else
      Ds += frame_variation(model_.kind(i), d + 3, {}) * step;
  }
  for (std::size_t k = 0; k < model_.constraints.size(); ++k) {
    const FrameConstraint& c = model_.constraints[k];
    if (!rigid(at(c.node))) continue;
    const double* d = direction_.data() + model_.points.dofs.begin(c.node) + 3;
    for (int a = 0; a < c.rotations; ++a)
      increment_.turned[k][at(a)] += step * dot(c.rotation_axes.row(a), Vec3d{{d[0], d[1], d[2]}});
  }
  rebuild_state();
}

void MechanicalSystem::save() {
  saved_ = increment_;
  surfaces_.save();
}

void MechanicalSystem::restore() {
  increment_ = saved_;
  surfaces_.restore();
  rebuild_state();
}

}  // namespace fascia
