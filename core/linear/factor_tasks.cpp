#include "core/linear/factor_tasks.hpp"

#include "core/base/index.hpp"
#include "core/base/look.hpp"

#include <algorithm>

namespace fascia {

namespace {

constexpr int kFewRows = 48;  ///< of a part, at least
/// Operations that are worth another thread, and a task of their own: half a millisecond, and some times what passing
/// one on costs.
constexpr double kWorthThread = 1.5e7, kWorthTask = 5e5;

/// Counts the operations of the products that a supernode gathers, and of its own division.
double work_of(const FactorPattern& pattern, int s) {
  const double columns = pattern.columns(s), rows = pattern.rows(s);
  double work = columns * columns * rows;
  for (std::int64_t k = pattern.descendant_begin[at(s)]; k < pattern.descendant_begin[at(s + 1)]; ++k) {
    const auto [d, begin] = pattern.descendant[static_cast<std::size_t>(k)];
    const double below = pattern.rows(d) - begin;
    work += 2.0 * pattern.columns(d) * below * std::min(columns, below);
  }
  return work;
}

}  // namespace

FactorTasks::FactorTasks(const FactorPattern& pattern, int threads, int most_rows)
    : threads_(static_cast<int>(std::clamp(pattern.flops / kWorthThread, 1.0, static_cast<double>(threads)))),
      most_rows_(most_rows) {
  if (threads_ > 1) cut(pattern);
}

/// The largest subtrees are taken apart until each is a small part of the whole.
void FactorTasks::cut(const FactorPattern& pattern) {
  constexpr double kPartsOfThread = 4;
  const int count = pattern.supernodes();
  std::vector<double> cost(at(count));
  std::vector<int> first(at(count)), roots;
  std::vector<std::vector<int>> children(at(count));
  for (int s = 0; s < count; ++s) first[at(s)] = s;
  double all = 0;
  for (int s = 0; s < count; ++s) {
    const double rows = pattern.rows(s), columns = pattern.columns(s);
    const double own = columns * (rows * (rows - columns) + columns * columns / 3);
    all += own;
    cost[at(s)] += own;
    const int parent = pattern.parent[at(s)];
    if (parent < 0) {
      roots.push_back(s);
      continue;
    }
    children[at(parent)].push_back(s);
    cost[at(parent)] += cost[at(s)];
    first[at(parent)] = std::min(first[at(parent)], first[at(s)]);
  }
  std::vector<int> subtrees, on_top;
  while (!roots.empty()) {
    const int root = roots.back();
    roots.pop_back();
    if (cost[at(root)] * kPartsOfThread * threads_ <= all) {
      subtrees.push_back(root);
      continue;
    }
    on_top.push_back(root);
    roots.insert(roots.end(), children[at(root)].begin(), children[at(root)].end());
  }
  // Those that stand last are taken first: the largest.
  std::sort(subtrees.begin(), subtrees.end(), [&](int a, int b) { return cost[at(a)] < cost[at(b)]; });

  std::vector<int> unit_of(at(count), -1);  // of the roots of subtrees, and of those on top
  for (const int root : subtrees) {
    unit_of[at(root)] = static_cast<int>(units_.size());
    units_.push_back({first[at(root)], root + 1, true, 0, 0, 0});
  }
  for (const int s : on_top) {
    unit_of[at(s)] = static_cast<int>(units_.size());
    const double parts = std::clamp(work_of(pattern, s) / kWorthTask, 1.0, static_cast<double>(threads_));
    const int columns = pattern.columns(s), rows = pattern.rows(s);
    const int share = static_cast<int>((rows - columns) / parts);
    const int part = std::clamp((share + kFewRows - 1) / kFewRows * kFewRows, kFewRows, most_rows_);
    units_.push_back({s, s + 1, parts < 2, columns, rows, part});
  }
  std::size_t tasks = 0;  // all that could be ready at once: threads must not meet the end of memory
  for (Unit& unit : units_) {
    const int parent = pattern.parent[at(unit.end - 1)];
    if (parent >= 0) unit.next = unit_of[at(parent)];
    tasks += 1 + (unit.whole ? 0 : at(unit.rows / unit.part + 1));
  }
  for (const Unit& unit : units_)
    if (unit.next >= 0) ++units_[at(unit.next)].awaited;
  ready_.reserve(tasks);
}

void FactorTasks::begin() {
  ready_.clear();
  unfinished_ = static_cast<int>(units_.size());
  for (Unit& unit : units_) unit.waiting = unit.awaited;
  for (std::size_t k = 0; k < units_.size(); ++k)
    if (units_[k].awaited == 0) start(static_cast<int>(k));
  worth_a_look_ = true;
}

bool FactorTasks::take(Task& task) {
  look_for([&] { return worth_a_look_.load(std::memory_order_relaxed); });
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return !ready_.empty() || unfinished_ == 0; });
  if (ready_.empty()) return false;
  task = ready_.back();
  ready_.pop_back();
  if (ready_.empty()) worth_a_look_.store(false, std::memory_order_relaxed);
  return true;
}

void FactorTasks::finish(const Task& task) {
  const std::lock_guard lock(mutex_);
  Unit& unit = units_[at(task.unit)];
  if (--unit.open > 0) return;
  if (task.kind == Kind::gather) {
    unit.open = 1;
    ready_.push_back({Kind::diagonal, task.supernode, 0, unit.columns, task.unit});
  } else if (task.kind == Kind::diagonal && unit.rows > unit.columns) {
    push_parts(task.unit, Kind::divide);
  } else {
    --unfinished_;
    if (unit.next >= 0 && --units_[at(unit.next)].waiting == 0) start(unit.next);
  }
  if (ready_.empty() && unfinished_ > 0) return;
  worth_a_look_.store(true, std::memory_order_relaxed);
  changed_.notify_all();
}

void FactorTasks::start(int number) {
  Unit& unit = units_[at(number)];
  if (!unit.whole) return push_parts(number, Kind::gather);
  unit.open = 1;
  ready_.push_back({Kind::subtree, unit.end, unit.begin, unit.end, number});
}

/// The first part, with the diagonal, is gathered alone.
void FactorTasks::push_parts(int number, Kind kind) {
  Unit& unit = units_[at(number)];
  unit.open = 0;
  const auto push = [&](int begin, int end) {
    ready_.push_back({kind, unit.begin, begin, end, number});
    ++unit.open;
  };
  if (kind == Kind::gather) push(0, unit.columns);
  for (int begin = unit.columns; begin < unit.rows; begin += unit.part)
    push(begin, std::min(unit.rows, begin + unit.part));
}

}  // namespace fascia
