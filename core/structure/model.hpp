#pragma once

#include "core/base/index.hpp"
#include "core/math/rotation.hpp"
#include "core/structure/frame_matrices.hpp"
#include "core/structure/point_set.hpp"
#include "core/structure/surface_load.hpp"

#include <array>
#include <vector>

namespace fascia {

/// Block-lumped inertia of a frame about its origin, in rest axes; the 6×6 block follows from it and from Q.
struct FrameInertia {
  double mass = 0;  ///< m = Σ m_q w [kg]
  Vec3d first{};    ///< c = Σ m_q w d, d = X_q − X_i [kg m]
  Mat3d second{};   ///< S = Σ m_q w d dᵀ [kg m²]

  FASCIA_HD FrameInertia& operator+=(const FrameInertia& o) {
    mass += o.mass;
    first += o.first;
    second += o.second;
    return *this;
  }
  FASCIA_HD FrameInertia& operator*=(double s) {
    mass *= s;
    first *= s;
    second *= s;
    return *this;
  }
};

/// Force and moment state on a frame: energy −(force · u + couple : D); torque keeps its direction in space.
struct NodeLoad {
  int node = 0;
  Vec3d force{};   ///< Σ w f [N]
  Mat3d couple{};  ///< Σ f bᵀ [N m]
  Vec3d torque{};  ///< [N m]
};

/// A load whose directions stay fixed in space; scaled by its schedule's factor.
struct DeadLoad {
  int schedule = 0;  ///< index into LoadState::factors
  std::vector<NodeLoad> nodes;
};

/// A force and a torque at a material point that turn with the blended rotation Σ w Q there; among vertices, with the
/// rotation in F = I + Σ u gᵀ, where the torque acts through the spin of F.
struct FollowerLoad {
  int schedule = 0;
  Vec3d force{}, torque{};  ///< at rest [N], [N m]
  std::vector<int> nodes;
  std::vector<double> w;
  std::vector<Vec3d> b;
  std::vector<Vec3d> g{};  ///< vertices only
};

/// Constraint of a frame: the first `translations` rows of `translation_axes` (and likewise rotations) are prescribed.
/// In an affine frame, a rotation about a row k holds the entries (i, j) and (j, i) of A in these axes, i, j ≠ k.
struct FrameConstraint {
  int node = 0;
  Mat3d translation_axes = Mat3d::identity();
  Mat3d rotation_axes = Mat3d::identity();
  int translations = 0, rotations = 0;
  bool whole = false;                                 ///< affine frames: all of A is held
  std::array<int, 3> translation_motion{-1, -1, -1};  ///< index into Model::motions, −1: held
  std::array<int, 3> rotation_motion{-1, -1, -1};
  /// The motion that turns the frame, −1 where none does.
  FASCIA_HD int turning_motion() const {
    for (const int motion : rotation_motion)
      if (motion >= 0) return motion;
    return -1;
  }
};

/// Ties a material point, or the direction of an arm there, to where a motion takes it: the point of a group of law
/// `tether`. The field of weights that do not interpolate is held so.
struct Tether {
  int group = 0, lane = 0;  ///< of the point set
  Vec3d X{};                ///< rest position [m]
  int motion = -1;          ///< −1: held where it is
  Vec3d arm{};              ///< not 0: not X itself is tied, but the place X + arm relative to X [m]
};

/// A rigid motion of the places X of a boundary, with s the factor of its schedule,
///
///   x = centre + R(axis, s·angle) Q₀ (X − centre) + t₀ + s·translation.
///
/// A schedule moves it from rest, Q₀ = I and t₀ = 0. A driver gives a new end before each step: s goes from 0 to 1
/// during the step, Q₀ and t₀ are where the last one ended.
struct PrescribedMotion {
  int schedule = 0;
  Vec3d translation{}, axis{{0, 0, 1}}, center{};
  double angle = 0;  ///< [rad], may exceed 2π
  bool driven = false;
  Mat3d D_start{};  ///< Q₀ − I
  Vec3d u_start{};  ///< t₀ [m]

  /// Q − I of what turns with the motion.
  FASCIA_HD Mat3d turn(double factor) const {
    return compose_increments(rotation_increment(axis * (angle * factor)), D_start);
  }
  FASCIA_HD Vec3d displacement(const Vec3d& X, double factor) const {
    return turn(factor) * (X - center) + translation * factor + u_start;
  }
};

/// Everything about a scene that does not move.
struct Model {
  std::vector<Vec3d> rest_position;     ///< of the frames [m]
  std::vector<Mat3d> rest_orientation;  ///< of the frames
  std::vector<FrameKind> frame_kind;
  std::vector<FrameInertia> inertia;
  std::vector<FrameInertia> mass_damping;  ///< inertia weighted with α [.../s]; empty where nothing is damped
  PointSet points;
  std::vector<DeadLoad> loads;
  std::vector<FollowerLoad> followers;
  std::vector<SurfaceLoad> surfaces;
  std::vector<PrescribedMotion> motions;
  std::vector<FrameConstraint> constraints;  ///< at most one a frame, ascending
  std::vector<Tether> tethers;

  int node_count() const { return static_cast<int>(rest_position.size()); }
  int dof_count() const { return points.dofs.total(); }
  int constrained_dof_count() const;
  int dependent_dof_count() const;
  int free_dof_count() const { return dof_count() - constrained_dof_count() - dependent_dof_count(); }
  FrameKind kind(int node) const { return frame_kind[at(node)]; }
  bool has_frames() const;  ///< nodes that turn
  /// Elements of the linear law alone, no spring, which turns, and nothing else that does: the tangent stiffness is the
  /// same everywhere.
  bool is_linear() const;
  /// Loads have a potential: no torque that keeps its direction in space, no follower, no pressure on a surface whose
  /// free edges move.
  bool loads_are_conservative() const;
};

/// Moves the inertia and the mass damping of dependent nodes to their hosts, by weight and about the hosts' origins, so
/// that no rigid motion of the whole changes its momentum and energy. A frame with a rotation of its own keeps S about
/// itself.
/// @throws InputError  where a host's mass would not stay positive
void move_inertia_to_hosts(Model& model);

/// Where everything is, and how fast. Rotations as D = Q − I, with Q = R R_restᵀ; of an affine frame, D = A − I.
struct State {
  std::vector<Vec3d> u;                       ///< displacement [m]
  FrameMatrices D;                            ///< Q − I, A − I
  std::vector<Vec3d> v;                       ///< du/dt [m/s]
  FrameMatrices Q_dot;                        ///< dQ/dt [1/s]
  std::vector<std::array<double, 3>> turned;  ///< of each constraint: rotation done about its axes [rad]
  double time = 0;                            ///< [s]; in statics the load factor
  AlignedVector<double> memory{};             ///< of points that remember stresses (MemoryLayout); empty: at rest
  std::vector<double> factors{};              ///< of all schedules, where muscle acts; empty: none, or at rest

  static State at_rest(const Model& model);
};

/// A follower's force and torque turned with the rotation in I + D, and scaled.
struct TurnedFollower {
  Vec3d force{}, torque{};
  Mat3d couple{};  ///< vertices only: Σ f ⊗ dX that works as the torque does [N m]
};
/// @param D  Σ w D of frames, Σ u gᵀ of vertices
FASCIA_HD inline TurnedFollower turned_follower(const Vec3d& force, const Vec3d& torque, const Mat3d& D, bool vertices,
                                                double factor) {
  const Mat3d Q = Mat3d::identity() + polar_increment(D);
  TurnedFollower turned{Q * force * factor, Q * torque * factor, {}};
  if (vertices) turned.couple = skew(turned.torque) * transpose(inverse(Mat3d::identity() + D)) * 0.5;
  return turned;
}

/// Calls act(node, force, couple, torque) for each frame of a follower: turned with the rotation in Σ w Q, and scaled.
template <class Act>
void for_each_share(const FollowerLoad& load, const State& state, double factor, const Act& act) {
  const bool vertices = !load.g.empty();
  Mat3d D;
  for (std::size_t k = 0; k < load.nodes.size(); ++k)
    D += vertices ? outer(state.u[at(load.nodes[k])], load.g[k]) : state.D[at(load.nodes[k])] * load.w[k];
  const auto [force, torque, couple] = turned_follower(load.force, load.torque, D, vertices, factor);
  for (std::size_t k = 0; k < load.nodes.size(); ++k) {
    if (vertices) {
      act(load.nodes[k], force * load.w[k] + couple * load.g[k], Mat3d{}, Vec3d{});
      continue;
    }
    act(load.nodes[k], force * load.w[k], outer(force, load.b[k]), torque * load.w[k]);
  }
}

}  // namespace fascia
