#pragma once

#include "core/executor/element_executor.hpp"
#include "core/executor/group_kernels.hpp"
#include "core/physics/corotational.hpp"
#include "core/physics/element_law.hpp"

/// Loads of a batch of elements. N: nodes of an element where the compiler knows them (4), else 0.
namespace fascia::kernels {

inline constexpr int kMostElementNodes = 20, kMostElementPoints = 27;

template <int N>
constexpr int kRoom = N == 0 ? kMostElementNodes : N;

template <int N>
int nodes_of(const ElementBlock& block) {
  return N == 0 ? block.nodes : N;
}
template <int N>
int points_of(const ElementBlock& block) {
  return N == 4 ? 1 : block.points;
}

/// Vectors of the nodes of a batch, from those of its patch.
template <int N>
inline void gather(const ElementBlock& block, int batch, int half, const Vec3d* patch, Vec3<Lanes>* out) {
  const std::uint16_t* local = block.local_of(batch) + half * kBatchWidth;
  for (int a = 0; a < nodes_of<N>(block); ++a, local += kElementLanes)
    for (int k = 0; k < 3; ++k) out[a][k] = lanes_of([&](int lane) { return patch[local[lane]][k]; });
}

/// Adds vectors of the nodes of a batch to those of its patch.
template <int N>
inline void scatter(const ElementBlock& block, int batch, int half, const Vec3<Lanes>* in, Vec3d* patch) {
  const std::uint16_t* local = block.local_of(batch) + half * kBatchWidth;
  for (int a = 0; a < nodes_of<N>(block); ++a) {
    alignas(64) double rows[3][kBatchWidth];
    for (int k = 0; k < 3; ++k) in[a][k].store(rows[k]);
    for (int lane = 0; lane < kBatchWidth; ++lane) {
      Vec3d& x = patch[local[a * kElementLanes + lane]];
      for (int k = 0; k < 3; ++k) x[k] += rows[k][lane];
    }
  }
}

inline Vec3<Lanes> gradient(const double* base, int node, int half) {
  return {{row(base, 3 * node, half), row(base, 3 * node + 1, half), row(base, 3 * node + 2, half)}};
}

/// Σ u gᵀ
template <int N>
inline Mat3<Lanes> displacement_gradient(const ElementBlock& block, const double* g, int half, const Vec3<Lanes>* u) {
  Mat3<Lanes> H;
  for (int a = 0; a < nodes_of<N>(block); ++a) H += outer(u[a], gradient(g, a, half));
  return H;
}

/// Rows of what a step gives the points of a batch; only where they remember stresses.
inline const double* given_rows(const ElementBlock& block, const BlockState& state, int batch, int q) {
  return given_rows(state.given, at(batch) * at(block.points) + at(q));
}
/// S₀ of a point, which stays during the step.
inline Mat3<Lanes> given_stress(const ElementBlock& block, const BlockState& state, int batch, int q, int half) {
  return symmetric_matrix(given_rows(block, state, batch, q), kGivenStress, half);
}
/// Factor on the volumetric modulus, of blocks whose elements fade alike.
inline double bulk_factor(const BlockState& state) {
  return state.given.empty() ? 1.0 : state.given[(kGivenFactors + 1) * kElementLanes];
}

template <Law L>
ElementSolid<L, Lanes> element_material(const ElementBlock& block, int batch, int half, const BlockState& state,
                                        GivenRow factors = kGivenFactors) {
  const double* base = block.material_of(batch);
  ElementSolid<L, Lanes> m;
  m.lambda = row(base, ElementBlock::kLambda, half);
  m.mu = row(base, ElementBlock::kMu, half);
  m.viscosity = row(base, ElementBlock::kStiffnessDamping, half) * Lanes(state.inverse_step);
  m.penalty = row(base, ElementBlock::kPenalty, half);
  if constexpr (constexpr int kOwn = SolidLaw<L, Lanes>::kOwn; kOwn > 0)
    for (int k = 0; k < kOwn; ++k) m.own[k] = row(base, ElementBlock::kOwnConstants + k, half);
  if (!state.given.empty()) scale_constants(law_factors(given_rows(block, state, batch, 0), factors, half), m);
  return m;
}

/// Place of a symmetric matrix of each point in an array of the layout of strains.
inline std::size_t symmetric_row(const ElementBlock& block, int batch, int q) {
  return (at(batch) * at(block.points) + at(q)) * 6 * kElementLanes;
}

/// Strain at the start of the step; zero where nothing is damped.
inline Mat3<Lanes> old_strain(const ElementBlock& block, std::span<const double> E, int batch, int q, int half) {
  if (E.empty()) return {};
  return symmetric_matrix(E.data() + symmetric_row(block, batch, q), 0, half);
}

/// Mean of λ θ about the nodes of a batch.
inline Lanes mean_pressure(const ElementBlock& block, int batch, int half, std::span<const int> nodes,
                           const std::vector<double>& node_pressure) {
  const std::uint16_t* local = block.local_of(batch) + half * kBatchWidth;
  Lanes sum;
  for (int a = 0; a < 4; ++a)
    for (int lane = 0; lane < kBatchWidth; ++lane)
      sum.v[lane] += node_pressure[at(nodes[local[a * kElementLanes + lane]])];
  return sum * Lanes(0.25);
}

/// The points of a batch of elements at a state: displacement gradients and volumes.
template <int N>
struct BatchPoints {
  static constexpr int kPoints = N == 4 ? 1 : kMostElementPoints;
  const ElementBlock& block;
  int batch, half;
  Mat3<Lanes> H[kPoints];
  Lanes volume;  ///< of the element at rest [m³]

  BatchPoints(const ElementBlock& b, int batch_number, int half_number, const Vec3<Lanes>* u)
      : block(b), batch(batch_number), half(half_number) {
    for (int q = 0; q < count(); ++q) {
      H[q] = displacement_gradient<N>(block, block.gradient_of(batch, q), half, u);
      volume += v(q);
    }
  }
  /// Not 0 in lanes that are not used.
  Lanes safe_volume() const { return where_positive(volume, volume, Lanes(1)); }
  int count() const { return points_of<N>(block); }
  Lanes v(int q) const { return row(block.volume_of(batch, q), 0, half); }
  Mat3<Lanes> mean(const Mat3<Lanes>* values) const {
    if constexpr (N == 4) return values[0];
    Mat3<Lanes> sum;
    for (int q = 0; q < count(); ++q) sum += values[q] * v(q);
    return sum * (Lanes(1) / safe_volume());
  }
};

/// s = (V − V₀)/V₀ of the cells.
template <int N>
Lanes swelling(const BatchPoints<N>& points) {
  Lanes sum;
  for (int q = 0; q < points.count(); ++q) sum += points.v(q) * volume_change(points.H[q]);
  return sum / points.safe_volume();
}

}  // namespace fascia::kernels
