#include "core/solver/mechanical_system.hpp"

#include "core/base/index.hpp"
#include "core/node/node_force.hpp"
#include "core/solver/step_system_body.hpp"
#include "core/solver/step_system_reached.hpp"
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

}  // namespace

MechanicalSystem::MechanicalSystem(const Model& model, ThreadPool& pool, const SolverSettings& settings)
    : StepSystem(model, settings, PoolSpace(pool)),
      executor_(model.points, pool),
      tangent_(model, executor_, filter_, settings),
      linear_(model.is_linear()),
      extrapolates_(extrapolates_stresses(model.points, settings.tangent)) {
  now_ = State::at_rest(model);
  for (auto* vector : {&work_, &prescribed_}) vector->resize(at(model.dof_count()));
  node_sums_.resize(at(model.points.part_count()) * kNodeQuantities);
}

void MechanicalSystem::step_began() {
  if (!memory_.empty()) now_.memory = start_.memory;
  has_taken_ = false;
  saved_work_ = applied_ = 0;
  executor_.start_from(start_);
}

void MechanicalSystem::release_tethers() {
  const std::span<double> targets = executor_.targets();
  std::fill(targets.begin(), targets.end(), 0.0);
}

void MechanicalSystem::begin_afresh(std::span<const double> factors, const std::vector<double>& pressures) {
  forget_steps(factors, pressures);
  tangent_.begin_afresh();
}

void MechanicalSystem::forget_steps(std::span<const double> factors, const std::vector<double>& pressures) {
  StepSystem::forget_steps(factors, pressures);
  tangent_.forget_kept_factor();
}

/// Potentials of both at the present state.
void MechanicalSystem::add_loads_and_inertia() {
  double energies[2];
  space_.sum<2>(model_.node_count(), loops::StoreLoadsAndInertia{step_view(), force_view()},
                loops::StoreSums<2, 0>{energies});
  load_energy_ = energies[0];
  inertia_energy_ = energies[1];
  const NodesView& nodes = data_.view().nodes;
  const PoseView pose{now_.u.data(), now_.D.data()};
  moving_.add_forces(nodes, pose, factors_.data(), load_.data());
  if (!moving_.surfaces.empty()) load_energy_ += moving_.surfaces.potential(surface_figures());
}

/// @param turning  false leaves out how forces on dependent nodes turn their hosts, tethers' pull among them
void MechanicalSystem::add_node_blocks(Linearization& lin, bool turning) {
  const bool full = lin.tangent == Tangent::full;
  if (full) {
    lin.loads.take(model_, now_, factors_);
    if (turning) dependents_.add_turning(data_.view().nodes, dependent_forces_.data(), lin.node_blocks.data());
  }
  if (!moving_.surfaces.empty()) add_surface_tangent(lin);
  if (step_.h > 0 || (full && !model_.loads.empty()))
    space_.for_each(model_.node_count(),
                    loops::AddLoadAndInertiaBlocks{step_view(), lin.Q.data(), lin.node_blocks.data(), full});
}

/// What the surface loads of the last evaluation are in a tangent there; volumes stand beside the matrix.
void MechanicalSystem::add_surface_tangent(Linearization& lin) {
  const NodesView& nodes = data_.view().nodes;
  SurfaceTangent<PoolSpace>& tangent = lin.loads.surface;
  lin.loads.surfaces = &moving_.surfaces;
  moving_.surfaces.linearize(nodes, lin.Q.data(), factors_.data(), lin.tangent, tangent, lin.node_blocks.data());
  for (int t = 0; t < moving_.surfaces.terms(); ++t) {
    double* g = tangent.volume_gradient(t);
    dependents_.transfer(nodes, g);
    const double stiffness = tangent.stiffness.data()[t];
    if (stiffness > 0) lin.loads.volumes.push_back({stiffness, std::vector<double>(g, g + model_.dof_count())});
  }
}

Evaluation MechanicalSystem::evaluate_anew() {
  internal_ = executor_.gradient(now_, history_, gradient_);
  evaluate_loads();
  space_.for_each(model_.dof_count(), loops::AddInertiaAndLoads{force_view()});
  dependents_.transfer(data_.view().nodes, gradient_.data(), dependent_forces_.data());
  Evaluation e = judged(forces_of_parts());
  e.strain_energy = step_.h <= 0 && !memory_.acts() ? internal_.elastic : 0.0;
  relative_ = e.relative;
  return e;
}

/// Forces, without what hosts have of dependent nodes.
void MechanicalSystem::evaluate_unjudged() {
  executor_.gradient(now_, history_, gradient_);
  add_loads_and_inertia();
  space_.for_each(model_.dof_count(), loops::AddInertiaAndLoads{force_view()});
}

/// Collects what the verdict on the present state is made from.
std::vector<PartForces> MechanicalSystem::forces_of_parts() {
  node_parts_.sum<kNodeQuantities>(loops::NodeReport{data_.view(), force_view()}, node_sums_.data());
  std::vector<PartForces> parts;
  parts.reserve(masses_.size());
  for (std::size_t p = 0; p < masses_.size(); ++p) {
    const int part = static_cast<int>(p);
    const PartSizes sizes{
        .rounding = executor_.rounding(part),
        .of_surfaces = moving_.surfaces.empty() ? 0.0 : moving_.surfaces.rounding(part, surface_figures()),
        .tether = executor_.points().squared_tether_force(part),
        .leverage = dependents_.leverage()[p],
        .mass = masses_[p],
        .driven = driven_[p] != 0};
    parts.push_back(
        part_forces(node_sums_.data() + p * kNodeQuantities, sizes, step_.h, [&] { return executor_.motion(part); }));
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
  executor_.linearize(now_, history_, settings_.tangent, lin_, true, taken);
  add_node_blocks(lin_);
  std::vector<double> rhs(gradient_.size()), prescribed;
  for (std::size_t i = 0; i < rhs.size(); ++i) rhs[i] = -gradient_[i];
  filter_.to_local(rhs);
  if (has_prescribed_increment()) prescribed = prescribed_;
  Linearization fallback;
  tangent_.expect_inertia(step_.h > 0 && conservative_);
  tangent_.limit_iterations(most_iterations);
  const double left = kOfTolerance * settings_.tolerance / std::max(relative_, kLeastRelative * settings_.tolerance);
  tangent_.aim_at(left, linear_);
  tangent_.keep_factors(settings_.tolerance >= kLeastTolerance);
  const TangentReport solved = tangent_.solve(
      lin_, prescribed, rhs, direction_, [&](TamerTangent kind) -> auto& {
        const bool material = kind == TamerTangent::material;
        executor_.linearize(now_, history_, material ? Tangent::material : settings_.tangent, fallback, false);
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
  if (!moving_.surfaces.empty()) moving_.surfaces.aim(lin_.loads.surface, direction_.data());
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
  lin_.loads.clear();
  lin_.node_blocks.assign(model_.points.dofs.block_total(), 0.0);
  lin_.Q.resize(now_.D.size());
  for (std::size_t i = 0; i < lin_.Q.size(); ++i) lin_.Q[i] = Mat3d::identity() + now_.D[i];
  add_node_blocks(lin_);
}

Stability MechanicalSystem::stability(const State& end, long made, bool current) {
  return stability_of(*this, end, State::at_rest(model_), [&](bool at_end) {
    executor_.linearize(now_, history_, Tangent::full, lin_);
    add_node_blocks(lin_);
    return tangent_.softest(lin_, made, current && at_end && settings_.tangent == Tangent::full);
  });
}

TangentCondition MechanicalSystem::condition(double most_flops) {
  executor_.linearize(now_, history_, settings_.tangent, lin_);
  add_node_blocks(lin_);
  return tangent_.condition(lin_, most_flops);
}

const Multigrid* MechanicalSystem::levels(bool material) {
  Linearization tamer;
  Linearization& lin = material ? tamer : lin_;
  const TakenStep* taken = has_taken_ && !material ? &taken_ : nullptr;
  executor_.linearize(now_, history_, material ? Tangent::material : settings_.tangent, lin, !material, taken);
  add_node_blocks(lin, !material);
  return tangent_.levels(lin, material);
}

void MechanicalSystem::add_unsymmetric(std::span<const double> x, std::span<double> y) {
  std::vector<double> all(x.begin(), x.end()), product(x.size());
  filter_.to_global(all);
  dependents_.expand(data_.view().nodes, all.data());
  lin_.loads.add_unsymmetric_product(model_.points, lin_.Q, all, product);
  dependents_.transfer(data_.view().nodes, product.data());
  filter_.to_local(product);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] += product[i];
}

std::vector<double> MechanicalSystem::product(std::span<const double> d) {
  executor_.linearize(now_, history_, settings_.tangent, lin_);
  add_node_blocks(lin_);
  std::vector<double> all(d.begin(), d.end()), y(d.size());
  dependents_.expand(data_.view().nodes, all.data());
  executor_.multiply(lin_, all, y);
  dependents_.transfer(data_.view().nodes, y.data());
  return y;
}

void MechanicalSystem::find_prescribed(std::span<const double> factors, std::span<double> local) {
  std::fill(local.begin(), local.end(), 0.0);
  space_.for_each(
      static_cast<int>(model_.constraints.size()),
      loops::FindPrescribed{
          data_.view(), {now_.u.data(), now_.D.data()}, loops::flat(increment_.turned), factors.data(), local.data()});
}

bool MechanicalSystem::has_prescribed_increment() {
  if (model_.constraints.empty()) return false;
  find_prescribed(factors_, prescribed_);
  double left[3];
  space_.sum<0, 3>(model_.node_count(), loops::PrescribedLeft{step_view(), prescribed_.data()},
                   loops::StoreSums<0, 3>{left});
  return motions_.lacks(left);
}

double MechanicalSystem::prescribed_rotation() const {
  return fascia::prescribed_rotation(model_, increment_.turned, factors_, reached_factors_);
}

/// Keeps where a step starts, and along what it goes.
void MechanicalSystem::note_step(double step) {
  if (!conservative_) applied_ = step;
  has_taken_ = extrapolates_;
  if (!has_taken_) return;
  taken_.u = now_.u;
  taken_.D = now_.D;
  taken_.d.resize(direction_.size());
  space_.for_each(static_cast<int>(direction_.size()), [&](int i) { taken_.d[at(i)] = step * direction_[at(i)]; });
}

void MechanicalSystem::step_restored() {
  has_taken_ = false;
  load_work_ = saved_work_;
  applied_ = 0;
}

double MechanicalSystem::largest_step(double wanted) {
  return std::min(wanted, executor_.largest_step(now_, direction_, lin_.Q));
}

template class StepSystem<MechanicalSystem, PoolStep>;

}  // namespace fascia
