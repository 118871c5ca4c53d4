#pragma once

#include "core/base/thread_pool.hpp"
#include "core/linear/factor_pattern.hpp"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <vector>

namespace fascia {

/// Threads share the making of a factor by these: whole subtrees of the elimination tree, and on top of them
/// supernodes, whose rows are gathered by several threads, then divided by several, once their diagonal is known. A
/// supernode waits for its children.
class FactorTasks {
 public:
  enum class Kind { subtree, gather, diagonal, divide };
  struct Task {
    Kind kind;
    int supernode;   ///< of a subtree: the one after its last
    int begin, end;  ///< rows of the supernode; of a subtree: supernodes
    int unit;
  };

  /// @param threads    that may share them; one, or little to do: there are none
  /// @param most_rows  of a supernode that one thread works at
  FactorTasks(const FactorPattern& pattern, int threads, int most_rows);
  FactorTasks(FactorTasks&&) = delete;

  bool empty() const { return units_.empty(); }
  int threads() const { return threads_; }  ///< that share them: as many as have enough to do
  /// Calls make(task, thread) for each, on all threads.
  template <class Make>
  void run(ThreadPool& pool, const Make& make) {
    begin();
    pool.for_chunks(threads_, [&](int thread) {
      for (Task task; take(task);) {
        make(task, thread);
        finish(task);
      }
    });
  }

 private:
  /// A supernode, or a subtree that one thread makes.
  struct Unit {
    int begin, end;     ///< supernodes
    bool whole;         ///< one task
    int columns, rows;  ///< of the supernode
    int part;           ///< rows of it for a task
    int next = -1;      ///< the unit that waits for it
    int awaited = 0;    ///< units that it waits for
    int waiting = 0;    ///< for so many of them still
    int open = 0;       ///< tasks of its present stage
  };
  void cut(const FactorPattern& pattern);
  void begin();
  bool take(Task& task);
  void finish(const Task& task);
  void start(int unit);
  void push_parts(int unit, Kind kind);

  int threads_ = 1, most_rows_ = 0;
  std::vector<Unit> units_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Task> ready_;
  std::atomic<bool> worth_a_look_{false};  ///< a task is ready, or all are done
  int unfinished_ = 0;                     ///< units
};

}  // namespace fascia
