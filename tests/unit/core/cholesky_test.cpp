// Factors against dense ones of the same matrix, whatever its nodes are and wherever they are held; the same bits by
// any number of threads; what is no factor is told.
#include "core/linear/cholesky.hpp"
#include "tests/support/tangent_at_rest.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

namespace {

std::atomic<int> allocations_left{-1};  ///< below 0: as many as there is memory for

void* allocated(std::size_t size, std::size_t alignment) {
  if (allocations_left >= 0 && allocations_left-- == 0) throw std::bad_alloc();
  void* memory = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t size) { return allocated(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocated(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  try {
    return operator new(size);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace fascia::cholesky_test {
namespace {

using namespace fascia::test;

struct Case {
  std::string name;
  TangentAtRest tangent;
  Case(std::string text, Model model) : name(std::move(text)), tangent(std::move(model), 2) {}
};

BlockOptions grid(int nx, int ny, int nz) {
  BlockOptions o;
  o.grid = {nx, ny, nz};
  return o;
}

Model held(Model model) {
  hold_face(model);
  return model;
}

/// Free degrees of freedom of a matrix in constraint axes.
struct Dense {
  std::vector<std::size_t> free;
  Eigen::MatrixXd matrix;

  explicit Dense(const TangentAtRest& t, const BlockMatrix& of) {
    for (std::size_t i = 0; i < t.filter.size(); ++i)
      if (!t.filter.is_fixed(i)) free.push_back(i);
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(t.model.dof_count(), t.model.dof_count());
    const DofLayout& dofs = of.dofs();
    for (int i = 0; i < of.rows(); ++i)
      for (int k = of.diagonal(i); k < of.row_begin(i + 1); ++k) {
        const int j = of.columns(i)[at(k - of.row_begin(i))];
        double block[kMostDofs * kMostDofs];
        t.filter.rotate_block(i, j, of.block(k), block);
        for (int a = 0; a < dofs.size(i); ++a)
          for (int b = 0; b < dofs.size(j); ++b)
            all(dofs.begin(i) + a, dofs.begin(j) + b) = all(dofs.begin(j) + b, dofs.begin(i) + a) =
                block[a * dofs.size(j) + b];
      }
    const auto n = static_cast<Eigen::Index>(free.size());
    matrix.resize(n, n);
    for (Eigen::Index a = 0; a < n; ++a)
      for (Eigen::Index b = 0; b < n; ++b)
        matrix(a, b) = all(static_cast<Eigen::Index>(free[static_cast<std::size_t>(a)]),
                           static_cast<Eigen::Index>(free[static_cast<std::size_t>(b)]));
  }
};

std::vector<double> right_side(std::size_t size) {
  std::vector<double> b(size);
  for (std::size_t i = 0; i < size; ++i) b[i] = static_cast<double>(i % 7) - 3;
  return b;
}

/// |K x − b| / |b| of the free ones
double residual(const Dense& dense, const std::vector<double>& x, const std::vector<double>& b) {
  Eigen::VectorXd free_x(dense.matrix.rows()), free_b(dense.matrix.rows());
  for (Eigen::Index k = 0; k < dense.matrix.rows(); ++k) {
    free_x[k] = x[dense.free[static_cast<std::size_t>(k)]];
    free_b[k] = b[dense.free[static_cast<std::size_t>(k)]];
  }
  return (dense.matrix * free_x - free_b).norm() / free_b.norm();
}

/// One rotation of each node on the face is held, about an axis of its own.
Model turning(Model model) {
  hold_face(model, 3, 1);
  return model;
}

/// The last node pushes where it pulled.
BlockMatrix indefinite(const BlockMatrix& matrix) {
  BlockMatrix out = matrix;
  const int last = matrix.rows() - 1, n = matrix.dofs().size(last);
  double* block = out.block(out.diagonal(last));
  for (int k = 0; k < n * n; ++k) block[k] *= -1;
  return out;
}

TEST(Cholesky, SolvesWhatTheMatrixMultiplied) {
  BlockOptions affine = grid(3, 3, 2);
  affine.affine = true;
  std::vector<std::unique_ptr<Case>> cases;
  const auto add = [&](const std::string& name, Model model) {
    cases.push_back(std::make_unique<Case>(name, std::move(model)));
  };
  add("a few vertices", held(vertex_block(grid(2, 2, 2))));
  add("vertices", held(vertex_block(grid(9, 5, 5))));
  add("frames", held(build({block_spec(grid(5, 4, 4))}).model));
  add("frames that turn about axes of their own", turning(build({block_spec(grid(5, 4, 3))}).model));
  add("affine frames", held(build({block_spec(affine)}).model));
  add("affine frames that turn", turning(build({block_spec(affine)}).model));
  GridSpec far = block_spec(grid(3, 3, 3));
  far.translation = {{0, 5, 0}};
  add("two blocks apart", held(build({block_spec(grid(4, 3, 3)), far}).model));
  add("a row", held(build({block_spec(grid(30, 2, 2))}).model));
  for (const auto& c : cases) {
    TangentAtRest& t = c->tangent;
    const std::vector<double> b = right_side(at(t.model.dof_count()));
    std::vector<double> x(b.size(), 7.0);
    for (const bool turned : {false, true}) {
      const BlockMatrix matrix = turned ? indefinite(t.matrix) : t.matrix;
      const Dense dense(t, matrix);
      BlockCholesky factor(t.matrix, t.filter, nullptr, &t.pool);
      if (t.filter.free_count() == 0) continue;
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(dense.matrix, Eigen::EigenvaluesOnly);
      const auto negative = static_cast<int>((eigen.eigenvalues().array() < 0).count());
      ASSERT_EQ(negative > 0, turned) << c->name;
      EXPECT_EQ(factor.factorize(matrix), !turned) << c->name;
      for (const Pivots pivots : {Pivots::positive, Pivots::any}) {
        if (turned && pivots == Pivots::positive) continue;
        ASSERT_TRUE(factor.factorize(matrix, pivots)) << c->name;
        EXPECT_EQ(factor.negative_pivots(), negative) << c->name;
        factor.solve(b, x);
        EXPECT_LT(residual(dense, x, b), 1e-11) << c->name;
        for (std::size_t i = 0; i < x.size(); ++i) EXPECT_TRUE(x[i] == 0 || !t.filter.is_fixed(i)) << c->name;
        std::vector<double> rough(b.size());
        factor.precondition(b, rough);
        EXPECT_LT(residual(dense, rough, b), 1e-2) << c->name;
      }
    }
  }
}

/// K + s · diag of another matrix.
TEST(Cholesky, ShiftsByTheDiagonalOfAnother) {
  TangentAtRest t(turning(build({block_spec(grid(4, 3, 3))}).model), 1);
  const BlockMatrix matrix = indefinite(t.matrix);
  BlockCholesky factor(t.matrix, t.filter);
  EXPECT_FALSE(factor.factorize(matrix));
  constexpr double kShift = 4;
  ASSERT_TRUE(factor.factorize(matrix, Pivots::positive, kShift, &t.matrix));
  Dense dense(t, matrix);
  const Dense from(t, t.matrix);
  dense.matrix.diagonal() += kShift * from.matrix.diagonal();
  const std::vector<double> b = right_side(at(t.model.dof_count()));
  std::vector<double> x(b.size());
  factor.solve(b, x);
  EXPECT_LT(residual(dense, x, b), 1e-12);
}

/// Large enough for subtrees, panels and parts of their rows; also of a factor that the same object made before.
TEST(Cholesky, MakesTheSameBitsByAnyNumberOfThreads) {
  TangentAtRest t(turning(build({block_spec(grid(9, 9, 8))}).model), 1);
  const BlockMatrix turned = indefinite(t.matrix);
  const EliminationOrder order = EliminationOrder::of(t.matrix, t.filter);
  ASSERT_GT(order.flops, 7 * 1.5e7) << "seven threads have enough to do";
  std::vector<double> b = right_side(at(t.model.dof_count())), x(b.size());
  t.filter.clear_fixed(b);
  std::vector<double> alone;
  for (const int threads : {1, 2, 3, 7}) {
    ThreadPool pool(threads);
    BlockCholesky factor(t.matrix, t.filter, &order, &pool);
    std::vector<double> all;
    for (const Pivots pivots : {Pivots::any, Pivots::positive, Pivots::any}) {
      const BlockMatrix& matrix = pivots == Pivots::any ? turned : t.matrix;
      ASSERT_TRUE(factor.factorize(matrix, pivots));
      EXPECT_EQ(factor.negative_pivots() > 0, pivots == Pivots::any);
      factor.solve(b, x);
      all.insert(all.end(), x.begin(), x.end());
      if (pivots == Pivots::any) continue;
      std::vector<double> product(b.size());
      t.multiply(x, product);
      double squared = 0, whole = 0;
      for (std::size_t i = 0; i < b.size(); ++i) {
        squared += (product[i] - b[i]) * (product[i] - b[i]);
        whole += b[i] * b[i];
      }
      EXPECT_LT(std::sqrt(squared / whole), 1e-12);
    }
    if (threads == 1) alone = all;
    EXPECT_EQ(all, alone) << threads;
  }
}

TEST(Cholesky, TellsWhatHasNoFactor) {
  for (const int threads : {1, 3}) {
    TangentAtRest t(held(build({block_spec(grid(7, 7, 7))}).model), threads);
    BlockCholesky factor(t.matrix, t.filter, nullptr, &t.pool);
    BlockMatrix broken = t.matrix;
    const int last = broken.rows() - 1;
    for (const double number : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
      broken.block(broken.diagonal(last))[0] = number;
      EXPECT_FALSE(factor.factorize(broken)) << number;
    }
    EXPECT_FALSE(factor.factorize(broken, Pivots::any)) << "infinite";
    // A node that nothing ties to others, and nothing resists.
    for (int i = 0; i < broken.rows(); ++i)
      for (int k = broken.row_begin(i); k < broken.row_begin(i + 1); ++k)
        if (const int j = broken.columns(i)[at(k - broken.row_begin(i))]; i == last || j == last)
          std::fill_n(broken.block(k), 36, 0.0);
    EXPECT_FALSE(factor.factorize(broken, Pivots::any)) << "a pivot vanishes";
    EXPECT_TRUE(factor.factorize(t.matrix)) << "it is of use afterwards";
  }
}

/// Memory that ends at any allocation leaves what another attempt can use.
TEST(Cholesky, GoesOnWhereMemoryEnded) {
  TangentAtRest t(held(build({block_spec(grid(5, 4, 4))}).model), 2);
  const std::vector<double> b = right_side(at(t.model.dof_count()));
  std::vector<double> wanted(b.size()), x(b.size());
  BlockCholesky untouched(t.matrix, t.filter, nullptr, &t.pool);
  ASSERT_TRUE(untouched.factorize(t.matrix));
  untouched.solve(b, wanted);
  bool ended = true;
  for (int allowed = 0; ended; ++allowed) {
    ASSERT_LT(allowed, 100);
    BlockCholesky factor(t.matrix, t.filter, nullptr, &t.pool);
    allocations_left = allowed;
    try {
      factor.factorize(t.matrix);
      ended = false;
    } catch (const std::bad_alloc&) {
    }
    allocations_left = -1;
    ASSERT_TRUE(factor.factorize(t.matrix)) << allowed;
    factor.solve(b, x);
    EXPECT_EQ(x, wanted) << allowed;
  }
}

/// Rounding decides what the last pivots of a body are that nothing holds.
TEST(Cholesky, TellsHowSmallPivotsAre) {
  for (const int length : {4, 9, 20, 33}) {
    const TangentAtRest free(build({block_spec(grid(length, 2, 2))}).model, 1);
    BlockCholesky factor(free.matrix, free.filter);
    EXPECT_TRUE(!factor.factorize(free.matrix) || factor.smallest_pivot() < 1e-12);
    ASSERT_TRUE(factor.factorize(free.matrix, Pivots::positive, 1e-6, &free.matrix));
    EXPECT_GT(factor.smallest_pivot(), 1e-7) << "six motions, and what the shift adds to each node";
    const TangentAtRest held_at_end(held(build({block_spec(grid(length, 2, 2))}).model), 1);
    BlockCholesky other(held_at_end.matrix, held_at_end.filter);
    ASSERT_TRUE(other.factorize(held_at_end.matrix));
    EXPECT_GT(other.smallest_pivot(), 1e-6);
    EXPECT_LE(other.smallest_pivot(), 1);
  }
}

TEST(Cholesky, OfNothingFreeSolvesNothing) {
  Model model = vertex_block(grid(2, 2, 2));
  hold_face(model);
  hold_face(model, 1);
  const TangentAtRest t(model, 1);
  BlockCholesky factor(t.matrix, t.filter);
  EXPECT_TRUE(factor.factorize(t.matrix));
  const std::vector<double> b(at(t.model.dof_count()), 1);
  std::vector<double> x(b.size(), 7);
  factor.solve(b, x);
  EXPECT_EQ(x, std::vector<double>(b.size(), 0));
}

}  // namespace
}  // namespace fascia::cholesky_test
