#pragma once

#include "core/node/node_mode.hpp"
#include "core/space/space.hpp"
#include "core/step/explicit_view.hpp"

#include <cstdint>

/// Loops of the fastest mode of a state. Frames: the model has nodes that turn.
namespace fascia::loops {

/// A mode's vectors, by degrees of freedom.
struct ModeView {
  ExplicitView s;  ///< at the state
  double *y = nullptr, *v = nullptr, *w = nullptr;
  const double* base = nullptr;  ///< what acts at the state

  template <bool Frames>
  FASCIA_HD ModeNode node(int i) const {
    ModeNode n;
    n.inertia = s.m.inertia + i;
    if constexpr (Frames) {
      n.kind = s.m.nodes.kind[i];
      n.D = s.D[i];
    }
    n.turn = s.m.turn_of(i);
    n.fixed = s.m.fixed[i];
    n.length = s.m.nodes.part_length[s.m.nodes.part[i]];
    return n;
  }
  FASCIA_HD int dof(int i) const { return s.m.nodes.dof[i]; }
};

template <bool Frames>
struct AddModeNoise {
  ModeView m;
  std::uint64_t seed;
  double each;
  FASCIA_HD void operator()(int i) const {
    const auto first = static_cast<std::uint64_t>(m.dof(i));
    add_mode_noise(m.node<Frames>(i), seed + first, each, m.y + m.dof(i));
  }
};

/// v = M⁻¹ y. Sum: v · y; largest: of the motion.
template <bool Frames>
struct SolveMass {
  ModeView m;
  FASCIA_HD void operator()(int i, Sums<1, 1>& sums) const {
    const ModeNode node = m.node<Frames>(i);
    double* v = m.v + m.dof(i);
    sums.v[0] += solve_mass(node, m.y + m.dof(i), v);
    sums.note(0, mode_size(node, v));
  }
};

struct ScaleMode {
  double *y, *v;
  double s;
  FASCIA_HD void operator()(int k) const {
    y[k] *= s;
    v[k] *= s;
  }
};

/// The state, moved along v.
template <bool Frames>
struct MoveAlong {
  ModeView m;
  double reach;
  Vec3d* u;
  Mat3d* D;
  FASCIA_HD void operator()(int i) const {
    const ModeNode node = m.node<Frames>(i);
    Vec3d moved = m.s.u[i];
    Mat3d turned = node.D;
    move_along(node, m.v + m.dof(i), reach, moved, turned);
    u[i] = moved;
    if constexpr (Frames) D[i] = turned;
  }
};

/// w = K v. Sum: v · w.
template <bool Frames>
struct TakeDifference {
  ModeView m;
  double reach;
  FASCIA_HD void operator()(int i, Sums<1>& sums) const {
    const int first = m.dof(i);
    sums.v[0] += take_difference(m.node<Frames>(i), m.base + first, m.v + first, reach, m.w + first);
  }
};

struct NextOfBasis {
  const double *w, *y, *before;
  double a, b;
  double* next;
  FASCIA_HD void operator()(int k) const { next[k] = w[k] - a * y[k] - b * before[k]; }
};

struct CombineBasis {
  double* y[kModeBasis];
  double s[kModeBasis];
  int count;
  FASCIA_HD void operator()(int k) const {
    double sum = 0;
    for (int j = 0; j < count; ++j) sum += s[j] * y[j][k];
    y[0][k] = sum;
  }
};

}  // namespace fascia::loops
