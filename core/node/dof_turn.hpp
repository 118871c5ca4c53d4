#pragma once

#include "core/structure/dof_layout.hpp"

namespace fascia {

/// Axes in which what holds a node are single degrees of freedom, as rows: for its place, and for its rotation.
struct DofTurn {
  int node = 0;
  Mat3d translation{}, rotation{};
};

/// Turns the increments of a node into axes given as rows, those of an affine frame A into R A Rᵀ. Forces turn alike.
/// @param back  from the axes into the world
FASCIA_HD inline void turn_dofs(FrameKind kind, const Mat3d& translation, const Mat3d& rotation, bool back, double* v) {
  const Mat3d T = back ? transpose(translation) : translation;
  const Vec3d u = T * Vec3d{{v[0], v[1], v[2]}};
  for (int i = 0; i < 3; ++i) v[i] = u[i];
  if (kind == FrameKind::vertex) return;
  const Mat3d R = back ? transpose(rotation) : rotation;
  if (kind == FrameKind::rigid) {
    const Vec3d r = R * Vec3d{{v[3], v[4], v[5]}};
    for (int i = 0; i < 3; ++i) v[3 + i] = r[i];
    return;
  }
  const Mat3d A = times_transpose(R * frame_variation(kind, v + 3, {}), R);
  for (int q = 0; q < 3; ++q)
    for (int i = 0; i < 3; ++i) v[3 + 3 * q + i] = A(i, q);
}

/// The block of a row and a column in their axes, T_row K T_colᵀ.
/// @param row_turn, column_turn  null: the axes of the world
FASCIA_HD inline void turn_block(FrameKind row, const DofTurn* row_turn, FrameKind column, const DofTurn* column_turn,
                                 const double* in, double* out) {
  const int n = dof_count(row), m = dof_count(column);
  for (int k = 0; k < n * m; ++k) out[k] = in[k];
  if (column_turn != nullptr)
    for (int i = 0; i < n; ++i) turn_dofs(column, column_turn->translation, column_turn->rotation, false, out + m * i);
  if (row_turn == nullptr) return;
  double v[kMostDofs];
  for (int j = 0; j < m; ++j) {
    for (int i = 0; i < n; ++i) v[i] = out[m * i + j];
    turn_dofs(row, row_turn->translation, row_turn->rotation, false, v);
    for (int i = 0; i < n; ++i) out[m * i + j] = v[i];
  }
}

}  // namespace fascia
