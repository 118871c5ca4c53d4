#include "core/tangent/preconditioners.hpp"

#include "core/base/index.hpp"
#include "core/linear/vector_ranges.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace fascia {

namespace {

constexpr int kNodeChunk = 512;
/// Iterations for which a factor is made anew: each takes a product and a solve, where that takes an assembly too. With
/// 15 to 60 the steps of shells and coupled tissues took the same time within a tenth.
constexpr int kWorthAFactor = 30;

/// y = B x; returns x · y.
template <int N>
double apply_block(const double* B, const double* x, double* y) {
  double dot = 0;
  for (int i = 0; i < N; ++i) {
    double sum = 0;
    for (int j = 0; j < N; ++j) sum += B[N * i + j] * x[j];
    y[i] = sum;
    dot += x[i] * sum;
  }
  return dot;
}

}  // namespace

std::unique_ptr<Preconditioner> preconditioner_of(PreconditionerKind kind, TangentOperator& K, FactorSolver& factor) {
  switch (kind) {
    case PreconditionerKind::none:
      return std::make_unique<NoPreconditioner>(K);
    case PreconditionerKind::jacobi:
      return std::make_unique<DiagonalBlocks>(K, false);
    case PreconditionerKind::block_jacobi:
      return std::make_unique<DiagonalBlocks>(K, true);
    case PreconditionerKind::cholesky:
      return std::make_unique<OldFactor>(K, factor);
    case PreconditionerKind::automatic:
    case PreconditionerKind::multigrid:
      break;
  }
  return nullptr;
}

double NoPreconditioner::apply(std::span<const double> r, std::span<double> z) { return K_.vectors().copy(r, z); }

double NoPreconditioner::advance(const CpuVectors& vectors, double s, std::span<const double> p,
                                 std::span<const double> q, std::span<double> x, std::span<double> r,
                                 std::span<double> z) {
  return vectors.advance_and_copy(s, p, q, x, r, z);
}

bool DiagonalBlocks::prepare() {
  K_.invert_diagonal(K_.matrix(), whole_, inverse_);
  chunk_sums_.resize(at((K_.model().node_count() + kNodeChunk - 1) / kNodeChunk));
  return true;
}

/// z = M⁻¹ r; returns r · z. @param before  before(first, last) comes first, of the degrees of freedom of some nodes
template <class Before>
double DiagonalBlocks::apply_after(const Before& before, std::span<const double> r, std::span<double> z) {
  const DofLayout& dofs = K_.model().points.dofs;
  K_.pool().for_ranges(dofs.node_count(), kNodeChunk, [&](int begin, int end) {
    before(at(dofs.begin(begin)), at(dofs.begin(end)));
    double sum = 0;
    for (int node = begin; node < end; ++node) {
      const double* inverse = inverse_.data() + dofs.block_begin(node);
      const std::size_t first = at(dofs.begin(node));
      switch (dofs.size(node)) {
        case 3:
          sum += apply_block<3>(inverse, r.data() + first, z.data() + first);
          break;
        case 6:
          sum += apply_block<6>(inverse, r.data() + first, z.data() + first);
          break;
        default:
          sum += apply_block<12>(inverse, r.data() + first, z.data() + first);
      }
    }
    chunk_sums_[at(begin / kNodeChunk)] = sum;
  });
  return std::accumulate(chunk_sums_.begin(), chunk_sums_.end(), 0.0);
}

double DiagonalBlocks::apply(std::span<const double> r, std::span<double> z) {
  return apply_after([](std::size_t, std::size_t) {}, r, z);
}

double DiagonalBlocks::advance(const CpuVectors& /*vectors*/, double s, std::span<const double> p,
                               std::span<const double> q, std::span<double> x, std::span<double> r,
                               std::span<double> z) {
  const auto move = [&](std::size_t begin, std::size_t end) { advance_range(s, p, q, x, r, begin, end); };
  return apply_after(move, r, z);
}

void OldFactor::renewed() {
  ready_ = factor_.preconditions();
  first_ = more_ = 0;
}

bool OldFactor::prepare() {
  exact_ = !is_kept();
  if (!exact_) {
    factor_.renew_terms_of_preconditioner();
    return true;
  }
  const bool definite = factor_.prepare();
  renewed();
  return definite;
}

/// Terms that are not those of the factor's own tangent could make it indefinite.
double OldFactor::apply(std::span<const double> r, std::span<double> z) {
  if (exact_)
    factor_.apply_inverse(r, z);
  else
    factor_.precondition(r, z);
  return products_.take(K_.vectors().dot(r, z), [] { return false; });
}

bool OldFactor::took(int iterations) {
  if (first_ == 0)
    first_ = iterations;
  else
    more_ += std::max(0, iterations - first_);
  if (iterations > kMostIterations || more_ > kWorthAFactor) ready_ = false;
  return ready_;
}

bool LevelsOfFrames::prepare() {
  const BlockMatrix& from = material_ ? K_.material_part() : K_.matrix();
  if (!levels_) levels_.emplace(from, K_.filter(), K_.pool(), corners_ ? find_edge_ends(K_.model()) : EdgeEnds{});
  std::vector<double> inverse;
  K_.invert_diagonal(from, true, inverse);
  if (corners_) levels_->keep_rounded_entries();  // others, who know no corners, read all bits
  return levels_->build(K_.places(), std::move(inverse), [this](std::span<const double> x, std::span<double> y) {
    K_.apply_free_rounded(material_, x, y);
  });
}

double LevelsOfFrames::apply(std::span<const double> r, std::span<double> z) {
  return products_.take(levels_->precondition(r, z), [&] { return K_.vectors().dot(r, r) > 0; });
}

}  // namespace fascia
