#pragma once

#include "core/math/index.hpp"
#include "core/physics/shell_triangle.hpp"
#include "gpu/lanes.hpp"
#include "gpu/shells.hpp"

/// One triangle of a shell, a lane of a batch.
namespace fascia::gpu::kernels {

/// Constants of a triangle, and its frames at a pose in rest axes.
struct ShellLane {
  ShellConstants<double> constants;
  Mat3d axes;
  double viscosity;  ///< β / dt
  int node[3];
  Vec3d u[3];
  Mat3d D[3];

  FASCIA_HD ShellLane(const ShellBlockView& block, int element, const PoseView& pose, double inverse_step) {
    const int batch = element / kLanes, lane = element % kLanes;
    const double* rows = block.constants + at(batch) * ShellBlock::kRows * kLanes;
    for (int a = 0; a < 3; ++a)
      for (int j = 0; j < 2; ++j) constants.g[a][j] = row(rows, ShellBlock::kGradients + 2 * a + j, lane);
    for (int k = 0; k < kPacked6; ++k) {
      constants.membrane[k] = row(rows, ShellBlock::kMembrane + k, lane);
      constants.bending[k] = row(rows, ShellBlock::kBending + k, lane);
    }
    axes = matrix(rows, ShellBlock::kAxes, lane);
    viscosity = block.damped ? row(rows, ShellBlock::kDamping, lane) * inverse_step : 0.0;
    for (int a = 0; a < 3; ++a) {
      node[a] = block.node[(at(batch) * 3 + at(a)) * kLanes + at(lane)];
      u[a] = transpose(axes) * pose.u[node[a]];
      D[a] = transpose_times(axes, pose.D_of(node[a]) * axes);
    }
  }
  ShellLane(const ShellLane&) = delete;
  ShellLane& operator=(const ShellLane&) = delete;
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
  return shell_stress(shell.constants, strain + (strain - old) * shell.viscosity);
}

/// Present axes of the element.
FASCIA_HD inline Mat3d present_axes(const ShellLane& shell, const ShellTriangle<double>& triangle) {
  return shell.axes + shell.axes * triangle.turned();
}

FASCIA_HD inline void store_shell_corner(const ShellBlockView& block, int element, int corner, const Vec3d& force,
                                         const Vec3d& torque) {
  double* out = block.corners + (at(element / kLanes) * 3 + at(corner)) * 6 * kLanes + element % kLanes;
  for (int i = 0; i < 3; ++i) {
    out[i * kLanes] = force[i];
    out[(3 + i) * kLanes] = torque[i];
  }
}

/// Square of what rounding leaves in a triangle's forces (core/cpu/shell_executor.cpp).
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
    const ShellLane shell(block, i, pose, history.inverse_step);
    const ShellTriangle<double> triangle(shell.constants, shell.u, shell.D);
    const ShellStrain<double>& e = triangle.strain();
    const ShellStrain<double> old = old_strain(history, i);
    const ShellNodes<double> f = triangle.forces(total_stress(shell, e, old));
    const Mat3d axes = present_axes(shell, triangle);
    for (int a = 0; a < 3; ++a) store_shell_corner(block, i, a, axes * f.x[a], axes * f.r[a]);
    if (part_motion == nullptr) return;
    const ShellStrain<double> flow = e - old;
    double* quantities = block.quantities + at(i) * kQuantities;
    quantities[kElastic] = 0.5 * contract(e, shell_stress(shell.constants, e));
    quantities[kViscous] = 0.5 * shell.viscosity * contract(flow, shell_stress(shell.constants, flow));
    quantities[kRounding] = rounding_of(shell, e, f, part_motion[nodes.part[shell.node[0]]]);
  }
};

/// The tangent of a triangle at a pose, ready for directions.
struct ShellTangent {
  ShellLane shell;
  ShellTriangle<double> triangle;
  Mat3d axes;

  FASCIA_HD ShellTangent(const ShellBlockView& block, int element, const PoseView& pose, const HistoryView& history)
      : shell(block, element, pose, history.inverse_step),
        triangle(shell.constants, shell.u, shell.D),
        axes(present_axes(shell, triangle)) {
    triangle.prepare_products(total_stress(shell, triangle.strain(), old_strain(history, element)));
  }
  FASCIA_HD ShellNodes<double> product(const ShellNodes<double>& motion, bool full) const {
    return triangle.product(motion, 1 + shell.viscosity, full);
  }
};

struct ShellProduct {
  ShellBlockView block;
  HistoryView history;
  PoseView pose;
  const double* d;
  const int* dof;
  bool full;

  FASCIA_HD void operator()(int i) const {
    const ShellTangent tangent(block, i, pose, history);
    ShellNodes<double> motion;
    for (int a = 0; a < 3; ++a) {
      const double* own = d + dof[tangent.shell.node[a]];
      motion.x[a] = transpose(tangent.axes) * Vec3d{{own[0], own[1], own[2]}};
      motion.r[a] = transpose(tangent.axes) * Vec3d{{own[3], own[4], own[5]}};
    }
    const ShellNodes<double> f = tangent.product(motion, full);
    for (int a = 0; a < 3; ++a) store_shell_corner(block, i, a, tangent.axes * f.x[a], tangent.axes * f.r[a]);
  }
};

/// Force and torque on each frame for a unit of its own degree of freedom: a thread for each corner.
struct ShellDiagonal {
  ShellBlockView block;
  HistoryView history;
  PoseView pose;
  bool full;
  int freedom;

  FASCIA_HD void operator()(int i) const {
    const int corner = i / kLanes % 3, element = i / kLanes / 3 * kLanes + i % kLanes;
    const ShellTangent tangent(block, element, pose, history);
    ShellNodes<double> motion;
    for (int a = 0; a < 3; ++a)
      if (a == corner) (freedom < 3 ? motion.x : motion.r)[a] = tangent.axes.row(freedom % 3);
    const ShellNodes<double> f = tangent.product(motion, full);
    for (int a = 0; a < 3; ++a)
      if (a == corner) store_shell_corner(block, element, a, tangent.axes * f.x[a], tangent.axes * f.r[a]);
  }
};

/// The next column of each frame's own block: what unit motions left on the corners.
struct ShellDiagonalColumn {
  ShellsView set;
  NodesView nodes;
  double* blocks;
  int freedom;

  FASCIA_HD void operator()(int node) const {
    if (set.node_begin[node] == set.node_begin[node + 1]) return;
    NodeSums sums;
    set.add_sums(node, sums);
    double* out = blocks + nodes.block[node];
    for (int r = 0; r < 3; ++r) {
      out[6 * r + freedom] += sums.force[r];
      out[6 * (3 + r) + freedom] += sums.torque[r];
    }
  }
};

struct ShellStrains {
  ShellBlockView block;
  PoseView pose;
  double* E;

  FASCIA_HD void operator()(int i) const {
    const ShellLane shell(block, i, pose, 0);
    const ShellTriangle<double> triangle(shell.constants, shell.u, shell.D);
    double* rows = E + at(i / kLanes) * 12 * kLanes + i % kLanes;
    for (int k = 0; k < 6; ++k) {
      rows[k * kLanes] = triangle.strain().membrane[k];
      rows[(6 + k) * kLanes] = triangle.strain().bending[k];
    }
  }
};

}  // namespace fascia::gpu::kernels
