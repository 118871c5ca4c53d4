#include "core/levels/multigrid.hpp"

#include "core/levels/galerkin.hpp"
#include "core/levels/rigid_motions.hpp"
#include "core/levels/rounded_rows.hpp"
#include "core/levels/vertex_rows.hpp"
#include "core/linear/lanczos.hpp"
#include "core/math/mat3.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace fascia {

namespace {

constexpr double kStrong = 0.08;  ///< of neighbours where aggregates begin; half as much on each coarser level
constexpr int kFewNodes = 150;    ///< that a dense factor takes
constexpr int kVertexDofs = 3;
constexpr double kManyMiddles = 0.5;  ///< of the nodes lie in the middle of edges where a level of corners is worth it
constexpr double kLeastGain = 0.7;    ///< a level with more nodes than this part of the finer one's is not worth it
constexpr double kRatio = 20;         ///< of the eigenvalues that a smoother damps
constexpr double kSafety = 1.05;      ///< on the largest eigenvalue, which Lanczos iterations find from below
constexpr int kEigenProducts = 10;

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

}  // namespace

struct Multigrid::Level {
  int nodes = 0;
  int size = 0;  ///< degrees of freedom of a node; 0: as the layout says
  std::size_t dofs = 0;
  std::size_t length = 0;  ///< of vectors: of a coarse level a little more, which stays zero
  Product product;
  std::unique_ptr<VertexRows> vertices;  ///< of the level of corners
  std::unique_ptr<FrameMatrix> matrix;   ///< of a coarser one
  RoundedRows rounded;                   ///< this one
  std::vector<double> inverse;           ///< D⁻¹, by node
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

Multigrid::Multigrid(const BlockMatrix& matrix, const DofFilter& filter, ThreadPool& pool, const EdgeEnds& ends)
    : matrix_(matrix), filter_(filter), pool_(pool), vectors_(pool), fine_(new FineRows(matrix, filter)) {
  const auto middles = std::count_if(ends.begin(), ends.end(), [](const auto& e) { return e[0] >= 0; });
  const bool vertices = matrix.dofs().total() == kVertexDofs * matrix.rows();
  if (vertices && static_cast<double>(middles) >= kManyMiddles * matrix.rows())
    corners_ = std::make_unique<Corners>(ends, filter);
}
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
  if (corners_ ? !add_corners() : !add_coarser(*fine_, 0)) return false;
  for (std::size_t depth = corners_ ? 2 : 1; depth < levels_.size(); ++depth)
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

/// The level of corners, and the first of frames.
bool Multigrid::add_corners() {
  Level& fine = *levels_.front();
  fine.largest = largest_eigenvalue_of(fine);
  if (!(fine.largest > 0) || !std::isfinite(fine.largest)) return false;
  auto next = std::make_unique<Level>();
  next->nodes = corners_->count();
  next->size = kVertexDofs;
  next->dofs = next->length = at(kVertexDofs * next->nodes);
  next->places.x.reserve(at(next->nodes));
  for (const int node : corners_->origin()) next->places.x.push_back(fine.places.x[at(node)]);
  next->vertices = std::make_unique<VertexRows>(*fine_, *corners_, pool_);
  next->inverse = galerkin::inverse_diagonal(*next->vertices, pool_);
  Level* made = next.get();
  next->product = [this, made](std::span<const double> x, std::span<double> y) {
    made->vertices->multiply_rounded(pool_, x, y);
  };
  next->precondition = [this, made](std::span<const double> r, std::span<double> z) {
    apply_blocks(
        pool_, made->nodes,
        [](int node) { return std::tuple(VertexRows::begin(node), kVertexDofs, VertexRows::block_begin(node)); },
        made->inverse, r, z);
  };
  levels_.push_back(std::move(next));
  return add_coarser(*made->vertices, 1);
}

template <class Matrix>
bool Multigrid::add_coarser(const Matrix& matrix, std::size_t depth) {
  Level& level = *levels_[depth];
  level.largest = largest_eigenvalue_of(level);
  if (!(level.largest > 0) || !std::isfinite(level.largest)) return false;
  const std::size_t coarsening = depth - (corners_ ? 1 : 0);
  if (aggregates_.size() <= coarsening)
    aggregates_.push_back(aggregate(matrix, pool_, std::ldexp(kStrong, -static_cast<int>(coarsening))));
  const Aggregates& groups = aggregates_[coarsening];
  if (groups.count == 0 || groups.count > kLeastGain * level.nodes) {
    aggregates_.resize(coarsening);  // of another tangent they may be worth it
    return true;
  }

  // Centres, and rigid motions that nodes of an aggregate cannot tell apart: of one vertex, or of several on a line.
  std::vector<Vec3d> centre(at(groups.count));
  std::vector<int> members(at(groups.count), 0);
  for (int i = 0; i < level.nodes; ++i)
    if (const int g = groups.of_node[at(i)]; g >= 0) centre[at(g)] += level.places.x[at(i)], ++members[at(g)];
  for (int g = 0; g < groups.count; ++g) centre[at(g)] = centre[at(g)] * (1.0 / members[at(g)]);
  const auto raw = [&](int i, double* T) {
    const Mat3d Q = level.places.Q.empty() ? Mat3d::identity() : level.places.Q[at(i)];
    const int n = matrix.size(i);
    rigid_motion(n, level.places.x[at(i)] - centre[at(groups.of_node[at(i)])], Q, T);
    const int own = level.matrix ? -1 : level.vertices ? corners_->origin()[at(i)] : i;  // a node of the model
    const DofTurn* turn = own >= 0 ? filter_.turn_of(own) : nullptr;
    for (int c = 0; c < kFrameDofs; ++c) {
      double column[kMostDofs];
      for (int a = 0; a < n; ++a) column[a] = T[kFrameDofs * a + c];
      if (turn != nullptr) turn_dofs(matrix_.dofs().kind(own), turn->translation, turn->rotation, false, column);
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
  const auto inverse = [&](int i) { return level.inverse.data() + matrix.block_begin(i); };
  level.P = galerkin::smoothed(matrix, pool_, groups, 4 / (3 * level.largest), tentative, inverse);
  auto next = std::make_unique<Level>();
  next->nodes = groups.count;
  next->size = kFrameDofs;
  next->dofs = at(kFrameDofs * groups.count);
  next->length = next->dofs + RoundedRows::kBeyond;
  next->places.x = std::move(centre);
  next->matrix = std::make_unique<FrameMatrix>(galerkin::product(matrix, level.P, pool_, groups.count), level.dead);
  level.rounded_P = RoundedRows(level.P);                       // not before that product, which takes the most memory
  if (!keeps_exact_) level.P.values = AlignedVector<double>();  // {} would keep the memory
  next->inverse = galerkin::inverse_diagonal(*next->matrix, pool_);
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

/// x += P M⁻¹ Pᵀ r of a level.
void Multigrid::correct(std::size_t depth) {
  Level& level = *levels_[depth];
  Level& next = *levels_[depth + 1];
  const auto rows = [&](int i) {
    return level.size == 0 ? std::pair(matrix_.dofs().begin(i), matrix_.dofs().size(i))
                           : std::pair(level.size * i, level.size);
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
  if (!last && corners_ && depth == 0) {
    Level& next = *levels_[1];
    corners_->restrict_to(*fine_, pool_, level.r, next.b);
    cycle(1);
    corners_->add_prolonged(*fine_, pool_, next.x, level.x);
    renew_residual();
  } else if (!last) {
    const std::size_t finest = corners_ ? 1 : 0;  // of those that aggregates join
    for (int k = 0; k < corrections(depth - finest, levels_.size() - finest); ++k) {
      correct(depth);
      renew_residual();
    }
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
          l.P.values.empty() ? nullptr : &l.P};
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
  for (const auto& level : levels_)
    count += level->P.values.size() + level->inverse.size() + (level->vertices ? level->vertices->value_count() : 0);
  return count;
}

}  // namespace fascia
