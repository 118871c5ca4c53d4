#include "core/tangent/tangent_operator.hpp"

#include "core/base/index.hpp"
#include "core/base/parallel_copy.hpp"
#include "core/node/positive_inverse.hpp"
#include "core/tangent/condensation.hpp"
#include "core/tangent/stability.hpp"

#include <algorithm>

namespace fascia {

namespace {

/// Products by blocks of a tangent. An assembly takes as long as 4 of tetrahedra, 6 of shells, and 5 to 10 of points.
constexpr int kWorthAssembling = 20;

}  // namespace

TangentOperator::TangentOperator(const Model& model, CpuExecutor& executor, const DofFilter& filter)
    : model_(model),
      executor_(executor),
      filter_(filter),
      vectors_(executor.pool()),
      nodes_(nodes_of(model.points)),
      dependents_(model.points, PoolSpace(executor.pool())),
      condensation_(dependents_, model.points.dofs, executor.pool()),
      work_(at(model.dof_count())) {}

void TangentOperator::take(const Linearization& lin, const Relinearize* tamer) {
  at_ = &lin;
  tamer_ = tamer;
  assembled_ = rounded_ = tamed_ = false;
  by_blocks_ = 0;
  if (pattern_ != executor_.pattern()) {
    pattern_ = executor_.pattern();
    matrix_.reset();
    material_.reset();
    material_rounded_ = false;
  }
  beside_.set(lin.loads.volumes, filter_);
  dependents_.turn_to(lin.Q.data());
}

void TangentOperator::tame(TamerTangent kind) {
  assemble((*tamer_)(kind), pattern(), Entries::all);
  assembled_ = tamed_ = true;
  rounded_ = false;
}

void TangentOperator::assemble(const Linearization& lin, BlockMatrix& out, Entries entries) {
  executor_.assemble(lin, out, dependents_.empty() ? entries : Entries::all);
  condensation_.condense(out);
}

BlockMatrix& TangentOperator::pattern() {
  if (!matrix_) matrix_.emplace(model_.points, model_.surfaces);
  return *matrix_;
}

const BlockMatrix& TangentOperator::matrix() {
  if (!assembled_) assemble(*at_, pattern(), Entries::all);
  assembled_ = true;
  return *matrix_;
}

const BlockMatrix& TangentOperator::material_part(Entries entries) {
  if (!material_) material_.emplace(model_.points, model_.surfaces);
  assemble((*tamer_)(TamerTangent::material), *material_, entries);
  material_rounded_ = false;
  return *material_;
}

/// y = K x, where multiply(x, y) does so in the axes of the world and returns x · y. Where constraints have axes of
/// their own, x · y is summed in these: reactions have no part in it there, as large as they may be, but rounding in
/// others.
template <class Multiply>
double TangentOperator::apply_in_world(const Multiply& multiply, std::span<const double> x, std::span<double> y) {
  if (!filter_.turns()) return multiply(x, y);
  copy_parallel(pool(), x, std::span(work_));
  filter_.to_global(work_);
  multiply(std::span<const double>(work_), y);
  filter_.to_local(y);
  return vectors_.dot(x, y);
}

/// Adds the terms beside a matrix to y. @return  x · y, which was `product` without
double TangentOperator::add_beside(double product, std::span<const double> x, std::span<double> y) const {
  if (beside_.empty()) return product;
  beside_.add_product(x, y);
  return vectors_.dot(x, y);
}

double TangentOperator::apply(std::span<const double> x, std::span<double> y) {
  if (!assembled_ && ++by_blocks_ <= kWorthAssembling) {
    apply_by_blocks(x, y, false);
    return vectors_.dot(x, y);
  }
  matrix();
  return add_beside(apply_in_world([&](auto from, auto to) { return matrix_->multiply(pool(), from, to); }, x, y), x,
                    y);
}

/// The matrix as it is, with its rounded entries beside the others.
const BlockMatrix& TangentOperator::rounded_matrix(bool material) {
  if (!material) matrix();
  BlockMatrix& K = material ? *material_ : *matrix_;
  bool& made = material ? material_rounded_ : rounded_;
  if (!made) K.round(pool());
  made = true;
  return K;
}

double TangentOperator::apply_free_next(std::span<const double> z, double s, std::span<double> x, std::span<double> y,
                                        bool rounded) {
  if (!rounded && !assembled_) {
    vectors_.xpay(z, s, x);
    return apply_free(x, y);
  }
  const BlockMatrix& K = rounded ? rounded_matrix(false) : *matrix_;
  const auto multiply = [&](auto from, auto to) {
    return rounded ? K.multiply_rounded(pool(), from, to) : K.multiply(pool(), from, to);
  };
  double product = 0;
  if (filter_.turns()) {
    vectors_.xpay(z, s, x);
    product = apply_in_world(multiply, x, y);
  } else {
    product = rounded ? K.multiply_next_rounded(pool(), z, s, x, y) : K.multiply_next(pool(), z, s, x, y);
  }
  product = add_beside(product, x, y);
  filter_.clear_fixed(y);
  return product;
}

void TangentOperator::apply_free_rounded(bool material, std::span<const double> x, std::span<double> y) {
  const BlockMatrix& K = rounded_matrix(material);
  apply_in_world([&](auto from, auto to) { return K.multiply_rounded(pool(), from, to); }, x, y);
  filter_.clear_fixed(y);
}

void TangentOperator::apply_whole(std::span<const double> x, std::span<double> y) { apply_by_blocks(x, y, true); }

/// y = K x without a matrix. @param whole  with what loads without a potential add
void TangentOperator::apply_by_blocks(std::span<const double> x, std::span<double> y, bool whole) {
  copy_parallel(pool(), x, std::span(work_));
  filter_.to_global(work_);
  dependents_.expand(nodes_, work_.data());
  executor_.multiply(*at_, work_, y);
  if (whole) at_->loads.add_unsymmetric_product(model_.points, at_->Q, work_, y);
  dependents_.transfer(nodes_, y.data());
  filter_.to_local(y);
}

void TangentOperator::invert_diagonal(const BlockMatrix& matrix, bool whole, std::vector<double>& out) const {
  const DofLayout& dofs = model_.points.dofs;
  out.resize(dofs.block_total());
  pool().for_ranges(model_.node_count(), 128, [&](int begin, int end) {
    for (int node = begin; node < end; ++node) {
      const int n = dofs.size(node);
      double* block = out.data() + dofs.block_begin(node);
      filter_.rotate_block(node, node, matrix.block(matrix.diagonal(node)), block);
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          const bool held = filter_.is_fixed(at(dofs.begin(node) + i)) || filter_.is_fixed(at(dofs.begin(node) + j));
          if (held || (!whole && i != j)) block[n * i + j] = i == j ? 1 : 0;
        }
      }
      positive_inverse(block, n);
    }
  });
}

std::span<const double> TangentOperator::lengths() {
  if (lengths_.empty()) lengths_ = motion_lengths(model_, filter_);
  return lengths_;
}

Multigrid::Places TangentOperator::places() const {
  Multigrid::Places places;
  places.x = model_.rest_position;
  for (std::size_t i = 0; i < at_->u.size(); ++i) places.x[i] += at_->u[i];
  places.Q = at_->Q;
  return places;
}

}  // namespace fascia
