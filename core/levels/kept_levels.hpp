#pragma once

#include "core/linear/cg.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {

/// Says when levels of rigid frames are made and of which tangent, wherever the solve runs. They are kept while the
/// iterations that they take grow by less than half, for as many digits: making them costs as much as ten. Those of an
/// indefinite tangent are made again from its material part; where no levels are definite, blocks are left.
class KeptLevels {
 public:
  /// @param has_material  the material part of the tangent can be had
  /// @param make    make(material): levels of the tangent as it is, or of its material part; false where one of them is
  ///                not positive definite
  /// @param solve   solve(material, options): conjugate gradients with the levels that were made last; an indefinite
  ///                cycle, with which they mean nothing, ends as `not_finite`
  /// @param blocks  blocks(options): with the diagonal's blocks
  template <class Make, class Solve, class Blocks>
  CgReport solve(const CgOptions& options, bool has_material, const Make& make, const Solve& solve,
                 const Blocks& blocks) {
    using enum CgStatus;
    int before = 0;
    const auto counted = [&](CgReport report) {
      report.iterations += before;
      return report;
    };
    if (iterations_ > 0) {
      CgOptions few = options;
      const int enough = static_cast<int>(iterations_ * std::max(1.0, std::log(options.goal()) / std::log(goal_)));
      few.max_iterations = std::min(options.max_iterations, enough + enough / 2 + 2);
      const CgReport report = solve(false, few);
      if (report.status == converged || (report.status == limit && options.timed)) return report;
      before = report.iterations;
    }
    iterations_ = 0;
    if (!material_first_ || !has_material) {
      CgReport report{not_finite, 0, 0, 0};
      ++made_;
      if (make(false)) report = solve(false, options);
      if (report.status == converged && report.iterations > 0) {
        iterations_ = report.iterations;
        goal_ = options.goal();
      }
      if (report.status == converged) failures_ = 0;
      if (report.status == converged || report.status == limit) return counted(report);
      before += report.iterations;
      if (!has_material && report.status == negative_curvature) return counted(report);
    }
    if (has_material) ++made_;
    if (has_material && make(true)) {
      const CgReport report = solve(true, options);
      material_first_ = report.status == negative_curvature;
      if (report.status != not_finite) failures_ = 0;
      if (report.status != not_finite) return counted(report);
      before += report.iterations;
    }
    material_first_ = false;
    ++failures_;
    return counted(blocks(options));
  }

  /// Levels were of no use in one solve after another: making them again costs more than it can bring.
  bool fail() const { return failures_ >= 2; }
  /// How often levels were made.
  int made() const { return made_; }

 private:
  int iterations_ = 0;  ///< that the levels took when they were made; 0: not made, or of no use
  double goal_ = 0;     ///< of the solve that they took them in
  int failures_ = 0;    ///< solves in a row that blocks had to do
  int made_ = 0;
  bool material_first_ = false;  ///< the last tangent was indefinite
};

}  // namespace fascia
