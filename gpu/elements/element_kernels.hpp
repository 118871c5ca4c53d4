#pragma once

#include "core/physics/element_law.hpp"
#include "gpu/elements/elements.hpp"
#include "gpu/space/lanes.hpp"

/// Loads of one element, a lane of a batch. N: nodes of an element where the compiler knows them (4), else 0.
namespace fascia::gpu::kernels {

template <class T>
FASCIA_HD const T* gradient_of(const ElementBlockOf<T>& block, int batch, int point) {
  return block.gradient + (at(batch) * at(block.points) + at(point)) * at(block.nodes) * 3 * kLanes;
}

template <class T>
FASCIA_HD Vec3<T> gradient(const T* base, int node, int lane) {
  return {{row(base, 3 * node, lane), row(base, 3 * node + 1, lane), row(base, 3 * node + 2, lane)}};
}

template <class T>
FASCIA_HD int node_of(const ElementBlockOf<T>& block, int batch, int corner, int lane) {
  return block.node[(at(batch) * at(block.nodes) + at(corner)) * kLanes + at(lane)];
}

template <class T>
FASCIA_HD T* point_rows(T* rows, const ElementBlockOf<T>& block, int batch, int point) {
  return rows + (at(batch) * at(block.points) + at(point)) * 9 * kLanes;
}

/// Rows of what a step gives the points of a batch; only where they remember stresses.
template <class T>
FASCIA_HD const double* given_rows(const ElementBlockOf<T>& block, const HistoryView& history, int batch, int point) {
  return gpu::given_rows(history.given, at(batch) * at(block.points) + at(point));
}
/// Factor on the volumetric modulus, of blocks whose elements fade alike.
FASCIA_HD inline double bulk_factor(const double* given, GivenRow factors = kGivenFactors) {
  return given == nullptr ? 1.0 : given[(factors + 1) * kLanes];
}

template <Law L, class T>
FASCIA_HD ElementSolid<L, T> element_material(const ElementBlockOf<T>& block, int batch, int lane,
                                              const HistoryView& history, GivenRow factors = kGivenFactors) {
  constexpr int kOwn = SolidLaw<L, T>::kOwn;
  const T* base = block.material + at(batch) * at(ElementBlock::kOwnConstants + kOwn) * kLanes;
  ElementSolid<L, T> m;
  m.lambda = row(base, ElementBlock::kLambda, lane);
  m.mu = row(base, ElementBlock::kMu, lane);
  m.viscosity =
      block.damped ? row(base, ElementBlock::kStiffnessDamping, lane) * static_cast<T>(history.inverse_step) : T(0);
  m.penalty = block.penalised ? row(base, ElementBlock::kPenalty, lane) : T(0);
  if constexpr (kOwn > 0)
    for (int k = 0; k < kOwn; ++k) m.own[k] = row(base, ElementBlock::kOwnConstants + k, lane);
  if (history.given != nullptr) scale_constants(law_factors<T>(given_rows(block, history, batch, 0), factors, lane), m);
  return m;
}

template <class T>
FASCIA_HD void store_corner(const ElementBlockOf<T>& block, int batch, int corner, int lane, const Vec3<T>& force) {
  T* out = block.corners + (at(batch) * at(block.nodes) + at(corner)) * 3 * kLanes;
  for (int i = 0; i < 3; ++i) out[i * kLanes + lane] = force[i];
}

/// Mean of the nodes' values about an averaged element.
template <class T>
FASCIA_HD T mean_of_nodes(const ElementBlockOf<T>& block, int batch, int lane) {
  T sum = 0;
  for (int a = 0; a < 4; ++a) sum += block.node_pressure[node_of(block, batch, a, lane)];
  return sum * T(0.25);
}

/// The points of an element: the displacement gradient H, volume and old strain of each.
template <int N, class T>
struct ElementPoints;

/// The one point of a linear tetrahedron. Gradients of its nodes add up to zero: the last one is not loaded, and no
/// translation gets into H.
template <class T>
struct ElementPoints<4, T> {
  static constexpr bool kOne = true;
  const ElementBlockOf<T>& block;
  int batch, lane;
  HistoryView history;
  Vec3<T> g[3];
  T volume;
  Mat3<T> gradient_at_state;

  FASCIA_HD ElementPoints(const ElementBlockOf<T>& b, int element, const HistoryView& past)
      : block(b), batch(element / kLanes), lane(element % kLanes), history(past) {
    const T* base = gradient_of(block, batch, 0);
    for (int a = 0; a < 3; ++a) g[a] = gradient(base, a, lane);
    volume = row(block.volume + at(batch) * kLanes, 0, lane);
  }
  template <class V>
  FASCIA_HD Mat3<T> gradient_of_nodes(const Vec3<V>* values) const {
    const Vec3<V> last = values[node_of(block, batch, 3, lane)];
    Mat3<T> H;
    for (int a = 0; a < 3; ++a) H += outer(rounded<T>(values[node_of(block, batch, a, lane)] - last), g[a]);
    return H;
  }
  FASCIA_HD void store_forces(const Mat3<T>& force) const {
    Vec3<T> last;
    for (int a = 0; a < 3; ++a) {
      const Vec3<T> f = force * g[a];
      store_corner(block, batch, a, lane, f);
      last -= f;
    }
    store_corner(block, batch, 3, lane, last);
  }

  FASCIA_HD static constexpr int begin() { return 0; }
  FASCIA_HD static constexpr int end() { return 1; }
  FASCIA_HD const Mat3<T>& H(int) const { return gradient_at_state; }
  FASCIA_HD T v(int) const { return volume; }
  FASCIA_HD T squared_gradient(int) const {
    return squared_norm(g[0]) + squared_norm(g[1]) + squared_norm(g[2]) + squared_norm(g[0] + g[1] + g[2]);
  }
  FASCIA_HD Mat3<T> old(int) const {
    if (history.E == nullptr) return {};
    return rounded<T>(symmetric_matrix(history.E + at(batch) * 6 * kLanes, 0, lane));
  }
  /// The extrapolated one; to be asked where there are such.
  FASCIA_HD Mat3<T> stress(int) const {
    return rounded<T>(symmetric_matrix(history.S + at(batch) * 6 * kLanes, 0, lane));
  }
  /// S₀, where points remember stresses.
  FASCIA_HD Mat3<T> given(int) const {
    return rounded<T>(symmetric_matrix(given_rows(block, history, batch, 0), kGivenStress, lane));
  }
};

/// Points of a larger element, some or all: their H has been stored.
template <class T>
struct ElementPoints<0, T> {
  static constexpr bool kOne = false;
  const ElementBlockOf<T>& block;
  int batch, lane, first, last;
  HistoryView history;
  const T* stored;

  FASCIA_HD int begin() const { return first; }
  FASCIA_HD int end() const { return last; }
  FASCIA_HD Mat3<T> H(int q) const { return matrix(point(q) * 9 * kLanes + stored, 0, lane); }
  FASCIA_HD T v(int q) const { return row(block.volume + point(q) * kLanes, 0, lane); }
  FASCIA_HD double squared_gradient(int q) const { return row(block.squared_gradient + point(q) * kLanes, 0, lane); }
  FASCIA_HD Mat3<T> old(int q) const {
    if (history.E == nullptr) return {};
    return rounded<T>(symmetric_matrix(history.E + point(q) * 6 * kLanes, 0, lane));
  }
  FASCIA_HD Mat3<T> stress(int q) const {
    return rounded<T>(symmetric_matrix(history.S + point(q) * 6 * kLanes, 0, lane));
  }
  FASCIA_HD Mat3<T> given(int q) const {
    return rounded<T>(symmetric_matrix(given_rows(block, history, batch, q), kGivenStress, lane));
  }

 private:
  FASCIA_HD std::size_t point(int q) const { return at(batch) * at(block.points) + at(q); }
};

}  // namespace fascia::gpu::kernels
