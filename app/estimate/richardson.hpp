#pragma once

#include <optional>

/// What is left of an error, from results at several resolutions (Richardson, 1911; Roache, 1994).
namespace fascia::app {

/// How far results are apart whose resolutions differ by a factor of two each.
struct LevelDifferences {
  std::optional<double> coarsest;  ///< of the twice coarser and the coarser one
  std::optional<double> coarser;   ///< of the coarser one and the run
  std::optional<double> finer;     ///< of the run and the finer one
};

/// What is known of the order before anything is measured.
struct OrderGuard {
  double assumed = 2;  ///< where it cannot be measured
  double least = 1, most = 4;
};

struct Extrapolation {
  double error = 0;       ///< of the run
  double order = 0;       ///< p of the error c h^p
  bool measured = false;  ///< the order is
  /// The run's error is this times its difference to the finer (or coarser) result: 2^p / (2^p − 1), or 1 / (2^p − 1).
  double factor = 0;
  bool by_finer = false;
};

/// The error of the run, by the finer result where there is one, else by the coarser one; none without both. The order
/// is measured where two differences follow one another, log2 of their ratio, and kept within the guard.
std::optional<Extrapolation> extrapolated(const LevelDifferences& levels, const OrderGuard& guard);

}  // namespace fascia::app
