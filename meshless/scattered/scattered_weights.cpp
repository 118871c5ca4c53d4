#include "meshless/scattered/scattered_weights.hpp"

#include "core/base/index.hpp"
#include "core/math/principal_axes.hpp"
#include "meshless/kernels.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace fascia {
namespace {

/// A partition of unity in tangent coordinates, in units of a length.
struct Shares {
  double length = 1;  ///< [m]
  std::vector<int> frame;
  std::vector<double> w;
  std::vector<Vec3d> dw;  ///< gradients
  std::vector<Vec3d> s;   ///< x_i − X
  std::vector<double> square_distance;

  void reserve(std::size_t n) {
    frame.reserve(n);
    w.reserve(n);
    dw.reserve(n);
    s.reserve(n);
    square_distance.reserve(n);
  }
  void add(int number, double value, const Vec3d& gradient, const Vec3d& offset, double squared) {
    frame.push_back(number);
    w.push_back(value);
    dw.push_back(gradient);
    s.push_back(offset);
    square_distance.push_back(squared);
  }
};

std::vector<NearFrame> in_order(std::span<const NearFrame> frames) {
  std::vector<NearFrame> sorted(frames.begin(), frames.end());
  const auto before = [](const NearFrame& a, const NearFrame& b) { return a.frame < b.frame; };
  if (!std::is_sorted(sorted.begin(), sorted.end(), before)) std::sort(sorted.begin(), sorted.end(), before);
  return sorted;
}

Vec3d tangent_coordinates(const ScatteredPlace& place, const Vec3d& d) {
  assert(place.dimension >= 1 && place.dimension <= 3);
  Vec3d s;
  for (int a = 0; a < place.dimension; ++a) s[a] = dot(place.axes.column(a), d);
  return s;
}

/// ω_i = W_i / Σ W with its gradient (∇W_i − ω_i Σ ∇W) / Σ W.
template <class Kernel>
Shares kernel_shares(const ScatteredPlace& place, std::span<const NearFrame> frames) {
  std::vector<NearFrame> near = in_order(frames);
  std::erase_if(near, [&](const NearFrame& f) { return !(norm(f.x - place.X) < f.support); });
  Shares r;
  r.reserve(near.size());
  r.length = 0;
  for (const NearFrame& f : near) r.length = std::max(r.length, f.support);

  double total = 0;
  Vec3d total_gradient;
  for (const NearFrame& f : near) {
    const Vec3d d = f.x - place.X;
    const double radius = norm(d) / f.support, ratio = r.length / f.support;
    const Vec3d s = tangent_coordinates(place, d) * (1 / r.length);
    const Vec3d slope = s * (-Kernel::slope_over_radius(radius) * ratio * ratio);
    r.add(f.frame, Kernel::value(radius), slope, s, radius * radius / (ratio * ratio));
    total += r.w.back();
    total_gradient += r.dw.back();
  }
  for (std::size_t i = 0; i < r.w.size(); ++i) {
    r.w[i] /= total;
    r.dw[i] = (r.dw[i] - total_gradient * r.w[i]) * (1 / total);
  }
  return r;
}

ScatteredWeights in_world(const ScatteredPlace& place, Shares&& shares) {
  ScatteredWeights r;
  for (Vec3d& g : shares.dw) g = place.axes * (g * (1 / shares.length));
  r.frame = std::move(shares.frame);
  r.w = std::move(shares.w);
  r.gradient = std::move(shares.dw);
  return r;
}

/// Eigenvectors of a spread that are kept: their projector, and the spread's inverse on them.
struct KeptDirections {
  int count = 0;
  Mat3d projector, inverse;
  double narrowest = 0;  ///< least eigenvalue of those that the matter has

  KeptDirections(const Mat3d& spread, double least, int dimension) {
    const PrincipalAxes principal = principal_axes(spread);
    narrowest = principal.values[3 - dimension];
    for (int k = 0; k < 3; ++k) {
      const double value = principal.values[k];
      if (!(value > least)) continue;
      ++count;
      const Vec3d direction = principal.axes[k];
      projector += outer(direction, direction);
      inverse += outer(direction, direction) * (1 / value);
    }
  }
};

/// Corrects shares to reproduce linear functions of s:
///
///   w = ω (1 − z·q),  z = s − c,  q = C⁺ c
///   ∇w = (1 − z·q) ∇ω + ω (mᵀ q − ∇qᵀ z),  m = ∂c + I = Σ z ∇ωᵀ,  ∂q = C⁺ (m − I − Σ (z·q) z ∇ωᵀ)
///
/// since z moves by −m and C by Σ z zᵀ dω when X moves.
///
/// @param c  Σ ω s
void correct(Shares& shares, const Vec3d& c, const Mat3d& inverse) {
  const std::size_t n = shares.w.size();
  const Vec3d q = inverse * c;
  Mat3d m, weighted;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d z = shares.s[i] - c;
    const Mat3d product = outer(z, shares.dw[i]);
    m += product;
    weighted += product * dot(z, q);
  }
  const Mat3d dq = inverse * (m - Mat3d::identity() - weighted);
  const Vec3d common = transpose(m) * q;
  double sum = 0;
  Vec3d gradient_sum;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d z = shares.s[i] - c;
    const double factor = 1 - dot(z, q);
    shares.dw[i] = shares.dw[i] * factor + (common - transpose(dq) * z) * shares.w[i];
    shares.w[i] *= factor;
    sum += shares.w[i];
    gradient_sum += shares.dw[i];
  }
  // A large q enlarges the rounding of z: the sums are restored.
  for (std::size_t i = 0; i < n; ++i) {
    shares.w[i] /= sum;
    shares.dw[i] -= gradient_sum * shares.w[i];
  }
}

}  // namespace

ScatteredWeights MlsWeights::at(const ScatteredPlace& place, std::span<const NearFrame> frames) {
  Shares shares = kernel_shares<WendlandC2Kernel>(place, frames);
  const std::size_t n = shares.w.size();
  Vec3d c;
  for (std::size_t i = 0; i < n; ++i) c += shares.s[i] * shares.w[i];
  Mat3d spread;
  double square_distance = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d z = shares.s[i] - c;
    spread += outer(z, z) * shares.w[i];
    square_distance += shares.square_distance[i] * shares.w[i];
  }
  const KeptDirections kept(spread, kLeastSpread * square_distance, place.dimension);
  if (kept.count > 0) correct(shares, c, kept.inverse);
  ScatteredWeights r = in_world(place, std::move(shares));
  r.consistent = times_transpose(place.axes * kept.projector, place.axes);
  r.lowered = kept.count < place.dimension;
  r.spread = square_distance > 0 ? std::max(0.0, kept.narrowest) / square_distance : 0;
  return r;
}

ScatteredWeights WendlandWeights::at(const ScatteredPlace& place, std::span<const NearFrame> frames) {
  return in_world(place, kernel_shares<WendlandC2Kernel>(place, frames));
}

ScatteredWeights CubicSplineWeights::at(const ScatteredPlace& place, std::span<const NearFrame> frames) {
  return in_world(place, kernel_shares<CubicSplineKernel>(place, frames));
}

ScatteredWeights ShepardWeights::at(const ScatteredPlace& place, std::span<const NearFrame> frames, int power) {
  ScatteredWeights r;
  if (frames.empty()) return r;
  std::vector<NearFrame> near = in_order(frames);
  std::vector<double> distance(near.size());
  for (std::size_t i = 0; i < near.size(); ++i) distance[i] = norm(near[i].x - place.X);
  const auto closest = static_cast<std::size_t>(std::min_element(distance.begin(), distance.end()) - distance.begin());

  if (distance[closest] == 0) {
    r.frame = {near[closest].frame};
    r.w = {1};
    r.gradient = {Vec3d{}};
    return r;
  }
  // w_i ∝ (closest distance / d_i)^power, and w_i's own logarithm has the gradient l_i = power (x_i − X) / d_i².
  double total = 0;
  std::vector<Vec3d> l(near.size());
  for (std::size_t i = 0; i < near.size(); ++i) {
    r.frame.push_back(near[i].frame);
    r.w.push_back(std::pow(distance[closest] / distance[i], power));
    total += r.w.back();
    const Vec3d direction = tangent_coordinates(place, near[i].x - place.X) * (1 / distance[i]);
    l[i] = place.axes * direction * (power / distance[i]);
  }
  Vec3d mean;
  for (std::size_t i = 0; i < near.size(); ++i) {
    r.w[i] /= total;
    mean += l[i] * r.w[i];
  }
  // The closest frame's l can be huge: its gradient is what makes the sum 0.
  r.gradient.resize(near.size());
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (i == closest) continue;
    r.gradient[i] = (l[i] - mean) * r.w[i];
    r.gradient[closest] -= r.gradient[i];
  }
  return r;
}

}  // namespace fascia
