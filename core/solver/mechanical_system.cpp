#include "core/solver/mechanical_system.hpp"

#include "core/base/index.hpp"
#include "core/node/node_force.hpp"
#include "core/solver/part_forces.hpp"
#include "core/solver/state_copies.hpp"
#include "core/step/boundary_loops.hpp"
#include "core/tangent/extrapolation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace fascia {

namespace {

/// What conjugate gradients leave, in their norm, of a residual that is to fall to Newton's tolerance at once: in its
/// own norm it may be a hundred times as much.
constexpr double kOfTolerance = 0.003;
/// A smaller part of the tolerance counts as this.
constexpr double kLeastRelative = 1e-6;
/// A smaller tolerance is less than what rounding of products may leave.
constexpr double kLeastTolerance = 1e-12;

/// Copies what the system's increment has, by all threads.
template <class Increment>
void copy_increment(ThreadPool& pool, const Increment& from, Increment& to) {
  const auto& [du, Ds, turned] = from;  // no member is forgotten
  copy_into(pool, du, to.du);
  copy_matrices(pool, Ds, to.Ds);
  to.turned = turned;
}

}  // namespace

MechanicalSystem::MechanicalSystem(const Model& model, ThreadPool& pool, const SolverSettings& settings)
    : model_(model),
      settings_(settings),
      filter_(model),
      space_(pool),
      data_(model, filter_, zero_factors(model).size()),
      node_parts_(model.points.node_part, model.points.part_count(), space_),
      executor_(model.points, pool),
      tangent_(model, executor_, filter_, settings),
      dependents_(model.points, space_),
      conservative_(model.loads_are_conservative()),
      linear_(model.is_linear()),
      extrapolates_(extrapolates_stresses(model.points, settings.tangent)),
      followers_(model, space_),
      surfaces_(model, space_),
      motions_(motion_sizes(model)),
      masses_(part_masses(model)),
      driven_(driven_parts(model)),
      state_(State::at_rest(model)),
      memory_(model.points.memory, space_) {
  for (auto* vector : {&gradient_, &load_, &inertia_, &direction_, &work_, &prescribed_})
    vector->resize(at(model.dof_count()));
  node_energy_.resize(3 * at(model.node_count()));
  node_sums_.resize(at(model.points.part_count()) * kNodeQuantities);
  dependent_forces_.resize(6 * model.points.dependents.size());
  factors_ = reached_factors_ = zero_factors(model);
  data_.set_factors(factors_);
}

std::vector<double> zero_factors(const Model& model) {
  int schedules = 0;
  for (const DeadLoad& l : model.loads) schedules = std::max(schedules, l.schedule + 1);
  for (const FollowerLoad& l : model.followers) schedules = std::max(schedules, l.schedule + 1);
  for (const SurfaceLoad& l : model.surfaces) schedules = std::max({schedules, l.schedule + 1, l.weight_schedule + 1});
  for (const PrescribedMotion& m : model.motions) schedules = std::max(schedules, m.schedule + 1);
  for (const int active : model.points.memory.schedule) schedules = std::max(schedules, active + 1);
  return std::vector<double>(at(schedules), 0.0);
}

StepView MechanicalSystem::step_view() {
  return {.model = data_.view(),
          .step = form_,
          .u0 = start_.u.data(),
          .v0 = start_.v.data(),
          .D0 = start_.D.data(),
          .rate0 = start_.Q_dot.data(),
          .du = increment_.du.data(),
          .u = state_.u.data(),
          .Ds = increment_.Ds.data(),
          .D = state_.D.data(),
          .q = form_.q.data(),
          .w = form_.w.data(),
          .turned = loops::flat(increment_.turned),
          .turning = state_.D.data() != nullptr};
}

ForceView MechanicalSystem::force_view() {
  return {gradient_.data(), load_.data(), inertia_.data(), node_energy_.data()};
}

void MechanicalSystem::set_factors(std::span<const double> factors) {
  known_.reset();
  note_stretches();
  factors_.assign(factors.begin(), factors.end());
  data_.set_factors(factors_);
  place_tethers(model_, factors_, executor_.targets());
  act(factors_);
}

void MechanicalSystem::set_rest() {
  set_factors(std::vector<double>(factors_.size(), 0.0));
  const std::span<double> targets = executor_.targets();
  std::fill(targets.begin(), targets.end(), 0.0);
}

void MechanicalSystem::rebuild_state() {
  known_.reset();
  state_.u.resize(start_.u.size());
  if (state_.D.size() != start_.D.size()) state_.D = start_.D;
  space_.for_each(model_.node_count(), loops::RebuildState{step_view()});
  if (!dependents_.empty()) place_dependents_of_step();
}

/// In the present state, and their increments by those of their hosts, which keep the digits of small steps.
void MechanicalSystem::place_dependents_of_step() {
  dependents_.place_increments(increment_.du.data(), increment_.Ds.data(), start_.D.data());
  place_dependents(state_);
  dependents_.turn(state_.D.data());
}

/// Energy of the step where it starts. The strain energy is what the step before left; nothing has flowed yet.
double MechanicalSystem::energy_at_start() {
  const bool same = reached_ && form_.scheme == TimeScheme::implicit_euler && reached_->u == start_.u &&
                    std::ranges::equal(reached_->D.values(), start_.D.values());
  if (!same) return evaluate().energy;
  add_loads_and_inertia();
  return reached_->energy + load_energy_ + inertia_energy_;
}

void MechanicalSystem::start_from_prediction() {
  if (!model_.points.user_blocks.empty()) return;  // a leap that would not ask them, see largest_step()
  const double at_old_state = energy_at_start();
  save();
  space_.for_each(model_.node_count(), loops::PredictIncrement{step_view()});
  rebuild_state();
  const Evaluation predicted = evaluate();
  if (predicted.energy < at_old_state)
    known_ = predicted;  // Newton asks for it next
  else
    restore();
}

/// Potentials of both at the present state.
void MechanicalSystem::add_loads_and_inertia() {
  double energies[2];
  space_.sum<2>(model_.node_count(), loops::StoreLoadsAndInertia{step_view(), force_view()},
                loops::StoreSums<2, 0>{energies});
  load_energy_ = energies[0];
  inertia_energy_ = energies[1];
  const NodesView& nodes = data_.view().nodes;
  const PoseView pose{state_.u.data(), state_.D.data()};
  if (!followers_.empty()) followers_.add_forces(nodes, pose, factors_.data(), load_.data());
  if (surfaces_.empty()) return;
  surfaces_.add_forces(nodes, pose, factors_.data(), load_.data());
  load_energy_ += surfaces_.potential(surface_figures());
}

/// @param turning  false leaves out how forces on dependent nodes turn their hosts, tethers' pull among them
void MechanicalSystem::add_node_blocks(Linearization& lin, bool turning) {
  const bool full = lin.tangent == Tangent::full;
  if (full) {
    for (const DeadLoad& load : model_.loads)
      for (const NodeLoad& n : load.nodes)
        if (model_.kind(n.node) == FrameKind::rigid && squared_norm(n.torque) > 0)
          lin.torques.push_back({n.node, n.torque * factors_[at(load.schedule)]});
    for (const FollowerLoad& load : model_.followers)
      lin.followers.emplace_back(load, state_, factors_[at(load.schedule)]);
    if (turning) dependents_.add_turning(data_.view().nodes, dependent_forces_.data(), lin.node_blocks.data());
  }
  if (!surfaces_.empty()) add_surface_tangent(lin);
  if (form_.h > 0 || (full && !model_.loads.empty()))
    space_.for_each(model_.node_count(),
                    loops::AddLoadAndInertiaBlocks{step_view(), lin.Q.data(), lin.node_blocks.data(), full});
}

/// What the surface loads of the last evaluation are in a tangent there; volumes stand beside the matrix.
void MechanicalSystem::add_surface_tangent(Linearization& lin) {
  const NodesView& nodes = data_.view().nodes;
  SurfaceTangent<PoolSpace>& tangent = lin.surface_tangent;
  lin.surfaces = &surfaces_;
  surfaces_.linearize(nodes, lin.Q.data(), factors_.data(), lin.tangent, tangent, lin.node_blocks.data());
  for (int t = 0; t < surfaces_.terms(); ++t) {
    double* g = tangent.volume_gradient(t);
    dependents_.transfer(nodes, g);
    const double stiffness = tangent.stiffness.data()[t];
    if (stiffness > 0) lin.low_rank.push_back({stiffness, std::vector<double>(g, g + model_.dof_count())});
  }
}

Evaluation MechanicalSystem::evaluate() {
  if (known_) return *std::exchange(known_, std::nullopt);
  internal_ = executor_.gradient(state_, history_, gradient_);
  evaluate_loads();
  space_.for_each(model_.dof_count(), loops::AddInertiaAndLoads{force_view()});
  dependents_.transfer(data_.view().nodes, gradient_.data(), dependent_forces_.data());
  Evaluation e;
  e.energy = internal_.total() + load_energy_ - load_work_ + inertia_energy_;
  e.energy_scale = internal_.size() + std::abs(load_energy_) + inertia_energy_;
  e.strain_energy = form_.h <= 0 && !model_.points.memory.acts() ? internal_.elastic : 0.0;
  judge(forces_of_parts(), model_.points.part_whole, settings_.tolerance, e);
  relative_ = e.relative;
  return e;
}

/// Collects what the verdict on the present state is made from.
std::vector<PartForces> MechanicalSystem::forces_of_parts() {
  node_parts_.sum<kNodeQuantities>(loops::NodeReport{data_.view(), force_view()}, node_sums_.data());
  std::vector<PartForces> parts;
  parts.reserve(masses_.size());
  for (std::size_t p = 0; p < masses_.size(); ++p) {
    const int part = static_cast<int>(p);
    const PartSizes sizes{.rounding = executor_.rounding(part),
                          .of_surfaces = surfaces_.empty() ? 0.0 : surfaces_.rounding(part, surface_figures()),
                          .tether = executor_.points().squared_tether_force(part),
                          .leverage = dependents_.leverage()[p],
                          .mass = masses_[p],
                          .driven = driven_[p] != 0};
    parts.push_back(
        part_forces(node_sums_.data() + p * kNodeQuantities, sizes, form_.h, [&] { return executor_.motion(part); }));
    if (!kept_loads_.empty()) parts.back().load = std::max(parts.back().load, kept_loads_[p]);
  }
  return parts;
}

/// After a step, the work that its loads did and that their potential does not show.
void MechanicalSystem::evaluate_loads() {
  add_loads_and_inertia();
  if (applied_ != 0) load_work_ += 0.5 * applied_ * (start_power_ + load_power()) + load_energy_ - start_potential_;
  applied_ = 0;
}

/// Work of the present loads along the direction, for a step of 1 [J].
double MechanicalSystem::load_power() const {
  return std::inner_product(load_.begin(), load_.end(), direction_.begin(), 0.0);
}

DirectionReport MechanicalSystem::direction(int most_iterations) {
  const TakenStep* taken = has_taken_ ? &taken_ : nullptr;
  executor_.linearize(state_, history_, settings_.tangent, lin_, true, taken);
  add_node_blocks(lin_);
  std::vector<double> rhs(gradient_.size()), prescribed;
  for (std::size_t i = 0; i < rhs.size(); ++i) rhs[i] = -gradient_[i];
  filter_.to_local(rhs);
  if (has_prescribed_increment()) prescribed = prescribed_;
  Linearization fallback;
  tangent_.expect_inertia(form_.h > 0 && conservative_);
  tangent_.limit_iterations(most_iterations);
  const double left = kOfTolerance * settings_.tolerance / std::max(relative_, kLeastRelative * settings_.tolerance);
  tangent_.aim_at(left, linear_);
  tangent_.keep_factors(settings_.tolerance >= kLeastTolerance);
  const TangentReport solved = tangent_.solve(
      lin_, prescribed, rhs, direction_, [&](TamerTangent kind) -> auto& {
        const bool material = kind == TamerTangent::material;
        executor_.linearize(state_, history_, material ? Tangent::material : settings_.tangent, fallback, false);
        add_node_blocks(fallback, false);
        return fallback;
      });
  tangent_.limit_iterations(kAsManyAsNeeded);
  DirectionReport report;
  report.usable = solved.usable;
  report.linear_iterations = solved.iterations;
  report.trouble = solved.trouble;
  report.indefinite = solved.indefinite;
  report.unsolved = solved.unsolved;
  report.linear_residual = solved.residual;
  report.cg_seconds = solved.seconds;
  double sums[3];
  double* d = direction_.data();
  space_.sum<1, 2>(model_.node_count(), loops::TakeDirection<double>{data_.view(), d, nullptr, gradient_.data(), d},
                   loops::StoreSums<1, 2>{sums});
  dependents_.expand(data_.view().nodes, direction_.data());
  if (!surfaces_.empty()) surfaces_.aim(lin_.surface_tangent, direction_.data());
  report.slope = sums[0];
  report.largest_rotation = std::max(sums[1], executor_.largest_spin(direction_));
  if (!conservative_) {
    start_power_ = load_power();
    start_potential_ = load_energy_;
  }
  return report;
}

void MechanicalSystem::linearize_loads() {
  lin_.tangent = settings_.tangent;
  lin_.surfaces = nullptr;
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
  dependents_.expand(data_.view().nodes, all.data());
  add_unsymmetric_product(lin_, model_.points, all, product);
  dependents_.transfer(data_.view().nodes, product.data());
  filter_.to_local(product);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] += product[i];
}

std::vector<double> MechanicalSystem::product(std::span<const double> d) {
  executor_.linearize(state_, history_, settings_.tangent, lin_);
  add_node_blocks(lin_);
  std::vector<double> all(d.begin(), d.end()), y(d.size());
  dependents_.expand(data_.view().nodes, all.data());
  executor_.multiply(lin_, all, y);
  dependents_.transfer(data_.view().nodes, y.data());
  return y;
}

/// Keeps where a step starts, and along what it goes.
void MechanicalSystem::note_step(double step) {
  has_taken_ = extrapolates_;
  if (!has_taken_) return;
  taken_.u = state_.u;
  taken_.D = state_.D;
  taken_.d.resize(direction_.size());
  space_.for_each(static_cast<int>(direction_.size()), [&](int i) { taken_.d[at(i)] = step * direction_[at(i)]; });
}

double MechanicalSystem::largest_step(double wanted) {
  return std::min(wanted, executor_.largest_step(state_, direction_, lin_.Q));
}

void MechanicalSystem::apply(double step) {
  note_step(step);
  if (!conservative_) applied_ = step;
  if (!surfaces_.empty()) surfaces_.approach(step);
  known_.reset();
  space_.for_each(model_.node_count(), loops::Advance{step_view(), direction_.data(), step});
  if (!dependents_.empty()) place_dependents_of_step();
}

void MechanicalSystem::save() {
  copy_increment(executor_.pool(), increment_, saved_);
  saved_work_ = load_work_;
  if (!surfaces_.empty()) surfaces_.save();
}

void MechanicalSystem::restore() {
  has_taken_ = false;
  copy_increment(executor_.pool(), saved_, increment_);
  load_work_ = saved_work_;
  applied_ = 0;
  if (!surfaces_.empty()) surfaces_.restore();
  rebuild_state();
}

}  // namespace fascia
