#include "core/run/modes.hpp"

#include "core/base/index.hpp"
#include "core/executor/executor.hpp"
#include "core/linear/cholesky.hpp"
#include "core/math/dense.hpp"
#include "core/math/rotation.hpp"
#include "core/node/dof_filter.hpp"
#include "core/structure/blocks.hpp"
#include "core/structure/inertia.hpp"
#include "core/tangent/condensation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace fascia {

namespace {

using Dense = Eigen::MatrixXd;

/// K and M in constraint axes, on all degrees of freedom; prescribed ones stay zero.
class Problem {
 public:
  Problem(const Model& model, ThreadPool& pool)
      : pool_(pool),
        filter_(model),
        nodes_(nodes_of(model.points)),
        dependents_(model.points, PoolSpace(pool)),
        K_(model.points) {
    CpuExecutor executor(model.points, pool);
    const State rest = State::at_rest(model);
    std::vector<double> gradient(static_cast<std::size_t>(model.dof_count()));
    executor.gradient(rest, {}, gradient);
    Linearization lin;
    executor.linearize(rest, {}, Tangent::full, lin);
    executor.assemble(lin, K_);
    Condensation(dependents_, dofs(), pool).condense(K_);
    sum_stiffness(model.points);
    mass_.assign(dofs().block_total(), 0.0);
    for (int i = 0; i < model.node_count(); ++i)
      add_inertia_block(model.kind(i), model.inertia[at(i)], Mat3d::identity(), mass_.data() + dofs().block_begin(i));
    for (const FrameInertia& inertia : model.inertia) mass_sum_ += inertia.mass;
    free_ = filter_.free_count() + model.dependent_dof_count() == model.dof_count();
  }

  const DofFilter& filter() const { return filter_; }
  /// Entries of dependent nodes of a motion, from those of their hosts.
  void expand(std::vector<double>& motion) const { dependents_.expand(nodes_, motion.data()); }

  /// Σ diag K / Σ diag M over the displacements, without tethers: the scale of the largest eigenvalues [1/s²].
  double stiffness_to_mass() const { return stiffness_ / mass_sum_; }

  /// A factor of K + s M; the smallest s that leaves every pivot some digits. Thin walls bend with eigenvalues that are
  /// 1e-12 of their membranes': s starts where rounding does. What moves freely, as a whole or in part, has no
  /// stiffness but rounding, which would amplify this motion alone.
  BlockCholesky factorize() {
    BlockCholesky factor(K_, filter_, nullptr, &pool_);
    constexpr double kLeastPivot = 16 * std::numeric_limits<double>::epsilon();
    const double step = 1e-15 * stiffness_to_mass();
    double s = free_ ? step : 0.0;
    for (int attempt = 0; attempt < 15; ++attempt) {
      BlockMatrix shifted = K_;
      for (int i = 0; i < K_.rows() && s > 0; ++i)
        for (int k = 0; k < dofs().size(i) * dofs().size(i); ++k)
          shifted.block(shifted.diagonal(i))[k] += s * mass_[dofs().block_begin(i) + at(k)];
      if (factor.factorize(shifted) && factor.smallest_pivot() > kLeastPivot) return factor;
      s = std::max(10 * s, step);
    }
    return factor;
  }

  void multiply_stiffness(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
    multiply(x, y, [this](const std::vector<double>& in, std::vector<double>& out) { K_.multiply(pool_, in, out); });
  }
  void multiply_mass(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
    multiply(x, y, [this](const std::vector<double>& in, std::vector<double>& out) {
      for (int node = 0; node < dofs().node_count(); ++node) {
        const int n = dofs().size(node), first = dofs().begin(node);
        for (int i = 0; i < n; ++i) {
          out[at(first + i)] = 0;
          for (int j = 0; j < n; ++j)
            out[at(first + i)] += mass_[dofs().block_begin(node) + at(n * i + j)] * in[at(first + j)];
        }
      }
    });
  }

 private:
  template <class Product>
  void multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y, const Product& product) const {
    std::vector<double> global(x.data(), x.data() + x.size()), out(global.size());
    filter_.to_global(global);
    product(global, out);
    filter_.to_local(out);
    filter_.clear_fixed(out);
    y = Eigen::Map<const Eigen::VectorXd>(out.data(), x.size());
  }

  const DofLayout& dofs() const { return K_.dofs(); }

  /// Σ v (λ + 2μ) |g|² over points and nodes, and Σ k over springs.
  void sum_stiffness(const PointSet& set) {
    for (const Spring& spring : set.springs) stiffness_ += spring.stiffness;
    for_each_block(set, [&](const auto& block) { stiffness_ += block.stiffness_sum(); });
  }

  ThreadPool& pool_;
  DofFilter filter_;
  NodesView nodes_;
  Dependents<PoolSpace> dependents_;  ///< at rest
  BlockMatrix K_;
  std::vector<double> mass_;  ///< blocks of the frames
  double stiffness_ = 0, mass_sum_ = 0;
  bool free_ = true;  ///< nothing is held
};

}  // namespace

namespace {

/// Stabilisation's part of the energy of a small motion along a shape; 0 of a free motion.
double stabilization_part(const Model& model, CpuExecutor& executor, const std::vector<double>& shape, double frequency,
                          double highest) {
  if (frequency == 0 || frequency < 1e-5 * highest) return 0;
  State state = State::at_rest(model);
  const DofLayout& dofs = model.points.dofs;
  double largest = 0;
  for (const double v : shape) largest = std::max(largest, std::abs(v));
  const double small = 1e-6 / largest;
  for (int i = 0; i < dofs.node_count(); ++i) {
    const double* d = shape.data() + dofs.begin(i);
    state.u[at(i)] = Vec3d{{d[0], d[1], d[2]}} * small;
    state.D[at(i)] = dofs.kind(i) == FrameKind::rigid ? rotation_increment(Vec3d{{d[3], d[4], d[5]}} * small)
                                                      : frame_variation(dofs.kind(i), d + 3, {}) * small;
  }
  place_dependents(model.points, state);
  std::vector<double> unused(shape.size());
  const InternalEnergy energy = executor.gradient(state, {}, unused);
  return energy.total() > 0 ? energy.stabilization / energy.total() : 0.0;
}

}  // namespace

Modes natural_modes(const Model& model, ThreadPool& pool, int count) {
  Problem problem(model, pool);
  const auto n = static_cast<Eigen::Index>(model.dof_count());
  const int free = problem.filter().free_count();
  if (free == 0) return {};
  const int wanted = std::min(count, free), block = std::min(free, std::max(2 * wanted, wanted + 8));
  // Free motions have eigenvalue 0 up to the rounding of the largest, of which iterations see a part. Ritz values are
  // never below the eigenvalues: one that vanishes beside rounding has settled, though its digits change for ever.
  const double rounding = 1e-17 * problem.stiffness_to_mass();
  const double zero = 10 * std::numeric_limits<double>::epsilon() * problem.stiffness_to_mass();
  const BlockCholesky factor = problem.factorize();

  std::mt19937 random(1);
  Dense X(n, block), KX(n, block), MX(n, block);
  for (Eigen::Index i = 0; i < X.size(); ++i) X.data()[i] = 2.0 * static_cast<double>(random()) / 4294967295.0 - 1.0;
  Eigen::VectorXd values = Eigen::VectorXd::Zero(block), column;
  // In exact arithmetic Ritz values never rise: one that did so again and again, by no more than rounding makes, has
  // settled as far as it can.
  constexpr int kRises = 5;
  std::vector<int> rises(at(wanted), 0);
  std::vector<double> swing(at(wanted), 0.0);
  Modes modes;
  modes.least = std::sqrt(zero) / (2 * std::numbers::pi);
  modes.converged = false;
  for (modes.iterations = 0; modes.iterations < 500 && !modes.converged; ++modes.iterations) {
    for (int k = 0; k < block; ++k) {
      problem.multiply_mass(X.col(k), column);
      factor.solve({column.data(), static_cast<std::size_t>(n)}, {X.col(k).data(), static_cast<std::size_t>(n)});
    }
    X = orthonormal(X);
    for (int k = 0; k < block; ++k) {
      problem.multiply_stiffness(X.col(k), column);
      KX.col(k) = column;
      problem.multiply_mass(X.col(k), column);
      MX.col(k) = column;
    }
    const Eigenpairs ritz = symmetric_eigen(X.transpose() * KX, X.transpose() * MX);
    const Eigen::VectorXd& next = ritz.values;
    X = X * ritz.vectors;
    modes.converged = true;
    for (int k = 0; k < wanted; ++k) {
      const double allowed = std::max({1e-10 * std::abs(next[k]), 1e-12 * std::abs(next[wanted - 1]), rounding});
      const double change = std::abs(next[k] - values[k]);
      if (modes.iterations > 0 && next[k] > values[k] && change <= zero) ++rises[at(k)];
      if (rises[at(k)] > 0) swing[at(k)] = std::max(swing[at(k)], change);
      const bool settled = next[k] <= zero || change <= allowed;
      modes.converged = modes.converged && (settled || (rises[at(k)] >= kRises && change <= zero));
    }
    values = next;
  }
  for (int k = 0; k < wanted; ++k) {
    if (values[k] > zero) {
      const double open = std::max(rounding, rises[at(k)] >= kRises ? swing[at(k)] : 0.0);
      modes.uncertainty = std::max(modes.uncertainty, open / (2 * values[k]));
    }
    modes.frequency.push_back(values[k] <= zero ? 0.0 : std::sqrt(values[k]) / (2 * std::numbers::pi));
    std::vector<double> shape(X.col(k).data(), X.col(k).data() + n);
    problem.filter().to_global(shape);
    problem.expand(shape);
    double largest = 0;
    const DofLayout& dofs = model.points.dofs;
    for (int node = 0; node < dofs.node_count(); ++node)
      for (int i = dofs.begin(node); i < dofs.begin(node) + 3; ++i)
        if (std::abs(shape[at(i)]) > std::abs(largest) * (1 + 1e-6)) largest = shape[at(i)];
    if (largest < 0)
      for (double& v : shape) v = -v;
    modes.shape.push_back(std::move(shape));
  }
  CpuExecutor executor(model.points, pool);
  for (std::size_t k = 0; k < modes.shape.size(); ++k)
    modes.stabilization.push_back(
        stabilization_part(model, executor, modes.shape[k], modes.frequency[k], modes.frequency.back()));
  return modes;
}

}  // namespace fascia
