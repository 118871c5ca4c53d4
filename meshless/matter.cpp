#include "meshless/matter.hpp"

#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "core/base/throwing_loops.hpp"
#include "meshless/matter_parts.hpp"
#include "meshless/scattered/point_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

namespace fascia {

void check_pieces(const Matter& matter, double piece_size, double more) {
  constexpr double most = 5e7;
  if (!(piece_size > 0) || !std::isfinite(piece_size))
    throw InputError("the sampling needs a spacing that is positive; give the mean distance of samples in metres");
  const double count = static_cast<double>(matter.pieces.size() + matter.voxels.size()) + more;
  if (count <= most) return;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2g", count);
  throw InputError("sampling the domain takes " + std::string(text.data()) +
                   " pieces, more than 5e7; use a larger spacing, or transform.scale where a file is not in metres");
}

namespace {

constexpr int kSubdivisions = 3;  // of a voxel at the surface, in each direction
constexpr int kParts = kSubdivisions * kSubdivisions * kSubdivisions;

/// Where fine test n lies along the x edge of a voxel; n / 3 and n / 9 give the places along y and z.
constexpr double fine_place(int n) { return (n % kSubdivisions + 0.5) / kSubdivisions; }

/// A whole number of equal cells a direction, so that a box is filled exactly.
class VoxelGrid {
 public:
  VoxelGrid(const SolidDomain& domain, double size) : min_(domain.min) {
    for (int a = 0; a < 3; ++a) {
      const double extent = domain.max[a] - domain.min[a];
      if (!(extent > 0)) throw InputError("the domain has no volume; its bounding box must be wide in each direction");
      const double count = std::max(1.0, std::ceil(extent / size * (1 - 1e-9)));
      cell_[a] = extent / count;
      expected_ *= count;
      count_[at(a)] = static_cast<int>(std::min(count, 1e9));
    }
  }
  double expected() const { return expected_; }
  std::size_t size() const { return at(count_[0]) * at(count_[1]) * at(count_[2]); }
  const std::array<int, 3>& count() const { return count_; }
  std::size_t number(int i, int j, int k) const { return at(i) + at(count_[0]) * (at(j) + at(count_[1]) * at(k)); }
  /// The voxel's place at fractions of its edges.
  Vec3d place(int i, int j, int k, double u = 0.5, double v = 0.5, double w = 0.5) const {
    return min_ + Vec3d{{(i + u) * cell_[0], (j + v) * cell_[1], (k + w) * cell_[2]}};
  }
  std::size_t voxel_of(const Vec3d& x) const {
    std::array<int, 3> i{};
    for (int a = 0; a < 3; ++a)
      i[at(a)] = static_cast<int>(std::clamp((x[a] - min_[a]) / cell_[a] + kTie, 0.0, count_[at(a)] - 0.5));
    return number(i[0], i[1], i[2]);
  }
  /// Calls act(j, k) for each row of voxels, on all threads.
  template <class Act>
  void for_each_row(ThreadPool& pool, const Act& act) const {
    constexpr int kGrain = 4;
    for_throwing_ranges(pool, count_[1] * count_[2], kGrain, [&](int begin, int end) {
      for (int row = begin; row < end; ++row) act(row % count_[1], row / count_[1]);
    });
  }
  template <class Act>
  void for_each(Act&& act) const {
    for (int k = 0; k < count_[2]; ++k)
      for (int j = 0; j < count_[1]; ++j)
        for (int i = 0; i < count_[0]; ++i) act(i, j, k);
  }

 private:
  Vec3d min_{}, cell_{};
  std::array<int, 3> count_{};
  double expected_ = 1;
};

/// Marks the voxels that the surface passes: a neighbour on the other side, or a piece of the surface inside.
std::vector<char> cut_voxels(const VoxelGrid& grid, const std::vector<char>& inside,
                             std::span<const MatterPiece> surface) {
  const auto& n = grid.count();
  std::vector<char> cut(grid.size(), 0);
  for (const MatterPiece& p : surface) cut[grid.voxel_of(p.x)] = 1;
  grid.for_each([&](int i, int j, int k) {
    const std::size_t here = grid.number(i, j, k);
    const bool outer = i == 0 || j == 0 || k == 0 || i == n[0] - 1 || j == n[1] - 1 || k == n[2] - 1;
    if (outer && inside[here] != 0) cut[here] = 1;
    for (int neighbour = 14; neighbour < 27; ++neighbour) {
      const int a = i + neighbour % 3 - 1, b = j + neighbour / 3 % 3 - 1, c = k + neighbour / 9 - 1;
      if (a < 0 || b < 0 || a >= n[0] || b >= n[1] || c >= n[2]) continue;
      const std::size_t there = grid.number(a, b, c);
      if (inside[here] != inside[there]) cut[here] = cut[there] = 1;
    }
  });
  return cut;
}

/// The part of a voxel inside of a solid, in fine tests: whole numbers, whose sum is exact; 0: none.
struct VoxelPart {
  Vec3d x{};  ///< its centroid, or where that is outside the test next to it
  double tests = 0;
};

/// @param inside  of the voxel's fine tests
VoxelPart voxel_part(const VoxelGrid& grid, int i, int j, int k, const std::array<char, kParts>& inside,
                     const std::function<bool(const Vec3d&)>& contains) {
  std::array<Vec3d, kParts> found;
  std::size_t count = 0;
  Vec3d sum{};
  for (int n = 0; n < kParts; ++n) {
    if (inside[at(n)] == 0) continue;
    const Vec3d x = grid.place(i, j, k, fine_place(n), fine_place(n / kSubdivisions),
                               fine_place(n / (kSubdivisions * kSubdivisions)));
    found[count++] = x;
    sum += x;
  }
  if (count == 0) return {};
  const Vec3d centroid = sum * (1.0 / static_cast<double>(count));
  VoxelPart part{centroid, static_cast<double>(count)};
  if (contains(centroid)) return part;
  double least = std::numeric_limits<double>::max();
  for (std::size_t n = 0; n < count; ++n) {
    const double squared = squared_norm(found[n] - centroid);
    if (squared >= least * (1 - kTie)) continue;
    least = squared;
    part.x = found[n];
  }
  return part;
}

void contains_on_line(const SolidDomain& domain, double y, double z, std::span<const double> x,
                      std::span<char> inside) {
  if (domain.contains_on_line) return domain.contains_on_line(y, z, x, inside);
  for (std::size_t i = 0; i < x.size(); ++i) inside[i] = domain.contains({{x[i], y, z}}) ? 1 : 0;
}

/// Marks the voxels whose middles are inside.
std::vector<char> inner_voxels(const VoxelGrid& grid, const SolidDomain& domain, ThreadPool& pool) {
  std::vector<char> inside(grid.size());
  std::vector<double> x(at(grid.count()[0]));
  for (int i = 0; i < grid.count()[0]; ++i) x[at(i)] = grid.place(i, 0, 0)[0];
  grid.for_each_row(pool, [&](int j, int k) {
    const Vec3d first = grid.place(0, j, k);
    contains_on_line(domain, first[1], first[2], x, std::span(inside).subspan(grid.number(0, j, k), x.size()));
  });
  return inside;
}

/// The fine tests of some voxels of a row, line by line along x.
std::vector<std::array<char, kParts>> fine_tests(const VoxelGrid& grid, const SolidDomain& domain,
                                                 std::span<const int> voxels, int j, int k) {
  std::vector<std::array<char, kParts>> tests(voxels.size());
  if (voxels.empty()) return tests;
  std::vector<double> x;
  for (const int i : voxels)
    for (int n = 0; n < kSubdivisions; ++n) x.push_back(grid.place(i, j, k, fine_place(n))[0]);
  std::vector<char> inside(x.size());
  for (int line = 0; line < kSubdivisions * kSubdivisions; ++line) {
    const Vec3d first = grid.place(0, j, k, 0.5, fine_place(line), fine_place(line / kSubdivisions));
    contains_on_line(domain, first[1], first[2], x, inside);
    for (std::size_t m = 0; m < x.size(); ++m)
      tests[m / kSubdivisions][at(line * kSubdivisions) + m % kSubdivisions] = inside[m];
  }
  return tests;
}

/// The voxels of a domain that is not a box.
void add_voxels(VoxelPieces& voxels, const VoxelGrid& grid, const SolidDomain& domain,
                std::span<const MatterPiece> surface, ThreadPool& pool) {
  const std::vector<char> inside = inner_voxels(grid, domain, pool), cut = cut_voxels(grid, inside, surface);
  const int length = grid.count()[0];
  std::vector<std::vector<VoxelPart>> rows(grid.size() / at(length));
  grid.for_each_row(pool, [&](int j, int k) {
    const std::size_t begin = grid.number(0, j, k);
    std::vector<int> at_surface;
    for (int i = 0; i < length; ++i)
      if (cut[begin + at(i)] != 0) at_surface.push_back(i);
    const std::vector<std::array<char, kParts>> tests = fine_tests(grid, domain, at_surface, j, k);
    std::vector<VoxelPart>& parts = rows[begin / at(length)];
    std::size_t taken = 0;
    for (int i = 0; i < length; ++i) taken += cut[begin + at(i)] != 0 || inside[begin + at(i)] != 0 ? 1 : 0;
    parts.reserve(taken);
    std::size_t next = 0;
    for (int i = 0; i < length; ++i) {
      if (cut[begin + at(i)] != 0)
        parts.push_back(voxel_part(grid, i, j, k, tests[next++], domain.contains));
      else if (inside[begin + at(i)] != 0)
        parts.push_back({grid.place(i, j, k), kParts});
    }
  });
  std::size_t count = voxels.size();
  for (const std::vector<VoxelPart>& parts : rows) count += parts.size();
  voxels.x.reserve(count);
  voxels.volume.reserve(count);
  for (const std::vector<VoxelPart>& parts : rows)
    for (const VoxelPart& part : parts) {
      if (part.tests == 0) continue;
      voxels.x.push_back(part.x);
      voxels.volume.push_back(part.tests);
    }
}

void add_faces(Matter& matter, const TriangleMesh& surface, double piece_size) {
  const SurfaceFeatures features = find_features(surface);
  std::vector<std::array<int, 2>> edges;
  for (const SurfaceEdge& e : features.edges) edges.push_back(e.vertices);
  add_edges(matter, surface.points, edges, std::vector<EdgeMatter>(edges.size()), 3);

  std::vector<TrianglePart> parts;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const Vec3d& normal = features.triangle_normal[t];
    if (!(squared_norm(normal) > 0)) continue;
    std::array<Vec3d, 3> corners;
    for (std::size_t n = 0; n < 3; ++n) corners[n] = surface.points[at(surface.triangles[t][n])];
    cut_triangle(corners, {normal, normal, normal}, 0.5 * norm(normal), piece_size, parts);
  }
  for (const TrianglePart& p : parts) matter.pieces.push_back({p.x, 0, p.area, 3, 2, Mat3d::identity(), 0});
}

std::function<bool(const Vec3d&)> inside_test(const SolidDomain& domain) {
  if (domain.contains) return domain.contains;
  return [low = domain.min, high = domain.max](const Vec3d& x) {
    for (int a = 0; a < 3; ++a)
      if (!(x[a] >= low[a] && x[a] <= high[a])) return false;
    return true;
  };
}

}  // namespace

void add_solid(Matter& matter, const SolidDomain& domain, double piece_size, bool features, ThreadPool& pool) {
  check_pieces(matter, piece_size, 0);
  if (!(domain.volume > 0)) throw InputError("the domain has no volume; its surface must enclose some");
  const VoxelGrid grid(domain, piece_size);
  check_pieces(matter, piece_size, grid.expected() + expected_parts(domain.surface, piece_size));
  const std::size_t first_surface = matter.pieces.size();
  if (features || domain.contains) add_faces(matter, domain.surface, piece_size);  // they cut voxels too

  VoxelPieces& voxels = matter.voxels;
  const std::size_t first = voxels.size();
  if (domain.contains) {
    add_voxels(voxels, grid, domain, std::span(matter.pieces).subspan(first_surface), pool);
  } else {
    voxels.x.resize(first + grid.size());
    voxels.volume.resize(first + grid.size(), kParts);
    grid.for_each_row(pool, [&](int j, int k) {
      for (int i = 0; i < grid.count()[0]; ++i) voxels.x[first + grid.number(i, j, k)] = grid.place(i, j, k);
    });
  }

  double sum = 0;
  for (std::size_t p = first; p < voxels.size(); ++p) sum += voxels.volume[p];
  if (!(sum > 0)) throw InputError("no piece of the sampling falls inside the domain; use a smaller spacing");
  for (std::size_t p = first; p < voxels.size(); ++p) {
    voxels.volume[p] *= domain.volume / sum;
    matter.measure[3] += voxels.volume[p];
  }
  matter.volume += domain.volume;
  matter.piece_size = std::max(matter.piece_size, piece_size);
  matter.solids.push_back(inside_test(domain));
}

}  // namespace fascia
