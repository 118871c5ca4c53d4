#include "core/linear/block_matrix.hpp"

#include "core/base/incidence.hpp"
#include "core/base/index.hpp"
#include "core/base/parallel_copy.hpp"
#include "core/structure/blocks.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <type_traits>
#include <utility>

namespace fascia {

namespace {

constexpr int kRowGrain = 64;
static_assert(dof_count(FrameKind::vertex) % 3 == 0 && dof_count(FrameKind::rigid) % 3 == 0 &&
              dof_count(FrameKind::affine) % 3 == 0);  // places of blocks count nines

/// Elements around each node of a block.
struct ElementsAround {
  int nodes;                       ///< of an element
  bool averaged;                   ///< an element feels the nodes of all elements around its own nodes
  std::vector<int> element;        ///< (elements × nodes)
  std::vector<int> begin, around;  ///< (nodes of the model + 1), elements of each

  template <class Block>
  ElementsAround(const Block& block, int model_nodes) : nodes(block.nodes), averaged(block.averaged) {
    block.for_each_cell([&](std::span<const int> e, double) { element.insert(element.end(), e.begin(), e.end()); });
    begin.assign(at(model_nodes) + 1, 0);
    for (const int node : element) ++begin[at(node) + 1];
    for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
    around.resize(element.size());
    std::vector<int> next(begin.begin(), begin.end() - 1);
    for (std::size_t k = 0; k < element.size(); ++k) around[at(next[at(element[k])]++)] = static_cast<int>(k) / nodes;
  }

  /// Calls act for each node of the elements around a node, some more than once.
  template <class Act>
  void for_each_neighbour(int node, const Act& act) const {
    for (int k = begin[at(node)]; k < begin[at(node + 1)]; ++k)
      for (int a = 0; a < nodes; ++a) act(element[at(around[at(k)] * nodes + a)]);
  }
};

/// Nodes that move each face, and the faces that each node moves.
struct FacesAround {
  std::vector<int> begin{0}, node;        ///< (faces + 1)
  std::vector<int> around_begin, around;  ///< (nodes of the model + 1)

  FacesAround(std::span<const SurfaceLoad> surfaces, int model_nodes) {
    for (const SurfaceLoad& load : surfaces) {
      for (int f = 0; f < load.face_count(); ++f) {
        for (const int vertex : load.face(f))
          for (const SurfaceShare& share : load.shares_of(vertex)) node.push_back(share.node);
        std::sort(node.begin() + begin.back(), node.end());
        node.erase(std::unique(node.begin() + begin.back(), node.end()), node.end());
        begin.push_back(static_cast<int>(node.size()));
      }
    }
    const auto for_each = [&](const auto& act) {
      for (std::size_t f = 0; f + 1 < begin.size(); ++f)
        for (int k = begin[f]; k < begin[f + 1]; ++k) act(node[at(k)], static_cast<int>(f));
    };
    list_by_node(model_nodes, for_each, around_begin, around);
  }

  template <class Act>
  void for_each_neighbour(int of, const Act& act) const {
    for (int k = around_begin[at(of)]; k < around_begin[at(of + 1)]; ++k)
      for (int n = begin[at(around[at(k)])]; n < begin[at(around[at(k)] + 1)]; ++n) act(node[at(n)]);
  }
};

/// A number that other places do not have (FNV-1a).
std::uint64_t pattern_of(const std::vector<int>& row_begin, const std::vector<int>& column) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const std::vector<int>* list : {&row_begin, &column})
    for (const int i : *list) hash = (hash ^ static_cast<std::uint32_t>(i)) * 0x100000001b3;
  return hash;
}

}  // namespace

BlockMatrix::BlockMatrix(const PointSet& set, std::span<const SurfaceLoad> surfaces) : dofs_(set.dofs) {
  find_pattern(set, surfaces);
  if (!set.dependents.empty()) add_blocks_of_hosts(set);
  uniform_ = rows() > 0 && dofs_.size(0) <= 6 && set.dependents.empty() ? dofs_.size(0) : 0;
  for (int node = 0; node < rows(); ++node)
    if (dofs_.size(node) != uniform_) uniform_ = 0;
  std::size_t next = 0;
  for (int row = 0; row < rows(); ++row) {
    for (const int column : columns(row)) {
      value_begin_.push_back(next);
      if (uniform_ == 0 || column >= row) next += at(dofs_.size(row)) * at(dofs_.size(column));
    }
  }
  value_begin_.push_back(next);
  for (int row = 0; row < rows(); ++row)
    for_each_left(row, [&](int k) { read_count_ += value_begin_[at(k + 1)] - value_begin_[at(k)]; });
  pattern_ = pattern_of(row_begin_, column_);
  values_.assign(next + 1, 0.0);  // one more: rows of three are read four at a time
  if (uniform_ > 0)
    size_chunks();
  else
    find_mirrors();
  const std::size_t parts = uniform_ > 0 ? chunk_begin_.size() - 1 : at((rows() + kRowGrain - 1) / kRowGrain);
  sums_.assign(parts, 0.0);
}

void BlockMatrix::find_mirrors() {
  mirror_.assign(column_.size(), -1);
  std::vector<int> reached(row_begin_.begin(), row_begin_.end() - 1);
  for (int row = 0; row < rows(); ++row)  // ascending rows meet the blocks above the diagonal in their order
    for (int k = row_begin(row); k < diagonal(row); ++k) {
      int& upper = reached[at(column_[at(k)])];
      upper = std::max(upper, diagonal(column_[at(k)]) + 1);
      mirror_[at(k)] = upper++;
    }
}

void BlockMatrix::find_pattern(const PointSet& set, std::span<const SurfaceLoad> surfaces) {
  std::vector<int> group_of_slot(at(set.slot_count()));
  for (int group = 0; group < set.group_count(); ++group)
    std::fill(group_of_slot.begin() + set.slot_begin[at(group)], group_of_slot.begin() + set.slot_begin[at(group + 1)],
              group);
  std::vector<ElementsAround> around;
  for_each_block(set, [&]<class Block>(const Block& block) {
    if constexpr (!std::is_same_v<Block, PointGroups>) around.emplace_back(block, set.node_count());
  });
  const FacesAround faces(surfaces, set.node_count());
  std::vector<int> last_seen(at(set.node_count()), -1), near;  // near: those of a block about the row
  for (int row = 0; row < set.node_count(); ++row) {
    const std::size_t begin = column_.size();
    const auto add = [&](int column) {
      if (last_seen[at(column)] == row) return;
      last_seen[at(column)] = row;
      column_.push_back(column);
    };
    add(row);
    for (int k = set.node_slot_begin[at(row)]; k < set.node_slot_begin[at(row + 1)]; ++k) {
      const int slot = set.node_slot[at(k)], group = group_of_slot[at(slot)];
      for (int other = set.slot_begin[at(group)]; other < set.slot_begin[at(group + 1)]; ++other)
        if ((set.slot_lanes[at(slot)] & set.slot_lanes[at(other)]) != 0) add(set.slot_node[at(other)]);
    }
    faces.for_each_neighbour(row, add);
    for (std::size_t b = 0; b < around.size(); ++b) {
      near.clear();
      around[b].for_each_neighbour(row, [&](int column) {
        add(column);
        near.push_back(column);
      });
      if (!around[b].averaged) continue;
      std::sort(near.begin(), near.end());
      near.erase(std::unique(near.begin(), near.end()), near.end());
      for (const int column : near) around[b].for_each_neighbour(column, add);
    }
    std::sort(column_.begin() + static_cast<std::ptrdiff_t>(begin), column_.end());
    row_begin_.push_back(static_cast<int>(column_.size()));
    diagonal_.push_back(find(row, row));
  }
}

namespace {

/// Blocks beside a pattern, by rows; each row is cleared of repetitions when it has doubled.
class MoreBlocks {
 public:
  explicit MoreBlocks(int rows) : columns_(at(rows)), known_(at(rows), 0) {}
  void add(int row, int column) {
    columns_[at(row)].push_back(column);
    if (columns_[at(row)].size() > 2 * known_[at(row)] + 64) sorted(row);
  }
  const std::vector<int>& sorted(int row) {
    std::vector<int>& columns = columns_[at(row)];
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    known_[at(row)] = columns.size();
    return columns;
  }

 private:
  std::vector<std::vector<int>> columns_;
  std::vector<std::size_t> known_;
};

}  // namespace

/// The pattern of Tᵀ K T beside that of K: the nodes that move a node, itself or in the end its hosts, have blocks with
/// those that move each neighbour of it.
void BlockMatrix::add_blocks_of_hosts(const PointSet& set) {
  std::vector<std::vector<int>> movers(at(rows()));  // of what depends; itself too, where some of it is free
  std::vector<char> gone(at(rows()), 0);
  for (const DependentNode& d : set.dependents) {  // hosts that depend come before
    std::vector<int>& own = movers[at(d.node)];
    gone[at(d.node)] = dependent_dofs(d, dofs_) == dofs_.size(d.node) ? 1 : 0;
    if (gone[at(d.node)] == 0) own.push_back(d.node);
    for (const int host : d.hosts) {
      const std::vector<int>& in_turn = movers[at(host)];
      if (in_turn.empty()) own.push_back(host);
      own.insert(own.end(), in_turn.begin(), in_turn.end());
    }
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
  }
  MoreBlocks more(rows());
  std::vector<int> near;
  for (int row = 0; row < rows(); ++row) {
    const std::span<const int> known = columns(row);
    const auto depends = [&](int node) { return !movers[at(node)].empty(); };
    if (!depends(row) && std::none_of(known.begin(), known.end(), depends)) continue;
    near.clear();
    for (const int column : known) {
      const std::vector<int>& by = movers[at(column)];
      if (by.empty()) near.push_back(column);
      near.insert(near.end(), by.begin(), by.end());
    }
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    const auto add = [&](int mover) {
      for (const int column : near) more.add(mover, column);
    };
    if (depends(row))
      std::for_each(movers[at(row)].begin(), movers[at(row)].end(), add);
    else
      add(row);
  }
  std::vector<int> columns_of_all, begin{0};
  for (int row = 0; row < rows(); ++row) {
    const std::span<const int> known = columns(row);
    const std::vector<int>& added = more.sorted(row);
    std::set_union(known.begin(), known.end(), added.begin(), added.end(), std::back_inserter(columns_of_all));
    begin.push_back(static_cast<int>(columns_of_all.size()));
  }
  column_ = std::move(columns_of_all);
  row_begin_ = std::move(begin);
  for (int row = 0; row < rows(); ++row) diagonal_[at(row)] = find(row, row);
  left_begin_.assign(1, 0);
  for (int row = 0; row < rows(); ++row) {
    for (int k = row_begin(row); k < row_begin(row + 1); ++k)
      if (k == diagonal(row) || (gone[at(row)] == 0 && gone[at(column_[at(k)])] == 0)) left_.push_back(k);
    left_begin_.push_back(static_cast<int>(left_.size()));
  }
}

std::span<const int> BlockMatrix::columns(int row) const {
  const auto begin = static_cast<std::size_t>(row_begin(row)), end = static_cast<std::size_t>(row_begin(row + 1));
  return std::span(column_).subspan(begin, end - begin);
}

int BlockMatrix::find(int row, int column) const {
  const auto begin = column_.begin() + row_begin(row), end = column_.begin() + row_begin(row + 1);
  return static_cast<int>(std::lower_bound(begin, end, column) - column_.begin());
}

void BlockMatrix::clear_row(int row) {
  std::fill(values_.data() + value_begin_[at(row_begin(row))], values_.data() + value_begin_[at(row_begin(row + 1))],
            0.0);
}

/// Each block below the diagonal has a mirror of its own, so that rows write at different places.
void BlockMatrix::mirror_lower(ThreadPool& pool) {
  if (uniform_ > 0) return;
  pool.for_ranges(rows(), kRowGrain, [&](int begin, int end) {
    for (int row = begin; row < end; ++row) {
      for (int k = row_begin(row); k < diagonal(row); ++k) {
        const int n = dofs_.size(row), m = dofs_.size(column_[at(k)]);
        const double* lower = block(k);
        double* upper = block(mirror_[at(k)]);
        for (int i = 0; i < n; ++i)
          for (int j = 0; j < m; ++j) upper[n * j + i] = lower[m * i + j];
      }
    }
  });
}

namespace {

/// y += B x of a block whose size is known to the compiler.
template <int N, int M, class T>
void add_product(const T* b, const double* x, double* y) {
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < M; ++j) y[i] += static_cast<double>(b[M * i + j]) * x[j];
}

}  // namespace

template <class T>
double BlockMatrix::multiply_row(const T* values, int row, std::span<const double> x, std::span<double> y) const {
  double sum[kMostDofs] = {};
  const int n = dofs_.size(row);
  const auto add = [&](int k) {
    const int column = column_[at(k)], m = dofs_.size(column);
    const double* xc = x.data() + dofs_.begin(column);
    const T* b = values + value_begin_[at(k)];
    if (n == 6 && m == 6)
      add_product<6, 6>(b, xc, sum);
    else if (n == 3 && m == 3)
      add_product<3, 3>(b, xc, sum);
    else if (n == 12 && m == 12)
      add_product<12, 12>(b, xc, sum);
    else
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < m; ++j) sum[i] += static_cast<double>(b[m * i + j]) * xc[j];
  };
  if (condensed_)
    for_each_left(row, add);
  else
    for (int k = row_begin(row); k < row_begin(row + 1); ++k) add(k);
  const double* own = x.data() + dofs_.begin(row);
  std::copy(sum, sum + n, y.data() + dofs_.begin(row));
  return std::inner_product(sum, sum + n, own, 0.0);
}

template <class T>
double BlockMatrix::multiply_by(const T* values, ThreadPool& pool, const Xpay& renew, std::span<const double> x,
                                std::span<double> y) const {
  if (uniform_ == 3) return multiply_upper<3>(values, pool, renew, x, y);
  if (uniform_ == 6) return multiply_upper<6>(values, pool, renew, x, y);
  if (renew.z != nullptr)
    pool.for_ranges(rows(), kRowGrain,
                    [&](int begin, int end) { renew(at(dofs_.begin(begin)), at(dofs_.begin(end))); });
  pool.for_ranges(rows(), kRowGrain, [&](int begin, int end) {
    double sum = 0;
    for (int row = begin; row < end; ++row) sum += multiply_row(values, row, x, y);
    sums_[at(begin / kRowGrain)] = sum;
  });
  return std::accumulate(sums_.begin(), sums_.end(), 0.0);
}

double BlockMatrix::multiply(ThreadPool& pool, std::span<const double> x, std::span<double> y) const {
  return multiply_by(values_.data(), pool, {}, x, y);
}

double BlockMatrix::multiply_next(ThreadPool& pool, std::span<const double> z, double s, std::span<double> x,
                                  std::span<double> y) const {
  return multiply_by(values_.data(), pool, {z.data(), s, x.data()}, x, y);
}

void BlockMatrix::round(ThreadPool& pool) {
  rounded_.resize(values_.size());
  copy_parallel(pool, std::span<const double>(values_), std::span(rounded_));
}

double BlockMatrix::multiply_rounded(ThreadPool& pool, std::span<const double> x, std::span<double> y) const {
  return multiply_by(rounded_.data(), pool, {}, x, y);
}

double BlockMatrix::multiply_next_rounded(ThreadPool& pool, std::span<const double> z, double s, std::span<double> x,
                                          std::span<double> y) const {
  return multiply_by(rounded_.data(), pool, {z.data(), s, x.data()}, x, y);
}

}  // namespace fascia
