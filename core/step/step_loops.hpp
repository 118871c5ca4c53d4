#pragma once

#include "core/space/space.hpp"
#include "core/step/step_view.hpp"

/// Loops over nodes of an implicit step. What constraints hold, and the end of a step, are in boundary_loops.hpp.
namespace fascia::loops {

/// u and D of the present increments.
struct RebuildState {
  StepView s;
  FASCIA_HD void operator()(int i) const {
    s.u[i] = s.u0[i] + s.du[i];
    if (s.turning) s.D[i] = incremented(s.model.nodes.kind[i], s.Ds[i], s.D0[i]);
  }
};

/// q and w of the scheme.
struct Predict {
  StepView s;
  const PoseMotion *motion, *velocity, *acceleration;
  FASCIA_HD void operator()(int i) const {
    StepNode n = s.node(i);
    predict(s.step, {of(motion, i), of(velocity, i), of(acceleration, i)}, n);
    const FrameConstraint* held = s.model.held(i);
    if (s.step.scheme == TimeScheme::midpoint && held != nullptr) straighten_held(*held, n.q.u);
    s.q[i] = n.q;
    s.w[i] = n.w;
  }
  FASCIA_HD static const PoseMotion* of(const PoseMotion* all, int i) { return all == nullptr ? nullptr : all + i; }
};

/// Increments along the old velocities, of nodes that nothing holds.
struct PredictIncrement {
  StepView s;
  FASCIA_HD void operator()(int i) const {
    if (s.model.constraint[i] >= 0) return;
    s.du[i] = s.v0[i] * s.step.reach;
    if (s.turning) s.Ds[i] = increment_along(s.model.nodes.kind[i], s.D0[i], s.rate0[i], s.step.reach);
  }
};

/// Where the old velocities lead after a time.
struct MoveByVelocity {
  StepView s;
  double time;
  Vec3d* u;
  Mat3d* D;
  FASCIA_HD void operator()(int i) const {
    const MovedNode moved = moved_by_velocity(s.step, s.node(i), time);
    u[i] = s.u0[i] + moved.du;
    if (s.turning) D[i] = moved.D;
  }
};

/// Dead loads and inertia of the nodes. Sums: their energies.
struct StoreLoadsAndInertia {
  StepView s;
  ForceView f;
  FASCIA_HD void operator()(int i, Sums<2>& sums) const {
    store_loads_and_inertia(s, f, i);
    sums.v[0] += f.node_energy[3 * i];
    sums.v[1] += f.node_energy[3 * i + 1];
  }
};

/// gradient += inertia − load, by degrees of freedom, once all loads are there.
struct AddInertiaAndLoads {
  ForceView f;
  FASCIA_HD void operator()(int k) const { f.gradient[k] += f.inertia[k] - f.load[k]; }
};

/// Sums that a residual is judged by.
struct NodeReport {
  ModelView m;
  ForceView f;
  FASCIA_HD void operator()(int i, Sums<kNodeQuantities>& sums) const {
    const int first = m.nodes.dof[i], n = m.nodes.size(i);
    const double length = m.nodes.part_length[m.nodes.part[i]];
    double load[kMostDofs], inertia[kMostDofs], gradient[kMostDofs];
    for (int k = 0; k < n; ++k) {
      load[k] = f.load[first + k];
      inertia[k] = f.inertia[first + k];
      gradient[k] = f.gradient[first + k];
    }
    m.to_local(i, load);
    m.to_local(i, inertia);
    m.to_local(i, gradient);
    for (int k = 0; k < n; ++k) {
      const double scale = k < 3 ? 1 : 1 / (length * length);
      const bool fixed = m.is_fixed(i, k), carried = (m.carried[i] >> k & 1U) != 0;
      const double left = carried ? gradient[k] + load[k] : gradient[k];
      if (!carried || m.turn[i] >= 0) sums.v[carried ? kTurnedLoad : kLoad] += load[k] * load[k] * scale;
      if (!fixed) sums.v[kInertia] += inertia[k] * inertia[k] * scale;
      sums.v[fixed ? kReaction : kResidual] += left * left * scale;
    }
    sums.v[kLoadEnergy] += f.node_energy[3 * i];
    sums.v[kInertiaEnergy] += f.node_energy[3 * i + 1];
    sums.v[kCancelled] += f.node_energy[3 * i + 2];
  }
};

/// Largest rotation of a frame in a vector by degrees of freedom [rad].
struct LargestRotation {
  NodesView nodes;
  const double* d;
  FASCIA_HD void operator()(int i, Sums<0, 1>& sums) const {
    sums.note(0, rotation_in(nodes.kind[i], d + nodes.dof[i]));
  }
};

/// Displacement of a node, or its rotation over the part's length, whichever is larger.
struct NodeMotion {
  NodesView nodes;
  PoseView pose;
  FASCIA_HD void operator()(int i, Sums<0, 1>& sums) const {
    sums.note(0, norm(pose.u[i]));
    if (pose.D != nullptr && nodes.kind[i] != FrameKind::vertex)
      sums.note(0, nodes.part_length[nodes.part[i]] * norm(pose.D[i]));
  }
};

/// The larger of two, and at least what was at the start.
struct AtLeast {
  const double* least;
  double* value;
  FASCIA_HD void operator()(int p) const {
    if (least[p] > value[p]) value[p] = least[p];
  }
};

/// Ends a sum by writing it.
template <int K, int M>
struct StoreSums {
  double* out;
  FASCIA_HD void operator()(const Sums<K, M>& total) const {
    for (int k = 0; k < K; ++k) out[k] = total.v[k];
    for (int k = 0; k < M; ++k) out[K + k] = total.largest[k];
  }
};

/// E + c (E − E₋)
struct Extrapolate {
  double* E;
  const double* before;
  double c;
  FASCIA_HD void operator()(int k) const { E[k] += c * (E[k] - before[k]); }
};

/// E + h dE/dt, or E − ½ h² d²E/dt², from strains ahead and behind along the velocity.
struct StrainAlongVelocity {
  double* E;
  const double *ahead, *behind;
  bool rate;
  FASCIA_HD void operator()(int k) const {
    E[k] += rate ? 0.5 * (ahead[k] - behind[k]) : -0.5 * (ahead[k] - 2 * E[k] + behind[k]);
  }
};

/// E − dt dE/dt at the end of a step, from the strains at its start and a step before; null: none.
struct StrainFromSteps {
  double* E;
  const double *before, *earlier;
  FASCIA_HD void operator()(int k) const {
    const double increment = E[k] - before[k];
    E[k] -= earlier == nullptr ? increment : end_increment(increment, before[k] - earlier[k]);
  }
};

/// Adds what dead loads and inertia are to the nodes' own blocks.
struct AddLoadAndInertiaBlocks {
  StepView s;
  const Mat3d* Q;
  double* blocks;
  bool full;
  FASCIA_HD void operator()(int i) const {
    add_loads_and_inertia_block(s, i, Q[i], full, blocks + s.model.nodes.block[i]);
  }
};

}  // namespace fascia::loops
