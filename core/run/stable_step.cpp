#include "core/base/errors.hpp"
#include "core/linear/lanczos.hpp"
#include "core/node/node_inertia.hpp"
#include "core/node/small_factor.hpp"
#include "core/run/explicit_dynamics.hpp"
#include "core/step/dependents.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <sstream>

namespace fascia {

namespace {

/// Stiffness of enclosed volumes, the largest of their schedules.
std::vector<RankOne> fluids_of(const MechanicalSystem& system, const State& state) {
  const Model& model = system.model();
  const NodesView& nodes = system.nodes().nodes;
  std::vector<RankOne> fluids;
  Surfaces<PoolSpace> surfaces(model, system.space());
  if (surfaces.terms() == 0) return fluids;
  const std::vector<double> factors = zero_factors(model);
  std::vector<double> unused(at(model.dof_count())), blocks(model.points.dofs.block_total());
  std::vector<Mat3d> Q(at(model.node_count()), Mat3d::identity());
  for (std::size_t i = 0; i < Q.size(); ++i) Q[i] += state.D[i];
  surfaces.add_forces(nodes, {state.u.data(), state.D.data()}, factors.data(), unused.data());
  SurfaceTangent<PoolSpace> tangent;
  surfaces.linearize(nodes, Q.data(), factors.data(), Tangent::material, tangent, blocks.data());
  for (const SurfaceLoad& load : model.surfaces) {
    if (!load.has_potential || !(load.bulk_modulus > 0)) continue;
    const double* g = tangent.volume_gradient(static_cast<int>(fluids.size()));
    fluids.push_back(
        {load.bulk_modulus / std::min(load.rest_volume, load.volume), std::vector<double>(g, g + model.dof_count())});
  }
  return fluids;
}

/// The largest eigenvalue of M⁻¹ K on the free degrees of freedom, K with the viscous stress of any time step.
class HighestFrequency {
 public:
  HighestFrequency(MechanicalSystem& system, const State& state)
      : executor_(system.executor()),
        filter_(system.filter()),
        dofs_(system.model().points.dofs),
        nodes_(system.nodes().nodes),
        dependents_(system.model().points, system.space()),
        state_(state),
        fluids_(fluids_of(system, state)) {
    const Model& model = system.model();
    require_inertia(model, filter_);
    inverse_mass_.resize(dofs_.block_total());
    for (int node = 0; node < dofs_.node_count(); ++node) {
      const int n = dofs_.size(node);
      SmallFactor factor;
      factor.factorize(free_mass_block(model, filter_, node, Mat3d::identity() + state.D[at(node)]).data(), n);
      for (int j = 0; j < n; ++j) {
        double* column = inverse_mass_.data() + dofs_.block_begin(node) + at(n * j);
        column[j] = 1;
        factor.solve(column);
      }
    }
    executor_.store_strain(state, history_.E);
    dependents_.turn(state.D.data());
    dependent_forces_.resize(6 * model.points.dependents.size());
  }

  /// ω² [1/s²]. @param inverse_step  of the viscous stress [1/s]
  double squared(double inverse_step) {
    history_.inverse_step = inverse_step;
    std::vector<double> w(at(dofs_.total()));
    executor_.gradient(state_, history_, w);
    executor_.linearize(state_, history_, Tangent::full, lin_);
    lin_.loads.volumes = fluids_;
    dependents_.transfer(nodes_, w.data(), dependent_forces_.data());
    dependents_.add_turning(nodes_, dependent_forces_.data(), lin_.node_blocks.data());
    found_ = iterate({});
    return found_.value;
  }

  /// The motion of the last call, by repeating its iterations: world axes, 1/√kg in all, and each node's part of it.
  void motion(LimitingMotion& out) {
    if (found_.diagonal.empty()) return;
    const std::vector<double> s = largest_eigenvector(found_.diagonal, found_.off, found_.value);
    std::vector<double> x(at(dofs_.total()), 0.0), momentum = x;
    iterate([&](std::size_t k, const std::vector<double>& v, const std::vector<double>& y) {
      for (std::size_t i = 0; i < x.size() && k < s.size(); ++i) {
        x[i] += s[k] * v[i];
        momentum[i] += s[k] * y[i];
      }
    });
    out.kinetic.assign(at(dofs_.node_count()), 0.0);
    double sum = 0;
    for (int node = 0; node < dofs_.node_count(); ++node) {
      for (int k = 0; k < dofs_.size(node); ++k) {
        const std::size_t i = at(dofs_.begin(node) + k);
        out.kinetic[at(node)] += x[i] * momentum[i];
      }
      sum += out.kinetic[at(node)];
    }
    for (double& part : out.kinetic) part /= sum;
    filter_.to_global(x);
    dependents_.expand(nodes_, x.data());
    out.motion = std::move(x);
  }

 private:
  using Vector = std::vector<double>;

  LanczosValue iterate(const std::function<void(std::size_t, const Vector&, const Vector&)>& each) {
    Vector y(at(dofs_.total()));
    std::mt19937 random(1);
    for (double& x : y) x = 2.0 * static_cast<double>(random()) / 4294967295.0 - 1.0;
    filter_.clear_fixed(y);
    LanczosOptions options;
    options.most = std::min(options.most, filter_.free_count());
    return largest_ratio(
        std::move(y), options, [&](const Vector& r, Vector& v) { solve_mass(r, v); },
        [&](const Vector& v, Vector& w) { multiply(v, w); }, each);
  }

  void solve_mass(const std::vector<double>& y, std::vector<double>& v) const {
    for (int node = 0; node < dofs_.node_count(); ++node) {
      const int n = dofs_.size(node), first = dofs_.begin(node);
      const double* inverse = inverse_mass_.data() + dofs_.block_begin(node);
      for (int i = 0; i < n; ++i) {
        double sum = 0;
        for (int j = 0; j < n; ++j) sum += inverse[n * i + j] * y[at(first + j)];
        v[at(first + i)] = sum;
      }
    }
  }

  void multiply(const std::vector<double>& v, std::vector<double>& w) {
    global_ = v;
    filter_.to_global(global_);
    dependents_.expand(nodes_, global_.data());
    executor_.multiply(lin_, global_, w);
    dependents_.transfer(nodes_, w.data());
    filter_.to_local(w);
    filter_.clear_fixed(w);
  }

  CpuExecutor& executor_;
  const DofFilter& filter_;
  const DofLayout& dofs_;
  NodesView nodes_;
  Dependents<PoolSpace> dependents_;
  const State& state_;
  std::vector<RankOne> fluids_;
  StrainHistory history_;
  Linearization lin_;
  std::vector<double> inverse_mass_, global_, dependent_forces_;
  LanczosValue found_;  ///< of the last call of squared()
};

/// The stable step with its margin; leaves `highest` at the viscous stress that belongs to it.
LimitingMotion stable_step_of(HighestFrequency& highest, bool damped) {
  LimitingMotion out;
  const double elastic = highest.squared(0);
  if (!(elastic > 0)) return out;
  double dt = 2 / std::sqrt(elastic);
  out.step = out.undamped = kStableMargin * dt;
  if (!damped) return out;
  // The limit is dt² (K + 2 C / dt) = 4 M: ω² grows with 2/dt, by a line that each round finds anew.
  for (int round = 0; round < 20; ++round) {
    const double damping = 0.5 * dt * std::max(0.0, highest.squared(2 / dt) - elastic);
    const double next = 4 / (damping + std::sqrt(damping * damping + 4 * elastic));
    const bool settled = std::abs(next - dt) <= 1e-4 * dt;
    dt = next;
    if (settled) break;
  }
  out.step = kStableMargin * dt;
  return out;
}

}  // namespace

void refuse_active_stress(const Model& model) {
  if (model.points.memory.acts())
    throw InputError(
        "a material makes a stress by itself, whose work explicit steps do not count; use an implicit scheme");
}

void require_inertia(const Model& model, const DofFilter& filter) {
  for (int node = 0; node < model.node_count(); ++node) {
    SmallFactor factor;
    if (factor.factorize(free_mass_block(model, filter, node, Mat3d::identity()).data(), model.points.dofs.size(node)))
      continue;
    const Vec3d& X = model.rest_position[at(node)];
    std::ostringstream message;
    message << (model.kind(node) == FrameKind::vertex ? "the vertex at (" : "the frame at (") << X[0] << ", " << X[1]
            << ", " << X[2] << ") has no inertia in some of its motions, which explicit dynamics cannot step; use a "
            << "density above 0, more integration points or fewer frames, or an implicit scheme";
    throw InputError(message.str());
  }
}

double stable_time_step(MechanicalSystem& system, const State& state) {
  if (system.filter().free_count() == 0) return std::numeric_limits<double>::infinity();
  HighestFrequency highest(system, state);
  return stable_step_of(highest, system.model().points.damped).step;
}

LimitingMotion limiting_motion(MechanicalSystem& system, const State& state) {
  if (system.filter().free_count() == 0) return {};
  HighestFrequency highest(system, state);
  LimitingMotion out = stable_step_of(highest, system.model().points.damped);
  if (std::isfinite(out.step)) highest.motion(out);
  return out;
}

double stable_time_step(MechanicalSystem& system) { return stable_time_step(system, State::at_rest(system.model())); }

}  // namespace fascia
