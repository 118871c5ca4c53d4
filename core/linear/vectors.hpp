#pragma once

#include "core/base/thread_pool.hpp"

#include <span>
#include <vector>

namespace fascia {

/// Vectors of one number a degree of freedom, on the processor. Sums run in fixed chunks, so that they do not depend on
/// the number of threads. The CG is a template on such a space.
class CpuVectors {
 public:
  using Vector = std::vector<double>;
  explicit CpuVectors(ThreadPool& pool) : pool_(&pool) {}

  Vector zeros(std::size_t n) const { return Vector(n, 0.0); }
  /// Makes a vector of n zeros in the memory that it has.
  void clear(std::size_t n, Vector& to) const;
  double dot(std::span<const double> a, std::span<const double> b) const;
  /// to = from; returns from · from
  double copy(std::span<const double> from, std::span<double> to) const;
  /// x += s p, r −= s q
  void advance(double s, std::span<const double> p, std::span<const double> q, std::span<double> x,
               std::span<double> r) const;
  /// Does so, then z = r; returns r · r
  double advance_and_copy(double s, std::span<const double> p, std::span<const double> q, std::span<double> x,
                          std::span<double> r, std::span<double> z) const;
  /// y += s x
  void add(double s, std::span<const double> x, std::span<double> y) const;
  void scale(double s, std::span<double> x) const;
  /// y = x + s y
  void xpay(std::span<const double> x, double s, std::span<double> y) const;

 private:
  template <class SumOf>
  double sum_of_chunks(std::size_t size, const SumOf& sum_of) const;

  ThreadPool* pool_;
};

}  // namespace fascia
