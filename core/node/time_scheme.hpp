#pragma once

#include "core/base/aligned.hpp"
#include "core/math/mat3.hpp"

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace fascia {

/// Implicit schemes. Each is one form: a step has a characteristic time h and, for each node, a motion q and a velocity
/// w, so that with the motion x since the start of the step
///
///   inertia |x − q − h w|² / (2 h²),  mass damping α |x − q|² / (2 h),  velocity (x − q) / h,  strain rate (E − Ê) /
///   h.
///
/// | scheme         | h               | q                            | w              | Ê                |
/// |----------------|-----------------|------------------------------|----------------|------------------|
/// | implicit Euler | dt              | 0                            | v              | E                |
/// | bdf2           | dt (1+r)/(1+2r) | c x₋                         | v + c (v − v₋) | E + c (E − E₋)   |
/// | newmark        | dt/2            | h v                          | v + h a        | E + h dE/dt      |
/// | midpoint       | dt/2            | 0; of rotations −½ h² [ω]² Q | v              | E − ½ h² d²E/dt² |
///
/// r = dt/dt₋ and c = r²/(1+2r) (equal steps: h = 2 dt/3, c = 1/3); x₋ is the motion of the step before, v₋ and E₋ what
/// was at its start. Newmark is β = 1/4, γ = 1/2. The midpoint rule solves for the middle of the step.
enum class TimeScheme { implicit_euler, bdf2, newmark, midpoint };

/// A motion of a node's pose, or its rate.
struct PoseMotion {
  Vec3d u{};  ///< of its place
  Mat3d Q{};  ///< of Q or A

  friend FASCIA_HD PoseMotion operator+(const PoseMotion& a, const PoseMotion& b) { return {a.u + b.u, a.Q + b.Q}; }
  friend FASCIA_HD PoseMotion operator-(const PoseMotion& a, const PoseMotion& b) { return {a.u - b.u, a.Q - b.Q}; }
  friend FASCIA_HD PoseMotion operator*(const PoseMotion& a, double s) { return {a.u * s, a.Q * s}; }
};

/// Motions, rates and strains of the step before that a scheme keeps; empty before the first one.
struct StepMemory {
  double step = 0;                       ///< dt₋ [s]; 0: none
  std::vector<PoseMotion> motion;        ///< x₋
  std::vector<PoseMotion> velocity;      ///< v₋
  std::vector<PoseMotion> acceleration;  ///< newmark: a at the end of the step
  AlignedVector<double> E;               ///< E₋, as in StrainHistory; empty where nothing is damped
};

/// The numbers of a step in the form above.
struct StepConstants {
  TimeScheme scheme = TimeScheme::implicit_euler;
  double h = 0;            ///< [s]; 0: statics
  double reach = 0;        ///< time from the start of the step to where its equations hold [s]
  double step = 0;         ///< dt [s]
  double step_before = 0;  ///< dt₋ [s]; 0: none

  /// @param dt  0: statics
  FASCIA_HD static StepConstants of(TimeScheme scheme, double dt, double step_before) {
    StepConstants c{scheme, dt, dt, dt, step_before};
    if (scheme == TimeScheme::newmark || scheme == TimeScheme::midpoint) c.h = 0.5 * dt;
    if (scheme == TimeScheme::midpoint) c.reach = 0.5 * dt;
    if (scheme == TimeScheme::bdf2) c.h = dt * (step_before + dt) / (step_before + 2 * dt);
    return c;
  }
  /// Steps as long as each other but for rounding of their ends.
  FASCIA_HD static bool equal(double dt, double other) {
    const double apart = dt - other;
    return (apart < 0 ? -apart : apart) <= 1e-9 * dt;
  }
  /// c of bdf2
  FASCIA_HD double memory_factor() const {
    const double r = step / step_before;
    return r * r / (1 + 2 * r);
  }
  /// x − q − h w
  FASCIA_HD PoseMotion deviation(const PoseMotion& x, const PoseMotion& q, const PoseMotion& w) const {
    return {x.u - q.u - w.u * h, x.Q - q.Q - w.Q * h};
  }
};

/// The rate at the end of a step from the increments in it and in the step before, both of the same length; times that
/// length.
FASCIA_HD constexpr double end_increment(double last, double before) { return 1.5 * last - 0.5 * before; }

/// How far tethers were stretched in the middles of the last midpoint steps, the latest first. @tparam Vectors  of each
/// tether [m]; empty: none yet
template <class Vectors>
struct MiddleStretches {
  std::array<double, 3> time{};  ///< [s]
  std::array<Vectors, 3> stretch{};

  bool empty() const { return stretch[0].empty(); }
  /// Where those of a middle go; one that is not later than the last replaces it.
  Vectors& at_middle(double middle) {
    if (!empty() && middle > time[0])
      for (const std::size_t k : {1U, 0U}) {
        std::swap(time[k], time[k + 1]);
        std::swap(stretch[k], stretch[k + 1]);
      }
    time[0] = middle;
    for (const std::size_t k : {1U, 2U})
      if (time[k] >= middle) stretch[k] = {};
    return stretch[0];
  }
  /// Weights of the three in the stretch at the end of a step: it is extrapolated from means of two middles, in which
  /// nothing is left of what changes sign from step to step.
  std::array<double, 3> weights(double end) const {
    if (stretch[1].empty()) return {1, 0, 0};
    if (stretch[2].empty()) return {0.5, 0.5, 0};
    const double r = (2 * end - time[0] - time[1]) / (time[0] - time[2]);
    return {0.5 + 0.5 * r, 0.5, -0.5 * r};
  }
};

/// Above this ratio to the step before, BDF2 loses its accuracy (and at 1 + √2 its stability).
inline constexpr double kLargestStepRatio = 2;

/// The scheme with which a step is taken: BDF2 starts, and grows by more than kLargestStepRatio, with the midpoint
/// rule.
template <class Memory>
TimeScheme scheme_of_step(TimeScheme scheme, double dt, const Memory& memory) {
  const bool fits = memory.step > 0 && dt <= kLargestStepRatio * (1 + 1e-9) * memory.step;
  return scheme == TimeScheme::bdf2 && !fits ? TimeScheme::midpoint : scheme;
}

}  // namespace fascia
