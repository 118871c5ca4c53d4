#pragma once

#include "core/math/mat3.hpp"

#include <concepts>
#include <span>
#include <string_view>
#include <vector>

/// Weight functions of frames that lie anywhere. All are partitions of unity, Σ w_i = 1 and Σ ∇w_i = 0, and follow the
/// frames given: the caller picks those in reach.
namespace fascia {

/// A frame near a place.
struct NearFrame {
  int frame = 0;
  Vec3d x{};           ///< rest position [m]
  double support = 0;  ///< radius inside which the frame's kernel is positive [m]
};

/// A rest position of matter.
struct ScatteredPlace {
  Vec3d X{};                       ///< [m]
  Mat3d axes = Mat3d::identity();  ///< orthonormal columns, tangents first
  int dimension = 3;               ///< of the matter, the number of tangents: solid 3, sheet 2, line 1
};

/// Weights at a place, of the frames that have any.
struct ScatteredWeights {
  std::vector<int> frame;       ///< ascending
  std::vector<double> w;        ///< [-]
  std::vector<Vec3d> gradient;  ///< with respect to X, along the tangents only [1/m]

  /// Π, projector on the directions in which linear fields are reproduced: Π (Σ w_i x_i − X) = 0, Π Σ x_i ∇w_iᵀ = Π.
  Mat3d consistent{};
  bool lowered = false;  ///< linear fields are reproduced in fewer directions than the matter has
  /// Tells, of moving least squares, how wide the frames are spread in their narrowest direction of the matter, the
  /// smallest eigenvalue there of C over Σ ω |x_i − X|² (MlsWeights); 1 of others [-].
  double spread = 1;
};

/// Weights at a place that are kept elsewhere; members as of ScatteredWeights.
struct WeightsView {
  std::span<const int> frame;
  std::span<const double> w;
  std::span<const Vec3d> gradient;
  Mat3d consistent{};
  bool lowered = false;
  double spread = 1;

  WeightsView(std::span<const int> frames, std::span<const double> weights, std::span<const Vec3d> gradients,
              const Mat3d& projector, bool is_lowered, double frames_spread)
      : frame(frames),
        w(weights),
        gradient(gradients),
        consistent(projector),
        lowered(is_lowered),
        spread(frames_spread) {}
  /// What is seen must outlive the view.
  WeightsView(const ScatteredWeights& r) : WeightsView(r.frame, r.w, r.gradient, r.consistent, r.lowered, r.spread) {}
};

/// What a builder needs of a weight function of scattered frames. at() gives nothing where no frame is in reach. The
/// frames given are distinct, in any order.
template <class W>
concept ScatteredWeightFunction = requires(const ScatteredPlace& place, std::span<const NearFrame> frames) {
  { W::kReproducesLinear } -> std::convertible_to<bool>;
  { W::kFullName } -> std::convertible_to<std::string_view>;
  { W::at(place, frames) } -> std::same_as<ScatteredWeights>;
};

/// Moving least squares: Wendland's kernel, corrected to reproduce linear fields of the tangent coordinates.
///
///   ω_i = W_i / Σ W,  s_i = Tᵀ (x_i − X),  c = Σ ω s,  C = Σ ω (s − c)(s − c)ᵀ,  w_i = ω_i (1 − (s_i − c)ᵀ C⁺ c)
///
/// C⁺ leaves out the eigenvectors of C whose eigenvalue is below kLeastSpread Σ ω |x_i − X|²: across these the frames
/// in reach hardly differ (coplanar, collinear or too few), and a slope taken from them would be noise. The kept
/// directions count as constant in the gradient, which keeps the identities of Π exact; with none kept, w = ω.
/// Weights are as smooth as the kernel where the kept directions do not change.
struct MlsWeights {
  static constexpr bool kReproducesLinear = true;
  static constexpr std::string_view kFullName = "moving least squares";
  /// Measured with supports of 1.8 spacings, boundaries and corners included: at least 0.14 on a regular grid, 0.08
  /// with frames moved by up to 0.2 spacings, 0.014 by up to 0.5. Below 1e-3, Σ |w| of 20 to thousands was met.
  static constexpr double kLeastSpread = 1e-3;
  static ScatteredWeights at(const ScatteredPlace& place, std::span<const NearFrame> frames);
};

/// Normalised kernels of Wendland.
struct WendlandWeights {
  static constexpr bool kReproducesLinear = false;
  static constexpr std::string_view kFullName = "Wendland C2";
  static ScatteredWeights at(const ScatteredPlace& place, std::span<const NearFrame> frames);
};

/// Normalised cubic splines.
struct CubicSplineWeights {
  static constexpr bool kReproducesLinear = false;
  static constexpr std::string_view kFullName = "cubic spline";
  static ScatteredWeights at(const ScatteredPlace& place, std::span<const NearFrame> frames);
};

/// Shepard's inverse distances, w_i ∝ |x_i − X|^−power, of all frames given: supports play no part. A frame at X takes
/// all the weight, with gradient 0.
struct ShepardWeights {
  static constexpr bool kReproducesLinear = false;
  static constexpr std::string_view kFullName = "Shepard";
  static constexpr int kPower = 2;
  /// @param power  above 1, where the functions are smooth at the frames
  static ScatteredWeights at(const ScatteredPlace& place, std::span<const NearFrame> frames, int power = kPower);
};

}  // namespace fascia
