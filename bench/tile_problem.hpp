#pragma once

#include "core/math/rotation.hpp"
#include "core/physics/point_physics.hpp"
#include "gpu/tiles/tile_points.hpp"

#include "core/base/thread_pool.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

/// A meshless solid of any size that is neither at rest nor easy to solve, and what a processor makes of it.
namespace fascia::bench {

/// A number in [0, 1) for each pair of numbers.
inline double random_number(std::uint64_t a, std::uint64_t b) {
  std::uint64_t x = a * 0x9E3779B97F4A7C15ULL + b * 0xD1B54A32D192ED03ULL + 0x2545F4914F6CDD1DULL;
  x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ x >> 27) * 0x94D049BB133111EBULL;
  return static_cast<double>((x ^ x >> 31) >> 11) * 0x1p-53;
}

/// A grid of frames, random points, and for each point the K largest of eight trilinear weights, made to sum to 1.
struct TileProblem {
  TilePoints points;
  std::vector<Vec3d> u;
  std::vector<Mat3d> D;
  std::vector<double> node_blocks;  ///< (frames × 36)
  std::vector<double> b;            ///< (frames × 6)
};

inline TileProblem make_problem(int point_count, int K, double blend, double drilling, ThreadPool& pool) {
  const int per_frame = K <= 4 ? 5 : 8;
  const int n = std::max(2, static_cast<int>(std::lround(std::cbrt(static_cast<double>(point_count) / per_frame))));
  TileProblem p;
  TilePoints& out = p.points;
  for (int i = 0; i < n * n * n; ++i)
    out.rest_position.push_back({{double(i % n), double(i / n % n), double(i / (n * n))}});
  out.materials = {{1.5, 1.0, drilling, 0.0}};
  out.drilling = drilling > 0;
  const std::size_t count = at(point_count);
  out.X.resize(count);
  out.volume.assign(count, std::pow(n - 1, 3) / point_count);
  out.blend.assign(count, blend);
  out.material.assign(count, 0);
  out.begin.resize(count + 1);
  out.node.resize(count * at(K));
  out.w.resize(count * at(K));
  out.g.resize(count * at(K));
  pool.for_ranges(point_count, 4096, [&](int begin, int end) {
    for (int q = begin; q < end; ++q) {
      Vec3d& X = out.X[at(q)];
      std::array<int, 3> cell{};
      for (int a = 0; a < 3; ++a) {
        X[a] = (n - 1) * random_number(static_cast<std::uint64_t>(q), static_cast<std::uint64_t>(a));
        cell[at(a)] = std::min(static_cast<int>(X[a]), n - 2);
      }
      struct Hat {
        int node;
        double w;
        Vec3d g;
      };
      std::array<Hat, 8> hats;
      for (int k = 0; k < 8; ++k) {
        double f[3], df[3];
        int node = 0, stride = 1;
        for (int a = 0; a < 3; ++a) {
          const int upper = k >> a & 1;
          const double xi = X[a] - cell[at(a)];
          f[a] = upper != 0 ? xi : 1 - xi;
          df[a] = upper != 0 ? 1 : -1;
          node += (cell[at(a)] + upper) * stride;
          stride *= n;
        }
        hats[at(k)] = {node, f[0] * f[1] * f[2], {{df[0] * f[1] * f[2], f[0] * df[1] * f[2], f[0] * f[1] * df[2]}}};
      }
      std::sort(hats.begin(), hats.end(), [](const Hat& a, const Hat& b) { return a.w > b.w; });
      double sum = 0;
      Vec3d slope;
      for (int k = 0; k < K; ++k) {
        sum += hats[at(k)].w;
        slope += hats[at(k)].g;
      }
      out.begin[at(q) + 1] = at(K) * (at(q) + 1);
      for (int k = 0; k < K; ++k) {
        const std::size_t i = at(q) * at(K) + at(k);
        out.node[i] = hats[at(k)].node;
        out.w[i] = hats[at(k)].w / sum;
        out.g[i] = hats[at(k)].g * (1 / sum) - slope * (hats[at(k)].w / (sum * sum));
      }
    }
  });
  const auto frames = static_cast<std::uint64_t>(n * n * n);
  for (std::uint64_t f = 0; f < frames; ++f) {
    const auto r = [&](std::uint64_t k) { return 2 * random_number(f + (1ULL << 40), k) - 1; };
    p.u.push_back({{0.02 * r(0), 0.02 * r(1), 0.02 * r(2)}});
    p.D.push_back(rotation_increment({{0.05 * r(3), 0.05 * r(4), 0.05 * r(5)}}));
    for (int i = 0; i < 36; ++i) p.node_blocks.push_back(i % 7 == 0 ? 1.5e-3 + 0.5e-3 * r(6) : 2e-4 * r(7));
    for (int i = 0; i < 6; ++i) p.b.push_back(r(8 + static_cast<std::uint64_t>(i)));
  }
  return p;
}

/// Products and forces by the general formula, one point after the other.
class TileReference {
 public:
  explicit TileReference(const TileProblem& problem) : p_(problem) {
    for (const Mat3d& D : p_.D) Q_.push_back(Mat3d::identity() + D);
    for (int q = 0; q < p_.points.point_count(); ++q) {
      const PointMotion<double> x = motion(
          q, [&](int node) { return p_.u[at(node)]; }, [&](int node) { return p_.D[at(node)]; });
      points_.push_back(x);
    }
  }

  std::vector<double> product(const std::vector<double>& x) const {
    std::vector<double> y(x.size(), 0.0);
    for (int q = 0; q < p_.points.point_count(); ++q) {
      const PointMotion<double> d = motion(
          q, [&](int node) { return translation(x, node); },
          [&](int node) { return skew(rotation(x, node)) * Q_[at(node)]; });
      const auto s = differential(q, d);
      scatter(q, s.dP, s.dY, y);
    }
    for (std::size_t f = 0; f < Q_.size(); ++f)
      for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = 0; j < 6; ++j) y[6 * f + i] += block(f, i, j) * x[6 * f + j];
    return y;
  }

  std::vector<double> gradient(double& energy) const {
    std::vector<double> y(6 * Q_.size(), 0.0);
    energy = 0;
    for (int q = 0; q < p_.points.point_count(); ++q) {
      const PointMotion<double>& x = points_[at(q)];
      const auto s = stress(q, x);
      scatter(q, s.P, s.Y, y);
      const auto e = drilling() ? point_energy<Stabilization::drilling>(x, material(q), Mat3d{})
                                : point_energy<Stabilization::none>(x, material(q), Mat3d{});
      energy += e.elastic + e.stabilization;
    }
    return y;
  }

  /// Own blocks of frames (frames × 36).
  std::vector<double> diagonal() const {
    std::vector<double> blocks(36 * Q_.size(), 0.0);
    const TilePoints& points = p_.points;
    for (int q = 0; q < points.point_count(); ++q) {
      for (std::size_t k = points.begin[at(q)]; k < points.begin[at(q) + 1]; ++k) {
        for (std::size_t column = 0; column < 6; ++column) {
          std::vector<double> unit(6, 0.0), y(6, 0.0);
          unit[column] = 1;
          const std::size_t f = at(points.node[k]);
          PointMotion<double> d;
          add_influence(q, k, {{unit[0], unit[1], unit[2]}}, skew(Vec3d{{unit[3], unit[4], unit[5]}}) * Q_[f], d);
          const auto s = differential(q, d);
          add_force(q, k, s.dP, s.dY, y.data());
          for (std::size_t i = 0; i < 6; ++i) blocks[36 * f + 6 * i + column] += y[i];
        }
      }
    }
    for (std::size_t f = 0; f < Q_.size(); ++f)
      for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = 0; j < 6; ++j) blocks[36 * f + 6 * i + j] += block(f, i, j);
    return blocks;
  }

 private:
  bool drilling() const { return p_.points.drilling; }
  double block(std::size_t f, std::size_t i, std::size_t j) const {
    return 0.5 * (p_.node_blocks[36 * f + 6 * i + j] + p_.node_blocks[36 * f + 6 * j + i]);
  }
  static Vec3d translation(const std::vector<double>& x, int node) {
    return {{x[at(6 * node)], x[at(6 * node + 1)], x[at(6 * node + 2)]}};
  }
  static Vec3d rotation(const std::vector<double>& x, int node) {
    return {{x[at(6 * node + 3)], x[at(6 * node + 4)], x[at(6 * node + 5)]}};
  }
  Mat3d gradient_of_lever(int q, std::size_t k) const {
    const TilePoints& t = p_.points;
    return (outer(t.X[at(q)] - t.rest_position[at(t.node[k])], t.g[k]) + Mat3d::diagonal(t.w[k])) * t.blend[at(q)];
  }
  void add_influence(int q, std::size_t k, const Vec3d& u, const Mat3d& D, PointMotion<double>& x) const {
    x.H += outer(u, p_.points.g[k]) + D * gradient_of_lever(q, k);
    x.Dbar += D * p_.points.w[k];
  }
  template <class Translation, class Turn>
  PointMotion<double> motion(int q, const Translation& u, const Turn& D) const {
    PointMotion<double> x;
    for (std::size_t k = p_.points.begin[at(q)]; k < p_.points.begin[at(q) + 1]; ++k)
      add_influence(q, k, u(p_.points.node[k]), D(p_.points.node[k]), x);
    return x;
  }
  SolidMaterial<Law::st_venant_kirchhoff, double> material(int q) const {
    const TileMaterial& m = p_.points.materials[at(p_.points.material[at(q)])];
    SolidMaterial<Law::st_venant_kirchhoff, double> r;
    r.volume = p_.points.volume[at(q)];
    r.lambda = m.lambda;
    r.mu = m.mu;
    r.stabilization = m.stabilization;
    r.viscosity = 0;
    return r;
  }
  PointStress<double> stress(int q, const PointMotion<double>& x) const {
    return drilling() ? point_stress<Stabilization::drilling>(x, material(q), Mat3d{})
                      : point_stress<Stabilization::none>(x, material(q), Mat3d{});
  }
  PointStressDifferential<double> differential(int q, const PointMotion<double>& d) const {
    return drilling() ? differential_of<Stabilization::drilling>(q, d) : differential_of<Stabilization::none>(q, d);
  }
  template <Stabilization Tie>
  PointStressDifferential<double> differential_of(int q, const PointMotion<double>& d) const {
    const PointMotion<double>& x = points_[at(q)];
    return point_stress_differential<Tie>(x, tangent_stress<Tie>(x, material(q), Mat3d{}), material(q), Tangent::full,
                                          d);
  }
  void add_force(int q, std::size_t k, const Mat3d& P, const Mat3d& Y, double* y) const {
    const double v = p_.points.volume[at(q)];
    const Vec3d f = P * p_.points.g[k] * v;
    const Mat3d N = (times_transpose(P, gradient_of_lever(q, k)) + Y * p_.points.w[k]) * v;
    const Vec3d torque = axl(times_transpose(Q_[at(p_.points.node[k])], N));
    for (int i = 0; i < 3; ++i) {
      y[i] += f[i];
      y[3 + i] += torque[i];
    }
  }
  void scatter(int q, const Mat3d& P, const Mat3d& Y, std::vector<double>& y) const {
    for (std::size_t k = p_.points.begin[at(q)]; k < p_.points.begin[at(q) + 1]; ++k)
      add_force(q, k, P, Y, y.data() + 6 * at(p_.points.node[k]));
  }

  const TileProblem& p_;
  std::vector<Mat3d> Q_;
  std::vector<PointMotion<double>> points_;
};

}  // namespace fascia::bench
