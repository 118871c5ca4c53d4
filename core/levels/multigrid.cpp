#include "core/levels/multigrid.hpp"

#include "core/levels/galerkin.hpp"
#include "core/levels/rounded_rows.hpp"
#include "core/linear/lanczos.hpp"
#include "core/math/mat3.hpp"
#include "core/node/positive_inverse.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace fascia {

namespace {

constexpr double kStrong = 0.08;    ///< of neighbours on the finest level; half as much on each coarser one
constexpr int kFewNodes = 150;      ///< that a dense factor takes
constexpr double kLeastGain = 0.7;  ///< a level with more nodes than this part of the finer one's is not worth it
constexpr double kRatio = 20;       ///< of the eigenvalues that a smoother damps
constexpr double kSafety = 1.05;    ///< on the largest eigenvalue, which Lanczos iterations find from below
constexpr int kEigenProducts = 10;
constexpr double kIndependent = 1e-8;  ///< squared sine of the angle between a rigid motion and those before it

/// z = B r of square blocks by node, as large as they are.
template <class Size>
void apply_blocks(ThreadPool& pool, int nodes, const Size& layout, std::span<const double> blocks,
                  std::span<const double> r, std::span<double> z) {
  pool.for_ranges(nodes, 512, [&](int first, int end) {
    for (int node = first; node < end; ++node) {
      const auto [begin, n, block] = layout(node);
      const double* B = blocks.data() + block;
      for (int i = 0; i < n; ++i) {
        double sum = 0;
        for (int j = 0; j < n; ++j) sum += B[n * i + j] * r[at(begin + j)];
        z[at(begin + i)] = sum;
      }
    }
  });
}

/// A rigid motion about x_A of a node at x: columns U and Θ, rows by degrees of freedom in the axes of the world.
void rigid_motion(int size, const Vec3d& arm, const Mat3d& Q, double* T) {
  std::fill(T, T + size * kFrameDofs, 0.0);
  const auto entry = [&](int row, int column) -> double& { return T[kFrameDofs * row + column]; };
  for (int k = 0; k < 3; ++k) entry(k, k) = 1;
  for (int k = 0; k < 3; ++k) {
    Vec3d axis;
    axis[k] = 1;
    const Vec3d u = cross(axis, arm);
    for (int i = 0; i < 3; ++i) entry(i, 3 + k) = u[i];
    if (size == 6) entry(3 + k, 3 + k) = 1;
    if (size != 12) continue;
    const Mat3d dA = skew(axis) * Q;
    for (int q = 0; q < 3; ++q)
      for (int i = 0; i < 3; ++i) entry(3 + 3 * q + i, 3 + k) = dA(i, q);
  }
}

/// Bit k: the motion k is a combination of those before it. @param G  6 × 6, products of motions; becomes L of L Lᵀ
unsigned dependent_motions(std::array<double, 36>& G) {
  unsigned found = 0;
  for (int j = 0; j < kFrameDofs; ++j) {
    const double whole = G[at(7 * j)];
    double pivot = whole;
    for (int k = 0; k < j; ++k) pivot -= G[at(6 * j + k)] * G[at(6 * j + k)];
    const bool dead = !(pivot > kIndependent * whole);
    if (dead) found |= 1U << j;
    for (int i = j + 1; i < kFrameDofs; ++i) {
      double sum = G[at(6 * i + j)];
      for (int k = 0; k < j; ++k) sum -= G[at(6 * i + k)] * G[at(6 * j + k)];
      G[at(6 * i + j)] = dead ? 0 : sum / std::sqrt(pivot);
    }
  }
  return found;
}

}  // namespace

struct Multigrid::Level {
  int nodes = 0;
  std::size_t dofs = 0;
  std::size_t length = 0;  ///< of vectors: of a coarse level a little more, which stays zero
  Product product;
  std::unique_ptr<FrameMatrix> matrix;  ///< of a coarse level
  RoundedRows rounded;                  ///< this one
  std::vector<double> inverse;          ///< D⁻¹, by node
  Places places;
  BlockRows P;  ///< from the next coarser level; empty: none
  RoundedRows rounded_P;
  std::vector<unsigned> dead;  ///< of the next coarser level: motions that its aggregates do not have
  double largest = 0;          ///< eigenvalue of D⁻¹ K
  std::vector<double> b, x, r, d, z;
  std::vector<std::vector<double>> parts;  ///< of what goes to the coarser level, by chunks of nodes
  std::function<void(std::span<const double>, std::span<double>)> precondition;  ///< z = D⁻¹ r
};

struct Multigrid::Coarsest {
  Eigen::LLT<Eigen::MatrixXd> factor;
};

Multigrid::Multigrid(const BlockMatrix& matrix, const DofFilter& filter, ThreadPool& pool)
    : matrix_(matrix), filter_(filter), pool_(pool), vectors_(pool), fine_(new FineRows(matrix, filter)) {}
Multigrid::~Multigrid() = default;

double Multigrid::largest_eigenvalue_of(const Level& level) const {
  // No direction is favoured, and the same numbers come again in every run.
  std::vector<double> start(level.length), product(level.length);
  std::uint64_t state = 1;
  for (double& v : start) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    v = static_cast<double>(state >> 40U) * 0x1.0p-24 - 0.5;
  }
  level.product(start, product);  // so that nothing prescribed takes part
  LanczosOptions options;
  options.most = kEigenProducts;
  options.look = kEigenProducts;
  return kSafety * largest_ratio(
                       product, options, [&](const auto& y, auto& v) { level.precondition(y, v); },
                       [&](const auto& v, auto& w) { level.product(v, w); })
                       .value;
}

bool Multigrid::build(const Places& places, std::vector<double> inverse_blocks, const Product& product) {
  levels_.clear();
  coarsest_.reset();
  auto finest = std::make_unique<Level>();
  finest->nodes = matrix_.rows();
  finest->dofs = finest->length = at(matrix_.dofs().total());
  finest->product = product;
  finest->inverse = std::move(inverse_blocks);
  finest->places = places;
  Level* level = finest.get();
  finest->precondition = [this, level](std::span<const double> r, std::span<double> z) {
    const DofLayout& dofs = matrix_.dofs();
    apply_blocks(
        pool_, level->nodes,
        [&](int node) { return std::tuple(dofs.begin(node), dofs.size(node), dofs.block_begin(node)); }, level->inverse,
        r, z);
  };
  levels_.push_back(std::move(finest));
  if (!add_coarser(*fine_, 0)) return false;
  for (std::size_t depth = 1; depth < levels_.size(); ++depth)
    if (levels_[depth]->nodes > kFewNodes && !add_coarser(*levels_[depth]->matrix, depth)) return false;
  Level& last = *levels_.back();
  for (const auto& l : levels_)
    for (std::vector<double>* v : {&l->b, &l->x, &l->r, &l->d, &l->z}) v->assign(l->length, 0.0);
  const bool factorizes = last.matrix && last.nodes <= kFewNodes;
  if (!factorizes && last.largest == 0) last.largest = largest_eigenvalue_of(last);
  if (!factorizes) return last.largest > 0 && std::isfinite(last.largest);
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(last.dofs), static_cast<Eigen::Index>(last.dofs));
  for (int row = 0; row < last.nodes; ++row) {
    last.matrix->for_each_block(row, [&](int column, const double* B) {
      for (int i = 0; i < kFrameDofs; ++i)
        for (int j = 0; j < kFrameDofs; ++j) K(kFrameDofs * row + i, kFrameDofs * column + j) = B[kFrameDofs * i + j];
    });
    for (int k = 0; k < kFrameDofs; ++k)
      if (((last.matrix->fixed(row) >> k) & 1U) != 0) K(kFrameDofs * row + k, kFrameDofs * row + k) = 1;
  }
  coarsest_ = std::make_unique<Coarsest>();
  coarsest_->factor.compute(K);
  return coarsest_->factor.info() == Eigen::Success;
}

template <class Matrix>
bool Multigrid::add_coarser(const Matrix& matrix, std::size_t depth) {
  Level& level = *levels_[depth];
  level.largest = largest_eigenvalue_of(level);
  if (!(level.largest > 0) || !std::isfinite(level.largest)) return false;
  if (aggregates_.size() <= depth)
    aggregates_.push_back(aggregate(matrix, pool_, std::ldexp(kStrong, -static_cast<int>(depth))));
  const Aggregates& groups = aggregates_[depth];
  if (groups.count == 0 || groups.count > kLeastGain * level.nodes) {
    aggregates_.resize(depth);  // of another tangent they may be worth it
    return true;
  }

  // Centres, and rigid motions that nodes of an aggregate cannot tell apart: of one vertex, or of several on a line.
  std::vector<Vec3d> centre(at(groups.count));
  std::vector<int> members(at(groups.count), 0);
  for (int i = 0; i < level.nodes; ++i)
    if (const int g = groups.of_node[at(i)]; g >= 0) centre[at(g)] += level.places.x[at(i)], ++members[at(g)];
  for (int g = 0; g < groups.count; ++g) centre[at(g)] = centre[at(g)] * (1.0 / members[at(g)]);
  const bool fine = depth == 0;
  const auto raw = [&](int i, double* T) {
    const Mat3d Q = fine && !level.places.Q.empty() ? level.places.Q[at(i)] : Mat3d::identity();
    const int n = matrix.size(i);
    rigid_motion(n, level.places.x[at(i)] - centre[at(groups.of_node[at(i)])], Q, T);
    const DofTurn* turn = fine ? filter_.turn_of(i) : nullptr;
    for (int c = 0; c < kFrameDofs; ++c) {
      double column[kMostDofs];
      for (int a = 0; a < n; ++a) column[a] = T[kFrameDofs * a + c];
      if (turn != nullptr) turn_dofs(matrix_.dofs().kind(i), turn->translation, turn->rotation, false, column);
      for (int a = 0; a < n; ++a) T[kFrameDofs * a + c] = ((matrix.fixed(i) >> a) & 1U) != 0 ? 0.0 : column[a];
    }
  };
  std::vector<std::array<double, 36>> gram(at(groups.count));
  for (auto& G : gram) G.fill(0);
  for (int i = 0; i < level.nodes; ++i) {
    const int g = groups.of_node[at(i)];
    if (g < 0) continue;
    double T[kMostDofs * kFrameDofs];
    raw(i, T);
    for (int r = 0; r < matrix.size(i); ++r)
      for (int a = 0; a < kFrameDofs; ++a)
        for (int b = 0; b < kFrameDofs; ++b) gram[at(g)][at(6 * a + b)] += T[6 * r + a] * T[6 * r + b];
  }
  level.dead.assign(at(groups.count), 0U);
  for (int g = 0; g < groups.count; ++g) level.dead[at(g)] = dependent_motions(gram[at(g)]);
  const auto tentative = [&](int i, double* T) {
    raw(i, T);
    const unsigned dead = level.dead[at(groups.of_node[at(i)])];
    for (int c = 0; c < kFrameDofs; ++c)
      if (((dead >> c) & 1U) != 0)
        for (int a = 0; a < matrix.size(i); ++a) T[kFrameDofs * a + c] = 0;
  };
  const auto inverse = [&](int i) {
    return level.inverse.data() + (fine ? matrix_.dofs().block_begin(i) : at(36 * i));
  };
  level.P = galerkin::smoothed(matrix, pool_, groups, 4 / (3 * level.largest), tentative, inverse);
  level.rounded_P = RoundedRows(level.P);
  auto next = std::make_unique<Level>();
  next->nodes = groups.count;
  next->dofs = at(kFrameDofs * groups.count);
  next->length = next->dofs + RoundedRows::kBeyond;
  next->places.x = std::move(centre);
  next->matrix = std::make_unique<FrameMatrix>(galerkin::product(matrix, level.P, pool_, groups.count), level.dead);
  next->inverse.assign(at(36 * groups.count), 0.0);
  pool_.for_ranges(groups.count, 64, [&](int first, int end) {
    for (int row = first; row < end; ++row)
      next->matrix->for_each_block(row, [&](int column, const double* B) {
        if (column != row) return;
        double* D = next->inverse.data() + at(36 * row);
        std::copy(B, B + 36, D);
        for (int k = 0; k < kFrameDofs; ++k)
          if (((level.dead[at(row)] >> k) & 1U) != 0) D[7 * k] = 1;
        positive_inverse(D, kFrameDofs);
      });
  });
  Level* made = next.get();
  next->rounded = RoundedRows(next->matrix->blocks());
  next->product = [this, made](std::span<const double> x, std::span<double> y) {
    pool_.for_ranges(made->nodes, 64, [&](int first, int end) {
      for (int row = first; row < end; ++row) {
        double* sum = y.data() + kFrameDofs * row;
        std::fill_n(sum, kFrameDofs, 0.0);
        made->rounded.add_product(made->matrix->blocks(), row, kFrameDofs, x.data(), sum);
      }
    });
  };
  next->precondition = [this, made](std::span<const double> r, std::span<double> z) {
    apply_blocks(
        pool_, made->nodes, [](int node) { return std::tuple(kFrameDofs * node, kFrameDofs, at(36 * node)); },
        made->inverse, r, z);
  };
  levels_.push_back(std::move(next));
  return true;
}

Smoothing Smoothing::up_to(double largest) {
  const double low = largest / kRatio, middle = 0.5 * (largest + low), half = 0.5 * (largest - low);
  const double sigma = middle / half, first = 1 / sigma, second = 1 / (2 * sigma - first);
  return {1 / middle, second * first, 2 * second / half};
}

/// r holds b − K x before, and no longer after.
void Multigrid::smooth(Level& level, bool from_zero) {
  const Smoothing by = Smoothing::up_to(level.largest);
  std::vector<double>&r = level.r, &d = level.d, &z = level.z, &x = level.x;
  level.precondition(r, d);
  vectors_.scale(by.first, d);
  if (from_zero)
    std::copy(d.begin(), d.end(), x.begin());
  else
    vectors_.add(1, d, x);
  level.product(d, z);
  vectors_.add(-1, z, r);
  level.precondition(r, z);
  vectors_.scale(by.again, d);
  vectors_.add(by.next, z, d);
  vectors_.add(1, d, x);
}

/// x ← M⁻¹ b of a level.
void Multigrid::cycle(std::size_t depth) {
  Level& level = *levels_[depth];
  const bool last = depth + 1 == levels_.size();
  if (last && coarsest_) {
    const auto n = static_cast<Eigen::Index>(level.dofs);
    Eigen::Map<const Eigen::VectorXd> b(level.b.data(), n);
    Eigen::Map<Eigen::VectorXd> x(level.x.data(), n);
    x = coarsest_->factor.solve(b);
    return;
  }
  level.r = level.b;
  smooth(level, true);
  const auto renew_residual = [&] {
    level.product(level.x, level.r);
    vectors_.xpay(level.b, -1, level.r);
  };
  renew_residual();
  if (!last) {
    Level& next = *levels_[depth + 1];
    const auto rows = [&](int i) {
      return depth == 0 ? std::pair(matrix_.dofs().begin(i), matrix_.dofs().size(i))
                        : std::pair(kFrameDofs * i, kFrameDofs);
    };
    // Chunks add to parts of their own, which are then added in order.
    const int chunks = std::clamp(level.nodes / 2048, 1, 16);
    std::vector<std::vector<double>>& part = level.parts;
    part.resize(at(chunks));
    const auto edge = [&](int c) { return static_cast<int>(static_cast<std::int64_t>(level.nodes) * c / chunks); };
    pool_.for_chunks(chunks, [&](int c) {
      part[at(c)].assign(next.length, 0.0);
      for (int i = edge(c); i < edge(c + 1); ++i) {
        const auto [begin, n] = rows(i);
        level.rounded_P.add_transposed_product(level.P, i, n, level.r.data() + begin, part[at(c)].data());
      }
    });
    std::copy(part[0].begin(), part[0].end(), next.b.begin());
    for (int c = 1; c < chunks; ++c) vectors_.add(1, part[at(c)], next.b);
    cycle(depth + 1);
    pool_.for_ranges(level.nodes, 256, [&](int first, int end) {
      for (int i = first; i < end; ++i) {
        const auto [begin, n] = rows(i);
        level.rounded_P.add_product(level.P, i, n, next.x.data(), level.x.data() + begin);
      }
    });
    renew_residual();
  }
  smooth(level, false);
}

double Multigrid::precondition(std::span<const double> r, std::span<double> z) {
  Level& finest = *levels_.front();
  finest.b.assign(r.begin(), r.end());
  cycle(0);
  std::copy(finest.x.begin(), finest.x.end(), z.begin());
  return vectors_.dot(r, z);
}

Multigrid::LevelView Multigrid::level(std::size_t depth) const {
  const Level& l = *levels_[depth];
  return {l.nodes,
          l.places.x,
          l.largest,
          l.inverse,
          l.matrix ? &l.matrix->blocks() : nullptr,
          depth == 0 ? fine_.get() : nullptr,
          l.P.rows() > 0 ? &l.P : nullptr};
}

std::vector<double> Multigrid::coarsest_inverse() const {
  if (!coarsest_) return {};
  const auto n = static_cast<Eigen::Index>(levels_.back()->dofs);
  std::vector<double> inverse(levels_.back()->dofs * levels_.back()->dofs);
  Eigen::Map<Eigen::MatrixXd>(inverse.data(), n, n) = coarsest_->factor.solve(Eigen::MatrixXd::Identity(n, n));
  return inverse;
}

std::vector<int> Multigrid::level_sizes() const {
  std::vector<int> sizes;
  for (const auto& level : levels_) sizes.push_back(level->nodes);
  return sizes;
}

std::size_t Multigrid::value_count() const {
  std::size_t count = 0;
  for (const auto& level : levels_) count += level->P.values.size() + level->inverse.size();
  return count;
}

}  // namespace fascia
