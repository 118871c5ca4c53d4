#include "app/study/richardson.hpp"

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

constexpr double kLowestOrder = 0.3, kHighestOrder = 8;

/// (h1^p − h2^p) / (h2^p − h3^p), which grows with p for h1 > h2 > h3.
double ratio_at(double p, double h1, double h2, double h3) {
  const double a = std::pow(h1 / h2, p), c = std::pow(h3 / h2, p);
  return (a - 1) / (1 - c);
}

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

std::vector<double> difference(std::span<const double> a, std::span<const double> b) {
  std::vector<double> d(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) d[i] = a[i] - b[i];
  return d;
}

}  // namespace

double norm_of(std::span<const double> v) {
  double largest = 0, sum = 0;
  for (const double x : v) largest = std::max(largest, std::abs(x));
  if (largest == 0 || !std::isfinite(largest)) return largest;
  for (const double x : v) sum += (x / largest) * (x / largest);
  return largest * std::sqrt(sum);
}

double distance(std::span<const double> a, std::span<const double> b) { return norm_of(difference(a, b)); }

std::optional<double> observed_order(const Level& first, const Level& second, const Level& third) {
  const std::vector<double> d12 = difference(first.value, second.value), d23 = difference(second.value, third.value);
  const double coarse = norm_of(d12), fine = norm_of(d23);
  // Against one another: the values swing, and no power of h describes them.
  if (!(fine > 0) || !(coarse > 0) || dot(d12, d23) <= 0.5 * coarse * fine) return std::nullopt;
  const double wanted = coarse / fine;
  const auto ratio = [&](double p) { return ratio_at(p, first.h, second.h, third.h); };
  if (wanted < ratio(kLowestOrder) || wanted > ratio(kHighestOrder)) return std::nullopt;
  double low = kLowestOrder, high = kHighestOrder;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (ratio(middle) < wanted ? low : high) = middle;
  }
  return low;
}

std::optional<Limit> limit_of(std::vector<Level> levels) {
  std::sort(levels.begin(), levels.end(), [](const Level& a, const Level& b) { return a.h > b.h; });
  levels.erase(
      std::unique(levels.begin(), levels.end(), [](const Level& a, const Level& b) { return a.h <= b.h * (1 + 1e-9); }),
      levels.end());
  const std::size_t n = levels.size();
  if (n < 2) return std::nullopt;
  const Level &last = levels[n - 1], &before = levels[n - 2];
  Limit limit{last.value, 3 * distance(last.value, before.value), {}};
  if (n < 3) return limit;
  limit.order = observed_order(levels[n - 3], before, last);
  if (!limit.order) return limit;
  const double factor = 1 / (std::pow(before.h / last.h, *limit.order) - 1);
  for (std::size_t i = 0; i < last.value.size(); ++i) limit.value[i] += factor * (last.value[i] - before.value[i]);
  limit.uncertainty = 1.25 * distance(limit.value, last.value);
  return limit;
}

std::optional<double> fitted_order(std::span<const double> h, std::span<const double> error) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < h.size(); ++i) {
    if (!(error[i] > 0) || !(h[i] > 0)) continue;
    const double a = std::log(h[i]), b = std::log(error[i]);
    n += 1;
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
  }
  const double spread = n * xx - x * x;
  if (n < 2 || spread <= 1e-12 * n * xx) return std::nullopt;
  return (n * xy - x * y) / spread;
}

}  // namespace fascia::app
