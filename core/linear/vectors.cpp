#include "core/linear/vectors.hpp"

#include <array>
#include <cstddef>

namespace fascia {

namespace {
constexpr int kChunk = 4096;
}

double CpuVectors::dot(std::span<const double> a, std::span<const double> b) const {
  const int n = static_cast<int>(a.size());
  const int chunks = (n + kChunk - 1) / kChunk;
  std::array<double, 64> few;  // no allocation for short vectors
  std::vector<double> many(chunks > 64 ? static_cast<std::size_t>(chunks) : 0);
  const std::span<double> partial =
      chunks > 64 ? std::span(many) : std::span(few).first(static_cast<std::size_t>(chunks));
  pool_->for_ranges(n, kChunk, [&](int begin, int end) {
    std::array<double, 8> lanes{};
    std::size_t i = static_cast<std::size_t>(begin);
    for (; i + 8 <= static_cast<std::size_t>(end); i += 8)
      for (std::size_t k = 0; k < 8; ++k) lanes[k] += a[i + k] * b[i + k];
    for (std::size_t k = 0; i < static_cast<std::size_t>(end); ++i, ++k) lanes[k] += a[i] * b[i];
    double sum = 0;
    for (const double lane : lanes) sum += lane;
    partial[static_cast<std::size_t>(begin / kChunk)] = sum;
  });
  double sum = 0;
  for (const double p : partial) sum += p;
  return sum;
}

void CpuVectors::advance(double s, std::span<const double> p, std::span<const double> q, std::span<double> x,
                         std::span<double> r) const {
  pool_->for_ranges(static_cast<int>(x.size()), kChunk, [&](int begin, int end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      x[i] += s * p[i];
      r[i] -= s * q[i];
    }
  });
}

void CpuVectors::add(double s, std::span<const double> x, std::span<double> y) const {
  pool_->for_ranges(static_cast<int>(x.size()), kChunk, [&](int begin, int end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) y[i] += s * x[i];
  });
}

void CpuVectors::scale(double s, std::span<double> x) const {
  for (double& value : x) value *= s;
}

void CpuVectors::xpay(std::span<const double> x, double s, std::span<double> y) const {
  pool_->for_ranges(static_cast<int>(x.size()), kChunk, [&](int begin, int end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) y[i] = x[i] + s * y[i];
  });
}

}  // namespace fascia
