#include "core/linear/vectors.hpp"

#include "core/base/parallel_copy.hpp"
#include "core/linear/vector_ranges.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace fascia {

namespace {
constexpr int kChunk = 4096;
}

/// Σ over fixed chunks of sum_of(begin, end).
template <class SumOf>
double CpuVectors::sum_of_chunks(std::size_t size, const SumOf& sum_of) const {
  const int n = static_cast<int>(size);
  const int chunks = (n + kChunk - 1) / kChunk;
  std::array<double, 64> few;  // no allocation for short vectors
  std::vector<double> many(chunks > 64 ? static_cast<std::size_t>(chunks) : 0);
  const std::span<double> partial =
      chunks > 64 ? std::span(many) : std::span(few).first(static_cast<std::size_t>(chunks));
  pool_->for_ranges(n, kChunk, [&](int begin, int end) {
    partial[static_cast<std::size_t>(begin / kChunk)] =
        sum_of(static_cast<std::size_t>(begin), static_cast<std::size_t>(end));
  });
  double sum = 0;
  for (const double p : partial) sum += p;
  return sum;
}

namespace {

double dot_of_chunk(std::span<const double> a, std::span<const double> b) {
  std::array<double, 8> lanes{};
  std::size_t i = 0;
  for (; i + 8 <= a.size(); i += 8)
    for (std::size_t k = 0; k < 8; ++k) lanes[k] += a[i + k] * b[i + k];
  for (std::size_t k = 0; i < a.size(); ++i, ++k) lanes[k] += a[i] * b[i];
  double sum = 0;
  for (const double lane : lanes) sum += lane;
  return sum;
}

}  // namespace

double CpuVectors::dot(std::span<const double> a, std::span<const double> b) const {
  return sum_of_chunks(a.size(), [&](std::size_t begin, std::size_t end) {
    return dot_of_chunk(a.subspan(begin, end - begin), b.subspan(begin, end - begin));
  });
}

void CpuVectors::clear(std::size_t n, Vector& to) const {
  to.resize(n);
  clear_parallel(*pool_, std::span(to));
}

double CpuVectors::copy(std::span<const double> from, std::span<double> to) const {
  return sum_of_chunks(from.size(), [&](std::size_t begin, std::size_t end) {
    const std::span<const double> part = from.subspan(begin, end - begin);
    std::copy(part.begin(), part.end(), to.data() + begin);
    return dot_of_chunk(part, part);
  });
}

void CpuVectors::advance(double s, std::span<const double> p, std::span<const double> q, std::span<double> x,
                         std::span<double> r) const {
  pool_->for_ranges(static_cast<int>(x.size()), kChunk, [&](int begin, int end) {
    advance_range(s, p, q, x, r, static_cast<std::size_t>(begin), static_cast<std::size_t>(end));
  });
}

double CpuVectors::advance_and_copy(double s, std::span<const double> p, std::span<const double> q, std::span<double> x,
                                    std::span<double> r, std::span<double> z) const {
  return sum_of_chunks(x.size(), [&](std::size_t begin, std::size_t end) {
    advance_range(s, p, q, x, r, begin, end);
    const std::span<const double> part = std::span<const double>(r).subspan(begin, end - begin);
    std::copy(part.begin(), part.end(), z.data() + begin);
    return dot_of_chunk(part, part);
  });
}

void CpuVectors::add(double s, std::span<const double> x, std::span<double> y) const {
  pool_->for_ranges(static_cast<int>(x.size()), kChunk, [&](int begin, int end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) y[i] += s * x[i];
  });
}

void CpuVectors::scale(double s, std::span<double> x) const {
  pool_->for_ranges(static_cast<int>(x.size()), kChunk, [&](int begin, int end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) x[i] *= s;
  });
}

void CpuVectors::xpay(std::span<const double> x, double s, std::span<double> y) const {
  pool_->for_ranges(static_cast<int>(x.size()), kChunk, [&](int begin, int end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) y[i] = x[i] + s * y[i];
  });
}

}  // namespace fascia
