#pragma once

#include "core/base/index.hpp"
#include "gpu/system/levels.hpp"

namespace fascia::gpu {

template <class Space>
void Levels<Space>::Rows::take(const BlockRows& rows) {
  begin.upload(rows.begin);
  column.upload(rows.column);
  value_begin.upload(rows.value_begin);
  values.upload(rows.values);
}

/// Values go over in parts, so that the host needs no second matrix.
template <class Space>
void Levels<Space>::Rows::take(const FineRows& rows) {
  constexpr std::size_t kPart = std::size_t{1} << 21U;  // numbers
  std::vector<int> begins{0}, columns, befores;
  std::vector<std::size_t> value_begins{0};
  for (int row = 0; row < rows.rows(); ++row) {
    int dofs = 0;
    rows.for_each_column(row, [&](int other) {
      columns.push_back(other);
      befores.push_back(dofs);
      dofs += rows.size(other);
    });
    begins.push_back(static_cast<int>(columns.size()));
    value_begins.push_back(value_begins.back() + at(rows.size(row)) * at(dofs));
  }
  begin.upload(begins);
  column.upload(columns);
  before.upload(befores);
  value_begin.upload(value_begins);
  values.resize(value_begins.back());
  std::vector<double> part;
  std::size_t sent = 0;
  for (int row = 0; row < rows.rows(); ++row) {
    rows.for_each_block(row, [&](int other, const double* block) {
      part.insert(part.end(), block, block + rows.size(row) * rows.size(other));
    });
    if (part.size() < kPart && row + 1 < rows.rows()) continue;
    Space::copy_in(values.data() + sent, part.data(), part.size() * sizeof(double));
    sent += part.size();
    part.clear();
  }
}

template <class Space>
void Levels<Space>::Level::take_columns(const BlockRows& made, int coarse) {
  std::vector<int> begin(at(coarse) + 1, 0), rows(made.column.size());
  std::vector<std::size_t> blocks(made.column.size());
  for (const int column : made.column) ++begin[at(column) + 1];
  for (int c = 0; c < coarse; ++c) begin[at(c) + 1] += begin[at(c)];
  std::vector<int> next(begin.begin(), begin.end() - 1);
  for (int i = 0; i < made.rows(); ++i) {
    const std::span<const int> columns = made.columns(i);
    if (columns.empty()) continue;
    const std::size_t size = (made.value_begin[at(i) + 1] - made.value_begin[at(i)]) / columns.size();
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const std::size_t to = at(next[at(columns[k])]++);
      rows[to] = i;
      blocks[to] = made.value_begin[at(i)] + k * size;
    }
  }
  column_begin.upload(begin);
  row.upload(rows);
  block.upload(blocks);
}

template <class Space>
void Levels<Space>::Level::take(const Multigrid::LevelView& made, const kernels::LevelNodes& of, std::size_t dofs) {
  nodes = of;
  by = Smoothing::up_to(made.largest > 0 ? made.largest : 1);  // not smoothed where an inverse is known
  inverse.upload(made.inverse);
  if (made.matrix != nullptr) K.take(*made.matrix);
  if (made.fine != nullptr) K.take(*made.fine);
  if (made.P != nullptr) P.take(*made.P);
  for (auto* vector : {&b, &x, &r, &d}) vector->resize(dofs);
}

/// Arrays move where they grow, and loops that were recorded point to them.
template <class Space>
void Levels<Space>::take(const Multigrid& made, const NodesView& nodes) {
  ++key_;
  levels_.resize(made.level_count());
  for (std::size_t depth = 0; depth < levels_.size(); ++depth) {
    const Multigrid::LevelView level = made.level(depth);
    kernels::LevelNodes of{level.nodes, nullptr, nullptr};
    if (depth == 0) of = {nodes.count, nodes.dof, nodes.block};
    std::size_t dofs = at(kFrameDofs * level.nodes);
    if (depth == 0) dofs = at(made.finest_dofs());
    if (!levels_[depth]) levels_[depth] = std::make_unique<Level>();
    levels_[depth]->take(level, of, dofs);
    if (level.fine != nullptr) levels_[depth]->largest_node = level.fine->largest_size();
    if (level.P != nullptr) levels_[depth]->take_columns(*level.P, made.level(depth + 1).nodes);
  }
  coarsest_.upload(made.coarsest_inverse());
}

}  // namespace fascia::gpu
