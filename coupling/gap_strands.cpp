#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "coupling/gap_sides.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

namespace fascia {

namespace {

/// Points no nearer to each other than a spacing, found by the cube of this size that they lie in.
class SpacedPoints {
 public:
  explicit SpacedPoints(double spacing) : spacing_(spacing) {}

  /// Keeps the point unless one that was kept before is too near.
  bool keep(const Vec3d& X) {
    if (!(spacing_ > 0)) return true;
    std::array<std::int64_t, 3> cell{};
    for (int c = 0; c < 3; ++c) cell[at(c)] = static_cast<std::int64_t>(std::floor(X[c] / spacing_));
    for (std::int64_t i = -1; i <= 1; ++i)
      for (std::int64_t j = -1; j <= 1; ++j)
        for (std::int64_t k = -1; k <= 1; ++k) {
          const auto found = kept_.find({cell[0] + i, cell[1] + j, cell[2] + k});
          if (found == kept_.end()) continue;
          for (const Vec3d& Y : found->second)
            if (norm(X - Y) < spacing_ * (1 - kRounding)) return false;
        }
    kept_[cell].push_back(X);
    return true;
  }

 private:
  static constexpr double kRounding = 1e-9;  ///< vertices that are just as far apart as the spacing stay
  double spacing_;
  std::map<std::array<std::int64_t, 3>, std::vector<Vec3d>> kept_;
};

}  // namespace

GapStrands gap_strands(const GapSide& first, const GapSide& second, double spacing) {
  constexpr int pieces = 8;
  const gap_parts::CheckedSides sides = gap_parts::checked_sides(first, second);
  // A spacing far below the triangles' size keeps every vertex; larger cubes keep their numbers small.
  SpacedPoints spaced(spacing > 1e-9 * sides.size ? spacing : 0);
  GapStrands strands;
  for (const Vec3d& X : sides.first.points) {
    Vec3d foot;
    if (sides.to_second.distance(X, &foot) < sides.touching || !spaced.keep(X)) continue;
    for (int k = 0; k <= pieces; ++k) {
      const double s = static_cast<double>(k) / pieces;
      if (k > 0)
        strands.segments.push_back(
            {static_cast<int>(strands.points.size()) - 1, static_cast<int>(strands.points.size())});
      strands.points.push_back(X * (1 - s) + foot * s);
    }
  }
  if (strands.points.empty()) gap_parts::fail_touching(first.body, second.body);
  return strands;
}

}  // namespace fascia
