#include "core/tangent/whole_tangent.hpp"

#include "core/base/index.hpp"
#include "core/linear/gmres.hpp"
#include "core/math/dense.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {

namespace {

using Vector = CpuVectors::Vector;

constexpr int kMostIterativeSolves = 50;
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

LinearReport solve_whole(TangentOperator& K, LinearSolver& inner, bool limit_ends, std::span<const double> b,
                         std::span<double> x, double tolerance) {
  LinearReport report;
  const auto precondition = [&](const Vector& r, Vector& z) {
    if (inner.spent()) return false;
    const LinearReport once = inner.solve(r, z, kInnerTolerance);
    report.iterations += once.iterations;
    report.seconds += once.seconds;
    report.negative = std::max(report.negative, once.negative);
    if (!once.trouble.empty()) report.negative = std::max(report.negative, 1);
    if (!inner.iterates()) return once.usable;
    return once.usable && once.trouble.empty() && !(once.unsolved && limit_ends && !inner.spent());
  };
  GmresOptions options;
  options.tolerance = tolerance;
  if (inner.iterates()) options.max_iterations = kMostIterativeSolves;
  Vector found;
  const GmresReport gmres = gmres_by_length(
      K.vectors(), K.lengths(), [&](const Vector& z, Vector& w) { K.apply_whole(z, w); }, precondition, b, found,
      options);
  std::copy(found.begin(), found.end(), x.begin());
  report.unsolved = !gmres.converged;
  report.residual = gmres.relative_residual;
  report.usable = gmres.converged || gmres.relative_residual <= kUsefulResidual ||
                  (inner.spent() && gmres.iterations > 0);  // as far as time went
  return report;
}

SoftestDirection softest_of_whole(TangentOperator& K, LinearSolver& inner, bool definite) {
  const CpuVectors& vectors = K.vectors();
  const std::vector<double> weights = motion_weights(K.model(), K.filter());
  const auto dot = [&](const Vector& a, const Vector& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += weights[i] * a[i] * b[i];
    return sum;
  };
  std::vector<Vector> v{smooth_motion(K.model())};
  for (std::size_t i = 0; i < v[0].size(); ++i)
    if (weights[i] == 0) v[0][i] = 0;
  vectors.scale(1 / std::sqrt(dot(v[0], v[0])), v[0]);
  const int most = std::min(kEigenDirections, K.free_count());
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(most + 1, most);
  SoftestDirection out;
  Vector w(v[0].size()), b(w.size());
  for (int count = 1;; ++count) {
    for (std::size_t i = 0; i < b.size(); ++i) b[i] = weights[i] * v.back()[i];
    if (!solve_whole(K, inner, false, b, w, kEigenTolerance).usable) return {};
    const double size = std::sqrt(dot(w, w));
    for (int twice = 0; twice < 2; ++twice)
      for (int i = 0; i < count; ++i) {
        const double part = dot(v[at(i)], w);
        H(i, count - 1) += part;
        vectors.add(-part, v[at(i)], w);
      }
    const double next = H(count, count - 1) = std::sqrt(dot(w, w));
    const bool last = count == most || !(next > 1e-10 * size);
    if (last || (definite && count >= kFirstLook)) {
      const RitzValues found(H, count);
      if (last || found.knows_softest()) {
        out.probe = {true, definite ? 0 : found.real_negative()};
        out.stiffness = found.softest();
        out.direction = vectors.zeros(w.size());
        for (int k = 0; k < count; ++k) vectors.add(found.share_of_softest(k), v[at(k)], out.direction);
        return out;
      }
    }
    v.push_back(w);
    vectors.scale(1 / next, v.back());
  }
}

}  // namespace fascia
