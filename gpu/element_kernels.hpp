#pragma once

#include "core/physics/element_law.hpp"
#include "gpu/elements.hpp"
#include "gpu/lanes.hpp"

/// Loads of one element, a lane of a batch. N: nodes of an element where the compiler knows them (4), else 0.
namespace fascia::gpu::kernels {

FASCIA_HD inline const double* gradient_of(const ElementBlockView& block, int batch, int point) {
  return block.gradient + (at(batch) * at(block.points) + at(point)) * at(block.nodes) * 3 * kLanes;
}

FASCIA_HD inline Vec3d gradient(const double* base, int node, int lane) {
  return {{row(base, 3 * node, lane), row(base, 3 * node + 1, lane), row(base, 3 * node + 2, lane)}};
}

FASCIA_HD inline int node_of(const ElementBlockView& block, int batch, int corner, int lane) {
  return block.node[(at(batch) * at(block.nodes) + at(corner)) * kLanes + at(lane)];
}

FASCIA_HD inline double* point_rows(double* rows, const ElementBlockView& block, int batch, int point) {
  return rows + (at(batch) * at(block.points) + at(point)) * 9 * kLanes;
}

FASCIA_HD inline ElementMaterial<double> element_material(const ElementBlockView& block, int batch, int lane,
                                                          double inverse_step) {
  const double* base = block.material + at(batch) * 4 * kLanes;
  return {row(base, 0, lane), row(base, 1, lane), block.damped ? row(base, 2, lane) * inverse_step : 0.0,
          block.penalised ? row(base, 3, lane) : 0.0};
}

FASCIA_HD inline void store_corner(const ElementBlockView& block, int batch, int corner, int lane, const Vec3d& force) {
  double* out = block.corners + (at(batch) * at(block.nodes) + at(corner)) * 3 * kLanes;
  for (int i = 0; i < 3; ++i) out[i * kLanes + lane] = force[i];
}

/// Mean of the nodes' values about an averaged element.
FASCIA_HD inline double mean_of_nodes(const ElementBlockView& block, int batch, int lane) {
  double sum = 0;
  for (int a = 0; a < 4; ++a) sum += block.node_pressure[node_of(block, batch, a, lane)];
  return sum * 0.25;
}

/// The points of an element: the displacement gradient H, volume and old strain of each.
template <int N>
struct ElementPoints;

/// The one point of a linear tetrahedron. Gradients of its nodes add up to zero: the last one is not loaded, and no
/// translation gets into H.
template <>
struct ElementPoints<4> {
  static constexpr bool kOne = true;
  const ElementBlockView& block;
  int batch, lane;
  HistoryView history;
  Vec3d g[3];
  double volume;
  Mat3d gradient_at_state;

  FASCIA_HD ElementPoints(const ElementBlockView& b, int element, const HistoryView& past)
      : block(b), batch(element / kLanes), lane(element % kLanes), history(past) {
    const double* base = gradient_of(block, batch, 0);
    for (int a = 0; a < 3; ++a) g[a] = gradient(base, a, lane);
    volume = row(block.volume + at(batch) * kLanes, 0, lane);
  }
  FASCIA_HD Mat3d gradient_of_nodes(const Vec3d* values) const {
    const Vec3d last = values[node_of(block, batch, 3, lane)];
    Mat3d H;
    for (int a = 0; a < 3; ++a) H += outer(values[node_of(block, batch, a, lane)] - last, g[a]);
    return H;
  }
  FASCIA_HD void store_forces(const Mat3d& force) const {
    Vec3d last;
    for (int a = 0; a < 3; ++a) {
      const Vec3d f = force * g[a];
      store_corner(block, batch, a, lane, f);
      last -= f;
    }
    store_corner(block, batch, 3, lane, last);
  }

  FASCIA_HD static constexpr int begin() { return 0; }
  FASCIA_HD static constexpr int end() { return 1; }
  FASCIA_HD const Mat3d& H(int) const { return gradient_at_state; }
  FASCIA_HD double v(int) const { return volume; }
  FASCIA_HD double squared_gradient(int) const {
    return squared_norm(g[0]) + squared_norm(g[1]) + squared_norm(g[2]) + squared_norm(g[0] + g[1] + g[2]);
  }
  FASCIA_HD Mat3d old(int) const {
    return history.E == nullptr ? Mat3d{} : symmetric_matrix(history.E + at(batch) * 6 * kLanes, 0, lane);
  }
};

/// Points of a larger element, some or all: their H has been stored.
template <>
struct ElementPoints<0> {
  static constexpr bool kOne = false;
  const ElementBlockView& block;
  int batch, lane, first, last;
  HistoryView history;
  const double* stored;

  FASCIA_HD int begin() const { return first; }
  FASCIA_HD int end() const { return last; }
  FASCIA_HD Mat3d H(int q) const { return matrix(point(q) * 9 * kLanes + stored, 0, lane); }
  FASCIA_HD double v(int q) const { return row(block.volume + point(q) * kLanes, 0, lane); }
  FASCIA_HD double squared_gradient(int q) const { return row(block.squared_gradient + point(q) * kLanes, 0, lane); }
  FASCIA_HD Mat3d old(int q) const {
    return history.E == nullptr ? Mat3d{} : symmetric_matrix(history.E + point(q) * 6 * kLanes, 0, lane);
  }

 private:
  FASCIA_HD std::size_t point(int q) const { return at(batch) * at(block.points) + at(q); }
};

/// Calls act.operator()<L, N>() for a block's law and size.
template <class Act>
void with_kind(const ElementBlockView& block, const Act& act) {
  const auto with_law = [&]<int N>() {
    switch (block.law) {
      case ElementLaw::linear:
        return act.template operator()<ElementLaw::linear, N>();
      case ElementLaw::corotational:
        return act.template operator()<ElementLaw::corotational, N>();
      case ElementLaw::st_venant_kirchhoff:
        return act.template operator()<ElementLaw::st_venant_kirchhoff, N>();
      case ElementLaw::neo_hookean:
        return act.template operator()<ElementLaw::neo_hookean, N>();
    }
  };
  if (block.one_point())
    with_law.template operator()<4>();
  else
    with_law.template operator()<0>();
}

}  // namespace fascia::gpu::kernels
