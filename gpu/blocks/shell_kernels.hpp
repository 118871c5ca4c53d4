#pragma once

#include "core/base/index.hpp"
#include "core/physics/shell_triangle.hpp"
#include "gpu/blocks/shells.hpp"
#include "gpu/space/lanes.hpp"

#include <utility>

/// One triangle of a shell, a lane of a batch.
namespace fascia::gpu::kernels {

/// Constants of a triangle, and its frames at a pose in rest axes.
struct ShellLane {
  ShellConstants<double> constants;
  Mat3d axes;
  double viscosity;     ///< β / dt
  const double* given;  ///< rows of the membrane's lanes, those of bending after them; null where nothing fades
  double factor = 1;
  int node[3];
  Vec3d u[3];
  Mat3d D[3];

  template <class T>
  FASCIA_HD ShellLane(const ShellBlockOf<T>& block, int element, const PoseView& pose, const HistoryView& history) {
    const int batch = element / kLanes, lane = element % kLanes;
    const double* rows = block.constants + at(batch) * ShellBlock::kRows * kLanes;
    for (int a = 0; a < 3; ++a)
      for (int j = 0; j < 2; ++j) constants.g[a][j] = row(rows, ShellBlock::kGradients + 2 * a + j, lane);
    for (int k = 0; k < kPacked6; ++k) {
      constants.membrane[k] = row(rows, ShellBlock::kMembrane + k, lane);
      constants.bending[k] = row(rows, ShellBlock::kBending + k, lane);
    }
    axes = matrix(rows, ShellBlock::kAxes, lane);
    viscosity = block.damped ? row(rows, ShellBlock::kDamping, lane) * history.inverse_step : 0.0;
    given = history.given == nullptr ? nullptr : given_rows(history.given, at(2 * batch)) + lane;
    if (given != nullptr) factor = given[kGivenFactors * kLanes];
    for (int a = 0; a < 3; ++a) {
      node[a] = block.node[(at(batch) * 3 + at(a)) * kLanes + at(lane)];
      u[a] = transpose(axes) * pose.u[node[a]];
      D[a] = transpose_times(axes, pose.D_of(node[a]) * axes);
    }
  }
  ShellLane(const ShellLane&) = delete;
  ShellLane& operator=(const ShellLane&) = delete;

  FASCIA_HD double lasting() const { return given[kLastingFactors * kLanes]; }
  FASCIA_HD ShellStrain<double> given_strain() const {
    ShellStrain<double> e;
    for (int k = 0; k < 6; ++k) {
      e.membrane[k] = given[(kGivenStress + k) * kLanes];
      e.bending[k] = given[(kGivenRows + kGivenStress + k) * kLanes];
    }
    return e;
  }
};

FASCIA_HD inline ShellStrain<double> old_strain(const HistoryView& history, int element) {
  ShellStrain<double> strain;
  if (history.E == nullptr) return strain;
  const double* rows = history.E + at(element / kLanes) * 12 * kLanes;
  for (int k = 0; k < 6; ++k) {
    strain.membrane[k] = row(rows, k, element % kLanes);
    strain.bending[k] = row(rows, 6 + k, element % kLanes);
  }
  return strain;
}

/// Elastic and viscous stress.
FASCIA_HD inline ShellStrain<double> total_stress(const ShellLane& shell, const ShellStrain<double>& strain,
                                                  const ShellStrain<double>& old) {
  if (shell.given != nullptr)
    return shell_stress(shell.constants,
                        strain * shell.factor + (strain - old) * shell.viscosity + shell.given_strain());
  return shell_stress(shell.constants, strain + (strain - old) * shell.viscosity);
}

/// Present axes of the element.
FASCIA_HD inline Mat3d present_axes(const ShellLane& shell, const ShellTriangle<double>& triangle) {
  return shell.axes + shell.axes * triangle.turned();
}

template <class T>
FASCIA_HD void store_shell_corner(const ShellBlockOf<T>& block, int element, int corner, const Vec3<T>& force,
                                  const Vec3<T>& torque) {
  T* out = block.corners + (at(element / kLanes) * 3 + at(corner)) * 6 * kLanes + element % kLanes;
  for (int i = 0; i < 3; ++i) {
    out[i * kLanes] = force[i];
    out[(3 + i) * kLanes] = torque[i];
  }
}

/// Square of what rounding leaves in a triangle's forces (core/executor/shell_executor.cpp).
FASCIA_HD inline double rounding_of(const ShellLane& shell, const ShellStrain<double>& e, const ShellNodes<double>& f,
                                    double motion) {
  double gradient = 0, constants = 0, squares = 0;
  for (int a = 0; a < 3; ++a) {
    for (int j = 0; j < 2; ++j) gradient += shell.constants.g[a][j] * shell.constants.g[a][j];
    squares += squared_norm(f.x[a]);
  }
  for (int i = 0; i < 6; ++i) {
    const double m = shell.constants.membrane[i * (i + 1) / 2 + i], b = shell.constants.bending[i * (i + 1) / 2 + i];
    constants += m * m + b * b;
  }
  const double strain = contract(e, e), moved = gradient * motion * motion, stiffness = 1 + shell.viscosity;
  return squares + gradient * constants * stiffness * stiffness * (strain + moved) * (1 + strain);
}

struct ShellForces {
  ShellBlockView block;
  HistoryView history;
  NodesView nodes;
  PoseView pose;
  const double* part_motion;

  FASCIA_HD void operator()(int i) const {
    if (i >= block.count) return;
    const ShellLane shell(block, i, pose, history);
    const ShellTriangle<double> triangle(shell.constants, shell.u, shell.D);
    const ShellStrain<double>& e = triangle.strain();
    const ShellStrain<double> old = old_strain(history, i);
    const ShellNodes<double> f = triangle.forces(total_stress(shell, e, old));
    const Mat3d axes = present_axes(shell, triangle);
    for (int a = 0; a < 3; ++a) store_shell_corner(block, i, a, axes * f.x[a], axes * f.r[a]);
    if (part_motion == nullptr) return;
    const ShellStrain<double> flow = e - old;
    double* quantities = block.quantities + at(i) * kQuantities;
    const ShellStrain<double> stress = shell_stress(shell.constants, e);
    quantities[kElastic] = 0.5 * contract(e, stress);
    quantities[kViscous] = 0.5 * shell.viscosity * contract(flow, shell_stress(shell.constants, flow));
    if (shell.given != nullptr) {  // what never fades is elastic, and the rest of the step's potential viscous
      const double energy = quantities[kElastic];
      quantities[kElastic] = shell.lasting() * energy;
      quantities[kViscous] += (shell.factor - shell.lasting()) * energy + contract(shell.given_strain(), stress);
    }
    quantities[kRounding] = rounding_of(shell, e, f, part_motion[nodes.part[shell.node[0]]]);
  }
};

/// Place of the entry (i, j ≤ i) of a triangle's tangent.
FASCIA_HD constexpr int stiffness_row(int i, int j) { return i * (i + 1) / 2 + j; }

/// Columns of a triangle's tangent for the freedoms of one corner, which a thread computes: rows below the diagonal.
template <class T>
struct ShellStiffness {
  ShellBlockOf<T> block;
  HistoryView history;
  PoseView pose;
  TakenStepView taken;
  const int* dof;
  bool full;

  FASCIA_HD void operator()(int i) const {
    const int b = i / kLanes % 3, lane = i % kLanes, batch = i / kLanes / 3, element = batch * kLanes + lane;
    const ShellLane shell(block, element, pose, history);
    ShellTriangle<double> triangle(shell.constants, shell.u, shell.D);
    triangle.prepare_products(taken.known() ? extrapolated(element)
                                            : total_stress(shell, triangle.strain(), old_strain(history, element)));
    const Mat3d axes = present_axes(shell, triangle);
    T* rows = block.stiffness + at(batch) * kShellStiffness * kLanes + at(lane);
    for (int k = 0; k < 6; ++k) {
      const Vec3d unit = axes.row(k % 3);
      ShellNodes<double> motion;
      for (int a = 0; a < 3; ++a)
        if (a == b) (k < 3 ? motion.x : motion.r)[a] = unit;
      const ShellNodes<double> f = triangle.product(motion, shell.factor + shell.viscosity, full);
      for (int a = 0; a < 3; ++a) {
        if (a < b) continue;
        const Vec3d force = axes * f.x[a], torque = axes * f.r[a];
        for (int r = 0; r < 6; ++r)
          if (a > b || r >= k)
            rows[stiffness_row(6 * a + r, 6 * b + k) * kLanes] = static_cast<T>(r < 3 ? force[r] : torque[r - 3]);
      }
    }
  }

 private:
  /// Stress extrapolated along the step that led here.
  FASCIA_HD ShellStrain<double> extrapolated(int element) const {
    const ShellLane shell(block, element, taken.start, history);
    const ShellTriangle<double> triangle(shell.constants, shell.u, shell.D);
    const Mat3d axes = present_axes(shell, triangle);
    ShellNodes<double> motion;
    for (int a = 0; a < 3; ++a) {
      const double* d = taken.direction.d + dof[shell.node[a]];
      motion.x[a] = transpose(axes) * Vec3d{{d[0], d[1], d[2]}} * taken.length;
      motion.r[a] = transpose(axes) * Vec3d{{d[3], d[4], d[5]}} * taken.length;
    }
    return total_stress(shell, triangle.strain() + triangle.strain_differential(motion), old_strain(history, element));
  }
};

/// y ← y + K x with what a row and its mirror image have; R is a constant so that x and y stay in registers.
template <int R, class T>
FASCIA_HD void multiply_row(const T* rows, const T* x, T* y) {
  for (int c = 0; c < R; ++c) {
    const T K = rows[stiffness_row(R, c) * kLanes];
    y[R] += K * x[c];
    y[c] += K * x[R];
  }
  y[R] += rows[stiffness_row(R, R) * kLanes] * x[R];
}

/// Product of each triangle's tangent with a direction. Of 32 bits, what a translation costs is left out on both sides:
/// displacements count from the first corner's, whose force balances the others'.
template <class T, class V>
struct ShellProduct {
  static constexpr bool kExact = std::is_same_v<T, double>;
  ShellBlockOf<T> block;
  const V* d;
  const int* dof;

  FASCIA_HD void operator()(int i) const {
    const int batch = i / kLanes, lane = i % kLanes;
    const T* rows = block.stiffness + at(batch) * kShellStiffness * kLanes + at(lane);
    T x[18], y[18] = {};
    [[maybe_unused]] const V* first = d + dof[block.node[at(batch) * 3 * kLanes + at(lane)]];
    for (int a = 0; a < 3; ++a) {
      const V* own = d + dof[block.node[(at(batch) * 3 + at(a)) * kLanes + at(lane)]];
      for (int k = 0; k < 6; ++k) x[6 * a + k] = static_cast<T>(kExact || k >= 3 ? own[k] : own[k] - first[k]);
    }
    const auto multiply = [&]<int... R>(std::integer_sequence<int, R...>) { (multiply_row<R>(rows, x, y), ...); };
    multiply(std::make_integer_sequence<int, 18>{});
    if constexpr (!kExact)
      for (int k = 0; k < 3; ++k) y[k] = -(y[6 + k] + y[12 + k]);
    for (int a = 0; a < 3; ++a)
      store_shell_corner(block, i, a, Vec3<T>{{y[6 * a], y[6 * a + 1], y[6 * a + 2]}},
                         Vec3<T>{{y[6 * a + 3], y[6 * a + 4], y[6 * a + 5]}});
  }
};

/// A row of each frame's own block.
template <class T>
struct ShellDiagonal {
  ShellsOf<T> set;
  NodesView nodes;
  double* blocks;

  FASCIA_HD void operator()(int i) const {
    const int node = i / 6, r = i % 6;
    for (int k = set.node_begin[node]; k < set.node_begin[node + 1]; ++k) {
      const int place = set.node_corner[k], a = place / (6 * kLanes) % 3;
      const T* rows = set.stiffness + at(place / (18 * kLanes)) * kShellStiffness * kLanes + place % kLanes;
      double* out = blocks + nodes.block[node] + 6 * r;
      for (int c = 0; c < 6; ++c)
        out[c] += rows[(c <= r ? stiffness_row(6 * a + r, 6 * a + c) : stiffness_row(6 * a + c, 6 * a + r)) * kLanes];
    }
  }
};

struct ShellStrains {
  ShellBlockView block;
  PoseView pose;
  double* E;

  FASCIA_HD void operator()(int i) const {
    const ShellLane shell(block, i, pose, HistoryView{});
    const ShellTriangle<double> triangle(shell.constants, shell.u, shell.D);
    double* rows = E + at(i / kLanes) * 12 * kLanes + i % kLanes;
    for (int k = 0; k < 6; ++k) {
      rows[k * kLanes] = triangle.strain().membrane[k];
      rows[(6 + k) * kLanes] = triangle.strain().bending[k];
    }
  }
};

}  // namespace fascia::gpu::kernels
