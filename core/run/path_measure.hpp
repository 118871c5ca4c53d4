#pragma once

#include "core/run/path_following.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace fascia {

/// Dot products over the translations of all nodes.
class Translations {
 public:
  explicit Translations(const Model& model) : dofs_(model.points.dofs) {}
  double dot(std::span<const Vec3d> du, std::span<const double> d) const {
    double sum = 0;
    for (int i = 0; i < dofs_.node_count(); ++i) sum += fascia::dot(du[at(i)], translation(d, i));
    return sum;
  }
  double norm(std::span<const double> d) const {
    double sum = 0;
    for (int i = 0; i < dofs_.node_count(); ++i) sum += squared_norm(translation(d, i));
    return std::sqrt(sum);
  }
  static double norm(std::span<const Vec3d> du) {
    double sum = 0;
    for (const Vec3d& v : du) sum += squared_norm(v);
    return std::sqrt(sum);
  }
  Vec3d translation(std::span<const double> d, int node) const {
    const double* v = d.data() + dofs_.begin(node);
    return Vec3d{{v[0], v[1], v[2]}};
  }

 private:
  const DofLayout& dofs_;
};

/// The displacement of a controlled point along its direction, and its derivative.
///
///   c = n · Σ (w u + D b),   c' · d = n · Σ (w dx + dA b)
inline double controlled_displacement(const ControlledPoint& point, const State& state) {
  Vec3d u;
  for (std::size_t k = 0; k < point.nodes.size(); ++k) {
    const auto node = at(point.nodes[k]);
    u += state.u[node] * point.influences[k].w + state.D[node] * point.influences[k].b;
  }
  return dot(point.direction, u);
}

inline double controlled_rate(const ControlledPoint& point, const Model& model, const State& state,
                              std::span<const double> d) {
  Vec3d du;
  for (std::size_t k = 0; k < point.nodes.size(); ++k) {
    const int node = point.nodes[k];
    const double* v = d.data() + model.points.dofs.begin(node);
    const Mat3d A = Mat3d::identity() + state.D[at(node)];
    du += Vec3d{{v[0], v[1], v[2]}} * point.influences[k].w +
          frame_variation(model.kind(node), v + 3, A) * point.influences[k].b;
  }
  return dot(point.direction, du);
}

/// The translation of a node that a direction moves most.
inline ControlledPoint most_moved(const Model& model, std::span<const double> d) {
  const Translations translations(model);
  int node = 0, axis = 0;
  double largest = 0;
  for (int i = 0; i < model.node_count(); ++i) {
    const Vec3d u = translations.translation(d, i);
    for (int a = 0; a < 3; ++a) {
      // A tie, to rounding, goes to the first.
      if (std::abs(u[a]) <= largest * (1 + 1e-6)) continue;
      largest = std::abs(u[a]);
      node = i;
      axis = a;
    }
  }
  ControlledPoint point;
  point.nodes = {node};
  point.influences.resize(1);
  point.influences[0].w = 1;
  point.direction[axis] = translations.translation(d, node)[axis] < 0 ? -1 : 1;
  return point;
}

/// The load factor over a step as a cubic in s = 0 … 1, from its values and slopes at both ends.
struct LoadCurve {
  double a, da, b, db;

  double value(double s) const {
    const double r = 1 - s;
    return a * (1 + 2 * s) * r * r + da * s * r * r + b * (3 - 2 * s) * s * s - db * r * s * s;
  }
  double slope(double s) const { return 6 * (b - a) * s * (1 - s) + da * (1 - s) * (1 - 3 * s) + db * s * (3 * s - 2); }
  /// Where the curve first comes from below to a value; above 1 where it does not.
  double first_at(double wanted) const {
    constexpr int kPieces = 64;
    for (int k = 1; k <= kPieces; ++k)
      if (value(static_cast<double>(k) / kPieces) >= wanted)
        return bisect((k - 1.0) / kPieces, static_cast<double>(k) / kPieces,
                      [&](double s) { return value(s) < wanted; });
    return 2;
  }
  bool has_extremum() const { return (da > 0) != (db > 0); }
  /// Where it is, between slopes of different sign.
  double extremum() const {
    return bisect(0, 1, [&](double s) { return (slope(s) > 0) == (da > 0); });
  }

 private:
  template <class Before>
  static double bisect(double low, double high, const Before& before) {
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      (before(middle) ? low : high) = middle;
    }
    return high;
  }
};

}  // namespace fascia
