#pragma once

#include "core/node/node_force.hpp"
#include "core/step/surfaces.hpp"

#include <cmath>

/// Loops over the vertices, faces and shares of surface loads.
namespace fascia::loops {

struct MoveVertex {
  SurfacesView set;
  PoseView pose;

  FASCIA_HD void operator()(int v) const {
    Vec3d u;
    for (int k = set.share_begin[v]; k < set.share_begin[v + 1]; ++k)
      u += share_displacement(set.share[k], pose.u[set.share[k].node], pose.D_of(set.share[k].node));
    set.u[v] = u;
    set.x[v] = set.X[v] - set.datum[set.vertex_surface[v]] + u;
  }
};

/// Areas and weight of the corners of a face, and what it adds to its surface.
struct FaceForces {
  SurfacesView set;
  const double* factors;

  FASCIA_HD void operator()(int f) const {
    const SurfaceFace face = set.face(f);
    const SurfaceRule& rule = set.rule[set.face_surface[f]];
    Vec3d area[kMostFaceNodes], force[kMostFaceNodes];
    add_face_area(face, set.x, [&](int a, const Vec3d& term) { area[a] += term; });
    double* sums = set.face_sums + 3 * static_cast<std::size_t>(f);
    double change = 0, sizes = 0, moment = 0;
    if (rule.has_potential) add_face_volume(face, set.X, set.u, set.x, change, sizes);
    if (squared_norm(rule.weight) > 0)
      add_face_weight(face, set.x, rule.weight * factors[rule.weight_schedule], moment,
                      [&](int a, const Vec3d& term) { force[a] += term; });
    sums[0] = change;
    sums[1] = sizes;
    sums[2] = moment;
    for (int a = 0; a < face.nodes; ++a) {
      set.corner_area[set.face_begin[f] + a] = area[a];
      if (set.corner_weight != nullptr) set.corner_weight[set.face_begin[f] + a] = force[a];
    }
  }
};

struct CornerForces {
  SurfacesView set;
  FASCIA_HD void operator()(int corner, Sums<6>& sums) const {
    for (int i = 0; i < 3; ++i) {
      sums.v[i] += set.corner_area[corner][i];
      sums.v[3 + i] += set.corner_weight[corner][i];
    }
  }
};

struct KeepVertexForces {
  SurfacesView set;
  FASCIA_HD void operator()(int v, const Sums<6>& sums) const {
    set.area[v] = {{sums.v[0], sums.v[1], sums.v[2]}};
    set.weight[v] = {{sums.v[3], sums.v[4], sums.v[5]}};
  }
};

struct FaceSums {
  SurfacesView set;
  FASCIA_HD void operator()(int f, Sums<3>& sums) const {
    for (int k = 0; k < 3; ++k)
      sums.v[k] += set.face_sums[3 * static_cast<std::size_t>(f) + static_cast<std::size_t>(k)];
  }
};

struct KeepSurfaceSums {
  SurfacesView set;
  FASCIA_HD void operator()(int s, const Sums<3>& sums) const {
    for (int k = 0; k < 3; ++k) set.surface_sums[3 * s + k] = sums.v[k];
  }
};

struct SquaredArea {
  SurfacesView set;
  FASCIA_HD void operator()(int v, Sums<1>& sums) const { sums.v[0] += squared_norm(set.area[v]); }
};

struct FindPressure {
  SurfacesView set;
  const double* factors;

  FASCIA_HD void operator()(int s, const Sums<1>& squared_area) const {
    const SurfaceRule& rule = set.rule[s];
    const double* sums = set.surface_sums + 3 * s;
    SurfacePressure now;
    now.pressure = factors[rule.schedule] * rule.pressure;
    if (rule.has_potential)
      now = surface_pressure(rule.pressure, rule.bulk_modulus, rule.rest_volume, rule.volume, factors[rule.schedule],
                             sums[0], sums[1]);
    double* out = set.figures + s * kSurfaceFigures;
    out[kVolumeInside] = now.volume;
    out[kPressure] = now.pressure;
    out[kPotential] = now.energy - sums[2];
    out[kPressureRounding] = now.rounding * std::sqrt(squared_area.v[0]);
    out[kStiffness] = now.stiffness;
  }
};

FASCIA_HD inline void add_share(const SurfaceShare& share, const Vec3d& force, Sums<12>& sums) {
  for (int i = 0; i < 3; ++i) {
    sums.v[i] += share.w * force[i];
    for (int j = 0; j < 3; ++j) sums.v[3 + 3 * i + j] += force[i] * share.b[j];
  }
}

FASCIA_HD inline Mat3d moment_of(const double* nine) {
  Mat3d N;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) N(i, j) = nine[3 * i + j];
  return N;
}

struct ShareForces {
  SurfacesView set;
  FASCIA_HD void operator()(int share, Sums<12>& sums) const {
    const int v = set.share_vertex[share];
    add_share(set.share[share], set.force(v, set.figure(set.vertex_surface[v], kPressure)), sums);
  }
};

struct AddNodeForces {
  const int* loaded;
  NodesView nodes;
  PoseView pose;
  double* load;
  FASCIA_HD void operator()(int row, const Sums<12>& sums) const {
    const int node = loaded[row];
    add_node_force(nodes.kind[node], pose.D_of(node), {{sums.v[0], sums.v[1], sums.v[2]}}, moment_of(sums.v + 3), {},
                   load + nodes.dof[node]);
  }
};

/// @param newton  Newton's pressures within a step, else null
struct TakeTangent {
  SurfacesView set;
  const double *newton, *factors;
  double* pressure;
  Vec3d* gradient;
  FASCIA_HD void operator()(int s) const {
    pressure[s] = newton != nullptr && set.figure(s, kStiffness) > 0 ? newton[s] : set.figure(s, kPressure);
    gradient[s] = set.rule[s].weight * factors[set.rule[s].weight_schedule];
  }
};

/// Takes K / V* of a term into the tangent. @param surface  of each term
struct TakeStiffness {
  SurfacesView set;
  const int* surface;
  double* stiffness;
  FASCIA_HD void operator()(int term) const {
    const double own = set.figure(surface[term], kStiffness);
    stiffness[term] = own > 0 ? own : 0;
  }
};

/// Σ f bᵀ of a rigid frame, with the pressure of the tangent.
struct ShareMoments {
  SurfacesView set;
  const double* pressure;
  FASCIA_HD void operator()(int share, Sums<9>& sums) const {
    const int v = set.share_vertex[share];
    const Vec3d force = set.force(v, pressure[set.vertex_surface[v]]);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) sums.v[3 * i + j] += force[i] * set.share[share].b[j];
  }
};

struct AddNodeBlocks {
  const int* loaded;
  NodesView nodes;
  const Mat3d* Q;
  double* blocks;
  FASCIA_HD void operator()(int row, const Sums<9>& sums) const {
    const int node = loaded[row];
    if (nodes.kind[node] != FrameKind::rigid) return;
    add_rotation_block(blocks + nodes.block[node],
                       rotation_tangent(times_transpose(moment_of(sums.v), Q[node])) * -1.0);
  }
};

struct ShareAreas {
  SurfacesView set;
  FASCIA_HD void operator()(int share, Sums<12>& sums) const {
    add_share(set.share[share], set.area[set.share_vertex[share]], sums);
  }
};

/// Writes what a term's surface has on a node.
struct KeepVolumeGradient {
  const int *term, *node;  ///< of each row
  NodesView nodes;
  const Mat3d* Q;
  std::size_t dofs;
  double* gradients;
  FASCIA_HD void operator()(int row, const Sums<12>& sums) const {
    const int i = node[row];
    double* g = gradients + static_cast<std::size_t>(term[row]) * dofs + nodes.dof[i];
    for (int k = 0; k < 3; ++k) g[k] = sums.v[k];
    add_moment(nodes.kind[i], moment_of(sums.v + 3), Q[i], g + 3);
  }
};

struct MoveVertexAlong {
  SurfacesView set;
  NodesView nodes;
  const Mat3d* Q;
  const double* d;
  Vec3d* dx;
  FASCIA_HD void operator()(int v) const {
    Vec3d moved;
    for (int k = set.share_begin[v]; k < set.share_begin[v + 1]; ++k) {
      const SurfaceShare& share = set.share[k];
      const double* own = d + nodes.dof[share.node];
      const FrameKind kind = nodes.kind[share.node];
      moved += Vec3d{{own[0], own[1], own[2]}} * share.w;
      if (kind != FrameKind::vertex) moved += frame_variation(kind, own + 3, Q[share.node]) * share.b;
    }
    dx[v] = moved;
  }
};

struct FaceProduct {
  SurfacesView set;
  const Vec3d* x;
  const double* pressure;
  const Vec3d *gradient, *dx;
  Vec3d* corner;
  TangentPart part;
  FASCIA_HD void operator()(int f) const {
    const SurfaceFace face = set.face(f);
    const int s = set.face_surface[f];
    Vec3d force[kMostFaceNodes];
    if (part == TangentPart::symmetric || !set.rule[s].has_potential)
      add_face_product(face, x, pressure[s], gradient[s], dx, part,
                       [&](int a, const Vec3d& term) { force[a] += term; });
    for (int a = 0; a < face.nodes; ++a) corner[set.face_begin[f] + a] = force[a];
  }
};

struct CornerVectors {
  const Vec3d* corner;
  FASCIA_HD void operator()(int c, Sums<3>& sums) const {
    for (int i = 0; i < 3; ++i) sums.v[i] += corner[c][i];
  }
};

struct KeepVertexVectors {
  Vec3d* out;
  FASCIA_HD void operator()(int v, const Sums<3>& sums) const { out[v] = {{sums.v[0], sums.v[1], sums.v[2]}}; }
};

struct ShareVectors {
  SurfacesView set;
  const Vec3d* force;
  FASCIA_HD void operator()(int share, Sums<12>& sums) const {
    add_share(set.share[share], force[set.share_vertex[share]], sums);
  }
};

struct AddNodeProduct {
  const int* loaded;
  NodesView nodes;
  const Mat3d* Q;
  double* y;
  FASCIA_HD void operator()(int row, const Sums<12>& sums) const {
    const int node = loaded[row];
    double* out = y + nodes.dof[node];
    for (int k = 0; k < 3; ++k) out[k] += sums.v[k];
    add_moment(nodes.kind[node], moment_of(sums.v + 3), Q[node], out + 3);
  }
};

/// g · d of some terms.
template <int K>
struct VolumeChange {
  const double *g, *d;
  std::size_t dofs;
  int count;
  FASCIA_HD void operator()(int i, Sums<K>& sums) const {
    for (int t = 0; t < K; ++t)
      if (t < count) sums.v[t] += g[static_cast<std::size_t>(t) * dofs + static_cast<std::size_t>(i)] * d[i];
  }
};

template <int K>
struct KeepAlong {
  const double* stiffness;
  double* along;
  int count;
  FASCIA_HD void operator()(const Sums<K>& sums) const {
    for (int t = 0; t < K; ++t)
      if (t < count) along[t] = stiffness[t] * sums.v[t];
  }
};

struct AddVolumes {
  const double *g, *along;
  std::size_t dofs;
  int terms;
  double* y;
  FASCIA_HD void operator()(int i) const {
    double sum = 0;
    for (int t = 0; t < terms; ++t)
      sum += g[static_cast<std::size_t>(t) * dofs + static_cast<std::size_t>(i)] * along[t];
    y[i] += sum;
  }
};

/// The pressure that the last linearised step leads to.
struct AimPressure {
  SurfacesView set;
  const int* surface;
  const double* along;
  double* aimed;
  FASCIA_HD void operator()(int term) const {
    const int s = surface[term];
    if (set.figure(s, kStiffness) > 0) aimed[s] = set.figure(s, kPressure) - along[term];
  }
};

struct ApproachPressure {
  const double* aimed;
  double* newton;
  double step;
  FASCIA_HD void operator()(int s) const { newton[s] += step * (aimed[s] - newton[s]); }
};

}  // namespace fascia::loops
