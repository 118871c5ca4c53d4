#pragma once

#include "core/base/thread_pool.hpp"
#include "core/node/dof_filter.hpp"
#include "core/node/node_mode.hpp"
#include "core/run/fastest_mode.hpp"

#include <functional>
#include <vector>

namespace fascia {

/// The fastest mode of a model on the processor: an Operator of FastestMode. Products with K are differences of forces,
/// so that each costs as much as a step.
class ExplicitMode {
 public:
  /// Forces at a state, of the internal energy and against what loads do, by degrees of freedom. The second argument
  /// is 1/dt of the viscous stress against the strain of the present state.
  using Forces = std::function<void(const State&, double, std::span<double>)>;

  ExplicitMode(const Model& model, const DofFilter& filter, ThreadPool& pool, Forces forces);

  /// @param about  what the stable step is about [s]
  double stable_step(const State& state, double about);

  void begin(double inverse_step);
  void add_noise(double part);
  double normalize(int k);
  void scale(int k, double s);
  double product();
  void advance(int k, double a, double b);
  void combine(const double* s, int count);

 private:
  ModeNode node_at(int node) const;
  template <class Act>
  double for_nodes(const Act& act);

  const Model& model_;
  const DofFilter& filter_;
  ThreadPool& pool_;
  Forces forces_;
  FastestMode mode_;
  const State* state_ = nullptr;
  State moved_;
  double inverse_step_ = 0, largest_ = 0;
  std::uint64_t seed_ = 0;
  std::vector<double> base_, v_, w_, sums_, sizes_;
  std::vector<double> basis_[kModeBasis];
};

}  // namespace fascia
