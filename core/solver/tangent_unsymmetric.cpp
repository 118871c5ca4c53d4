#include "core/base/index.hpp"
#include "core/linear/gmres.hpp"
#include "core/math/dense.hpp"
#include "core/solver/tangent_solver.hpp"

#include <algorithm>
#include <cmath>

/// The parts of TangentSolver for tangents of loads that have no potential, which are unsymmetric. The matrix holds the
/// symmetric part; its factor, or conjugate gradients with it, precondition GMRES with the whole. What is left out of
/// it acts on free edges and at points, so that few directions are new.
namespace fascia {

namespace {

using Vector = CpuVectors::Vector;

constexpr int kMostSolvesOfCg = 50;
constexpr int kEigenDirections = 24;
constexpr int kFirstLook = 4;             ///< at the softest one alone
constexpr double kEigenTolerance = 1e-5;  ///< of solves for eigenvalues
constexpr double kFound = 0.05;           ///< residual of an eigenvalue that counts, over its size

/// Eigenvalues μ of the first rows and columns of Arnoldi's Hessenberg matrix: about 1/λ.
class RitzValues {
 public:
  RitzValues(const Eigen::MatrixXd& H, int count)
      : pairs_(general_eigen(H.topLeftCorner(count, count))), last_(count - 1), next_(std::abs(H(count, count - 1))) {
    for (Eigen::Index k = 1; k < pairs_.values.size(); ++k)
      if (std::abs(pairs_.values[k]) > std::abs(pairs_.values[softest_])) softest_ = k;
  }
  bool knows_softest() const { return is_known(softest_); }
  int real_negative() const {
    int count = 0;
    for (Eigen::Index k = 0; k < pairs_.values.size(); ++k) count += is_real_negative(k) && is_known(k) ? 1 : 0;
    return count;
  }
  /// λ next to zero where it is real and negative, else its size.
  double softest() const { return (is_real_negative(softest_) ? -1 : 1) / std::abs(pairs_.values[softest_]); }
  /// Real part of the direction k in the eigenvector.
  double share_of_softest(int k) const { return pairs_.vectors(k, softest_).real(); }

 private:
  bool is_real_negative(Eigen::Index k) const { return pairs_.values[k].imag() == 0 && pairs_.values[k].real() < 0; }
  bool is_known(Eigen::Index k) const {
    return next_ * std::abs(pairs_.vectors(last_, k)) <= kFound * std::abs(pairs_.values[k]);
  }

  ComplexEigenpairs pairs_;
  Eigen::Index last_, softest_ = 0;
  double next_;
};

}  // namespace

/// Ax = K x with all that K has, in constraint axes; of held degrees of freedom too.
void TangentSolver::apply_unsymmetric(const Linearization& lin, std::span<const double> x, std::span<double> Ax) {
  work_.assign(x.begin(), x.end());
  filter_.to_global(work_);
  dependents_.expand(work_);
  executor_.multiply(lin, work_, Ax);
  add_unsymmetric_product(lin, model_.points.dofs, work_, Ax);
  dependents_.transfer(Ax);
  filter_.to_local(Ax);
}

/// A factor of the symmetric part, indefinite or not. False where a pivot vanishes.
bool TangentSolver::factorize_symmetric_part() {
  shifted_ = false;
  solving_ = &factor();
  definite_ = solving_->factorize(matrix()) || definite_with_low_rank();
  if (definite_) return true;
  if (!factorize_any()) return false;
  solving_ = &*indefinite_;
  return true;
}

/// GMRES for K x = b on the free degrees of freedom, from the matrix and solving_, or conjugate gradients.
/// @param report  takes iterations of conjugate gradients; null: solving_ is a factor
bool TangentSolver::solve_whole(const Linearization& lin, std::span<const double> b, std::span<double> x,
                                double tolerance, TangentReport* report) {
  if (length_.empty()) length_ = motion_lengths(model_, filter_);
  const auto precondition = [&](const Vector& r, Vector& z) {
    if (report == nullptr) {
      solve_with_factor(r, z);
      return true;
    }
    CgOptions options = settings_.cg;
    options.tolerance = std::max(options.tolerance, kInnerTolerance);
    const TangentReport inner = solve_cg(r, z, options);
    report->iterations += inner.iterations;
    report->cg_seconds += inner.cg_seconds;
    report->indefinite = report->indefinite || !inner.trouble.empty();
    const bool gives_way = inner.unsolved && settings_.linear == LinearMethod::automatic;
    return inner.usable && inner.trouble.empty() && !gives_way;
  };
  Vector found;
  GmresOptions options;
  options.tolerance = tolerance;
  if (report != nullptr) options.max_iterations = kMostSolvesOfCg;
  const GmresReport gmres = gmres_by_length(
      vectors_, length_, [&](const Vector& z, Vector& w) { apply_unsymmetric(lin, z, w); }, precondition, b, found,
      options);
  if (report != nullptr) {
    report->residual = gmres.relative_residual;
    report->unsolved = !gmres.converged;
  }
  std::copy(found.begin(), found.end(), x.begin());
  return gmres.converged || gmres.relative_residual <= kUsefulResidual;
}

/// None where the symmetric part has no factor, or too much is left. Where conjugate gradients meet negative curvature
/// or their limit a factor takes over, if they were only a guess; else the material part alone, which is definite,
/// preconditions.
std::optional<TangentReport> TangentSolver::solve_unsymmetric(const Linearization& lin,
                                                              std::span<const double> prescribed,
                                                              std::span<const double> b, std::span<double> x,
                                                              const Relinearize& relinearize) {
  rhs_.assign(b.begin(), b.end());
  if (!prescribed.empty()) {
    solution_.resize(b.size());
    apply_unsymmetric(lin, prescribed, solution_);
    for (std::size_t i = 0; i < b.size(); ++i) rhs_[i] -= solution_[i];
  }
  filter_.clear_fixed(rhs_);
  TangentReport report;
  if (!direct()) {
    if (solve_whole(lin, rhs_, x, settings_.cg.tolerance, &report)) return report;
    if (settings_.linear != LinearMethod::automatic || !factor_fits()) {
      assemble(relinearize(TamerTangent::material), matrix());
      if (solve_whole(lin, rhs_, x, settings_.cg.tolerance, &report)) return report;
      return std::nullopt;
    }
    direct_ = true;
    report.unsolved = false;
    report.residual = 0;
  }
  if (!factorize_symmetric_part() || !solve_whole(lin, rhs_, x, kDirectTolerance, nullptr)) return std::nullopt;
  report.indefinite = !definite_;
  return report;
}

/// Arnoldi's method for K⁻¹ W from a smooth random motion finds the eigenvalues of K x = λ W x next to zero. A real
/// negative one is a direction in which the body leaves the equilibrium without swinging (divergence). Of complex ones,
/// and so of flutter, nothing is said: that takes the masses.
/// @param definite  the symmetric part is: no real part of an eigenvalue is negative, and the softest alone is looked
/// for
SoftestDirection TangentSolver::softest_unsymmetric(const Linearization& lin, bool definite) {
  const std::vector<double> weights = motion_weights(model_, filter_);
  const auto dot = [&](const Vector& a, const Vector& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += weights[i] * a[i] * b[i];
    return sum;
  };
  std::vector<Vector> v{smooth_motion(model_)};
  for (std::size_t i = 0; i < v[0].size(); ++i)
    if (weights[i] == 0) v[0][i] = 0;
  vectors_.scale(1 / std::sqrt(dot(v[0], v[0])), v[0]);
  const int most = std::min(kEigenDirections, filter_.free_count());
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(most + 1, most);
  SoftestDirection out;
  Vector w(v[0].size()), b(w.size());
  for (int count = 1;; ++count) {
    for (std::size_t i = 0; i < b.size(); ++i) b[i] = weights[i] * v.back()[i];
    if (!solve_whole(lin, b, w, kEigenTolerance, nullptr)) return {};
    const double size = std::sqrt(dot(w, w));
    for (int twice = 0; twice < 2; ++twice)
      for (int i = 0; i < count; ++i) {
        const double part = dot(v[at(i)], w);
        H(i, count - 1) += part;
        vectors_.add(-part, v[at(i)], w);
      }
    const double next = H(count, count - 1) = std::sqrt(dot(w, w));
    const bool last = count == most || !(next > 1e-10 * size);
    if (last || (definite && count >= kFirstLook)) {
      const RitzValues found(H, count);
      if (last || found.knows_softest()) {
        out.probe = {true, definite ? 0 : found.real_negative()};
        out.stiffness = found.softest();
        out.direction = vectors_.zeros(w.size());
        for (int k = 0; k < count; ++k) vectors_.add(found.share_of_softest(k), v[at(k)], out.direction);
        return out;
      }
    }
    v.push_back(w);
    vectors_.scale(1 / next, v.back());
  }
}

}  // namespace fascia
