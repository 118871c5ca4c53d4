#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "core/geometry/bounds.hpp"
#include "core/geometry/text.hpp"
#include "core/math/principal_axes.hpp"
#include "coupling/gap_sides.hpp"
#include "coupling/rigid_body.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {

using namespace gap_parts;

namespace {

using message::text;

/// The direction in which a side is long.
Vec3d length_axis(const TriangleMesh& faces, const std::string& body) {
  constexpr double least_ratio = 1.2;  // of a strip's length to its width
  const MassProperties area = properties_of_area(faces);
  const PrincipalAxes spread = principal_axes(area.second);
  const double ratio = std::sqrt(spread.values[2] / std::max(spread.values[1], 0.0));
  if (!(ratio >= least_ratio))
    throw InputError("the selected part of body \"" + body + "\" is only " + text(ratio) +
                     " times as long as it is wide: a sheet needs a strip to start from; select one with where, or "
                     "use as = \"volume\"");
  const Vec3d axis = spread.axes[2];
  // Of its two ways the one along the coordinate axis that it is nearest to.
  int main = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(axis[i]) > std::abs(axis[main])) main = i;
  return axis[main] < 0 ? -axis : axis;
}

/// A corner of a polygon, and how far along the strip it is.
struct Place {
  Vec3d X;
  double s = 0;
};

/// What of a convex polygon lies where sign · s ≥ sign · from.
std::vector<Place> clipped(const std::vector<Place>& polygon, double from, double sign) {
  std::vector<Place> inside;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Place &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    const double at_a = sign * (a.s - from), at_b = sign * (b.s - from);
    if (at_a >= 0) inside.push_back(a);
    if ((at_a >= 0) != (at_b >= 0)) inside.push_back({a.X + (b.X - a.X) * (at_a / (at_a - at_b)), from});
  }
  return inside;
}

/// How far along a line the nearest of its points is, its ends made longer [m].
double place_along(const std::vector<Vec3d>& line, const Vec3d& X) {
  double nearest = Bounds::infinite, place = 0, before = 0;
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    const Vec3d edge = line[k + 1] - line[k];
    const double length = norm(edge);
    if (!(length > 0)) continue;
    double t = dot(X - line[k], edge) / (length * length);
    if (k > 0) t = std::max(t, 0.0);
    if (k + 2 < line.size()) t = std::min(t, 1.0);
    const double distance = norm(line[k] + edge * t - X);
    if (distance < nearest * (1 - 1e-9)) {
      nearest = distance;
      place = before + t * length;
    }
    before += length;
  }
  return place;
}

/// A strip, and how far along it each of its points is: first along its axis, then along the middle line that follows.
class Strip {
 public:
  Strip(const TriangleMesh& faces, const std::string& body) : faces_(faces), tree_(faces) {
    const MassProperties area = properties_of_area(faces);
    origin_ = area.center;
    const Vec3d axis = length_axis(faces, body);
    measure([&](const Vec3d& X) { return dot(X, axis); });
    area_ = area.measure;
    for (int pass = 0; pass < 3; ++pass) {
      std::vector<Vec3d> line = middle_line(16);
      for (Vec3d& X : line) X -= origin_;
      measure([&](const Vec3d& X) { return place_along(line, X); });
    }
  }

  double length() const { return high_ - low_; }

  /// Its middle line in so many equal steps, on the faces.
  std::vector<Vec3d> middle_line(int steps) const {
    std::vector<Vec3d> line(at(steps) + 1);
    for (int k = 0; k <= steps; ++k) tree_.distance(origin_ + middle(low_ + length() * k / steps), &line[at(k)]);
    return line;
  }

 private:
  template <class PlaceOf>
  void measure(const PlaceOf& place_of) {
    place_.clear();
    for (const Vec3d& X : faces_.points) place_.push_back(place_of(X - origin_));
    const auto [low, high] = std::minmax_element(place_.begin(), place_.end());
    low_ = *low;
    high_ = *high;
  }

  /// Middle of the strip across its length, from the whole strip's. Near the ends, which may be pointed or slanting, it
  /// goes on as it comes.
  Vec3d middle(double s) const {
    const double end = std::min(0.5 * area_ / length(), 0.25 * length());
    const double inner = std::clamp(s, low_ + end, high_ - end), beyond = s - inner;
    if (beyond == 0) return slab_middle(s, 1e-3 * end);
    const double back = beyond < 0 ? end : -end;
    const Vec3d X = slab_middle(inner, 1e-3 * end);
    return X + (slab_middle(inner + back, 1e-3 * end) - X) * (beyond / back);
  }

  /// Middle of the strip's area in a slab, which is widened where the strip has a gap.
  Vec3d slab_middle(double s, double width) const {
    for (;; width *= 2) {
      const double from = s - 0.5 * width;
      double area = 0;
      Vec3d moment;
      for (const auto& t : faces_.triangles) {
        std::vector<Place> part;
        part.reserve(t.size());
        for (const int node : t) part.push_back({faces_.points[at(node)] - origin_, place_[at(node)]});
        const auto [least, most] = std::minmax({part[0].s, part[1].s, part[2].s});
        if (most < from || least > from + width) continue;
        part = clipped(clipped(part, from, 1), from + width, -1);
        for (std::size_t k = 2; k < part.size(); ++k) {
          const double piece = norm(cross(part[k - 1].X - part[0].X, part[k].X - part[0].X));
          area += piece;
          moment += (part[0].X + part[k - 1].X + part[k].X) * (piece / 3);
        }
      }
      if (area > 0) return moment * (1 / area);
      if (width > 4 * length()) return {};
    }
  }

  const TriangleMesh& faces_;
  TriangleTree tree_;
  Vec3d origin_{};
  std::vector<double> place_;  ///< of each point [m]
  double low_ = 0, high_ = 0, area_ = 0;
};

double squared_distance(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += squared_norm(b[i] - a[i]);
  return sum;
}

/// Rows of triangles between two lines. Where the lines meet, a column is a single point.
TriangleMesh sheet_between(const std::vector<Vec3d>& from, const std::vector<Vec3d>& to, int rows, double touching) {
  TriangleMesh sheet;
  std::vector<int> node;  // column by column
  for (std::size_t c = 0; c < from.size(); ++c) {
    const bool meet = norm(to[c] - from[c]) < touching;
    for (int r = 0; r <= rows; ++r) {
      if (r == 0 || !meet) {
        const double s = static_cast<double>(r) / rows;
        sheet.points.push_back(from[c] * (1 - s) + to[c] * s);
      }
      node.push_back(static_cast<int>(sheet.points.size()) - 1);
    }
  }
  const auto add = [&](int a, int b, int c) {
    if (a != b && b != c && c != a) sheet.triangles.push_back({a, b, c});
  };
  const auto column = static_cast<std::size_t>(rows) + 1;
  for (std::size_t c = 0; c + 1 < from.size(); ++c)
    for (std::size_t r = 0; r + 1 < column; ++r) {
      const int a = node[c * column + r], b = node[(c + 1) * column + r], d = node[c * column + r + 1],
                e = node[(c + 1) * column + r + 1];
      const double across = norm(sheet.points[at(e)] - sheet.points[at(a)]),
                   back = norm(sheet.points[at(d)] - sheet.points[at(b)]);
      if (across <= back) {
        add(a, b, e);
        add(a, e, d);
      } else {
        add(a, b, d);
        add(b, e, d);
      }
    }
  return sheet;
}

}  // namespace

TriangleMesh gap_sheet(const GapSide& first, const GapSide& second, double spacing) {
  constexpr double most_cells = 1e7;
  const CheckedSides sides = checked_sides(first, second);
  const Strip a(sides.first, first.body), b(sides.second, second.body);
  if (!(spacing > 0)) spacing = std::max(mean_edge(sides.first), mean_edge(sides.second));
  // Whole numbers of spacings stay what they are to rounding.
  const auto steps = [&](double length) { return std::max(1.0, std::ceil(length / spacing - 1e-6)); };
  const double columns = steps(std::max(a.length(), b.length()));
  if (!(columns < most_cells)) throw InputError("the sheet takes more than 1e7 triangles; use a larger spacing");
  const std::vector<Vec3d> from = a.middle_line(static_cast<int>(columns));
  std::vector<Vec3d> to = b.middle_line(static_cast<int>(columns)), other(to.rbegin(), to.rend());
  if (squared_distance(from, other) < squared_distance(from, to) * (1 - 1e-9)) to = other;
  double width = 0;
  for (std::size_t c = 0; c < from.size(); ++c) width += norm(to[c] - from[c]) / static_cast<double>(from.size());
  const double rows = std::max(1.0, std::round(width / spacing * (1 + 1e-9)));
  if (!(rows * columns < most_cells)) throw InputError("the sheet takes more than 1e7 triangles; use a larger spacing");
  TriangleMesh sheet = sheet_between(from, to, static_cast<int>(rows), sides.touching);
  if (sheet.triangles.empty()) fail_touching(first.body, second.body);
  return sheet;
}

}  // namespace fascia
