#pragma once

#include "core/math/mat3.hpp"
#include "core/model/aligned.hpp"

#include <cstddef>
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

/// What a scheme keeps of the step before; empty before the first one.
struct StepMemory {
  double step = 0;                       ///< dt₋ [s]; 0: none
  std::vector<PoseMotion> motion;        ///< x₋
  std::vector<PoseMotion> velocity;      ///< v₋
  std::vector<PoseMotion> acceleration;  ///< newmark: a at the end of the step
  AlignedVector<double> E;               ///< E₋, as in StrainHistory; empty where nothing is damped
};

/// What a step starts from, node by node, in the form above.
struct StepForm {
  TimeScheme scheme = TimeScheme::implicit_euler;
  double h = 0;      ///< [s]; 0: statics
  double reach = 0;  ///< time from the start of the step to where its equations hold [s]
  double step = 0;   ///< dt [s]
  std::vector<PoseMotion> q, w;

  /// x − q − h w
  PoseMotion deviation(const PoseMotion& x, std::size_t node) const {
    return {x.u - q[node].u - w[node].u * h, x.Q - q[node].Q - w[node].Q * h};
  }
};

/// Above this ratio to the step before, BDF2 loses its accuracy (and at 1 + √2 its stability).
inline constexpr double kLargestStepRatio = 2;

/// The scheme with which a step is taken: BDF2 starts, and grows by more than kLargestStepRatio, with the midpoint
/// rule.
inline TimeScheme scheme_of_step(TimeScheme scheme, double dt, const StepMemory& memory) {
  const bool fits = memory.step > 0 && dt <= kLargestStepRatio * (1 + 1e-9) * memory.step;
  return scheme == TimeScheme::bdf2 && !fits ? TimeScheme::midpoint : scheme;
}

}  // namespace fascia
