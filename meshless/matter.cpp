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
  const Vec3d& cell() const { return cell_; }
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

 private:
  Vec3d min_{}, cell_{};
  std::array<int, 3> count_{};
  double expected_ = 1;
};

/// Marks the voxels that the surface passes: a neighbour on the other side, or a place of the surface inside.
std::vector<char> cut_voxels(const VoxelGrid& grid, const std::vector<char>& inside, std::span<const Vec3d> surface,
                             ThreadPool& pool) {
  const std::array<int, 3> n = grid.count();
  std::vector<char> cut(grid.size(), 0);
  grid.for_each_row(pool, [&](int j, int k) {
    const int length = n[0];
    char* row = &cut[grid.number(0, j, k)];
    const char* here = &inside[grid.number(0, j, k)];
    const auto differ = [&](const char* other, int first, int last) {
      for (int i = first; i < last; ++i) row[i] |= static_cast<char>(here[i] ^ other[i]);
    };
    for (int c = std::max(0, k - 1); c <= std::min(n[2] - 1, k + 1); ++c)
      for (int b = std::max(0, j - 1); b <= std::min(n[1] - 1, j + 1); ++b) {
        const char* there = &inside[grid.number(0, b, c)];
        differ(there, 0, length);
        differ(there + 1, 0, length - 1);
        differ(there - 1, 1, length);
      }
    const bool outer = j == 0 || k == 0 || j == n[1] - 1 || k == n[2] - 1;
    for (int i = 0; i < length; i += outer ? 1 : std::max(1, length - 1)) row[i] |= here[i];
  });
  for (const Vec3d& x : surface) cut[grid.voxel_of(x)] = 1;
  return cut;
}

/// The part of a voxel inside of a solid, in fine tests: whole numbers, whose sum is exact.
struct VoxelPart {
  Vec3d x{};  ///< its centroid, or where that is outside the test next to it
  int tests = 0;
};

/// What a row of voxels has inside of a solid.
struct VoxelRow {
  std::vector<VoxelPart> parts;
  std::vector<Vec3d> tests;  ///< of the parts of voxels that are not whole, one after the other
};

/// @param inside  of the voxel's fine tests
void add_part(VoxelRow& row, const VoxelGrid& grid, int i, int j, int k, const std::array<char, kParts>& inside,
              const std::function<bool(const Vec3d&)>& contains) {
  const std::size_t first = row.tests.size();
  Vec3d sum{};
  for (int n = 0; n < kParts; ++n) {
    if (inside[at(n)] == 0) continue;
    row.tests.push_back(grid.place(i, j, k, fine_place(n), fine_place(n / kSubdivisions),
                                   fine_place(n / (kSubdivisions * kSubdivisions))));
    sum += row.tests.back();
  }
  const std::size_t count = row.tests.size() - first;
  if (count == 0) return;
  const Vec3d centroid = sum * (1.0 / static_cast<double>(count));
  VoxelPart part{centroid, static_cast<int>(count)};
  if (!contains(centroid)) {
    double least = std::numeric_limits<double>::max();
    for (std::size_t n = first; n < row.tests.size(); ++n) {
      const double squared = squared_norm(row.tests[n] - centroid);
      if (squared >= least * (1 - kTie)) continue;
      least = squared;
      part.x = row.tests[n];
    }
  }
  if (part.tests == kParts) row.tests.resize(first);
  row.parts.push_back(part);
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

/// The voxels of a domain that is not a box, by row.
std::vector<VoxelRow> voxel_rows(const VoxelGrid& grid, const SolidDomain& domain, std::span<const Vec3d> surface,
                                 ThreadPool& pool) {
  const std::vector<char> inside = inner_voxels(grid, domain, pool), cut = cut_voxels(grid, inside, surface, pool);
  const int length = grid.count()[0];
  std::vector<VoxelRow> rows(grid.size() / at(length));
  grid.for_each_row(pool, [&](int j, int k) {
    const std::size_t begin = grid.number(0, j, k);
    std::vector<int> at_surface;
    for (int i = 0; i < length; ++i)
      if (cut[begin + at(i)] != 0) at_surface.push_back(i);
    const std::vector<std::array<char, kParts>> tests = fine_tests(grid, domain, at_surface, j, k);
    VoxelRow& row = rows[begin / at(length)];
    std::size_t taken = 0;
    for (int i = 0; i < length; ++i) taken += cut[begin + at(i)] != 0 || inside[begin + at(i)] != 0 ? 1 : 0;
    row.parts.reserve(taken);
    std::size_t next = 0;
    for (int i = 0; i < length; ++i) {
      if (cut[begin + at(i)] != 0)
        add_part(row, grid, i, j, k, tests[next++], domain.contains);
      else if (inside[begin + at(i)] != 0)
        row.parts.push_back({grid.place(i, j, k), kParts});
    }
  });
  return rows;
}

/// The voxels of a box, by row.
std::vector<VoxelRow> voxel_rows(const VoxelGrid& grid, ThreadPool& pool) {
  const int length = grid.count()[0];
  std::vector<VoxelRow> rows(grid.size() / at(length));
  grid.for_each_row(pool, [&](int j, int k) {
    VoxelRow& row = rows[grid.number(0, j, k) / at(length)];
    row.parts.reserve(at(length));
    for (int i = 0; i < length; ++i) row.parts.push_back({grid.place(i, j, k), kParts});
  });
  return rows;
}

/// @param test_volume  of one fine test
void take_voxels(Matter& matter, std::span<const VoxelRow> rows, double test_volume, bool with_parts) {
  std::size_t count = 0, tests = 0;
  for (const VoxelRow& row : rows) {
    count += row.parts.size();
    tests += row.tests.size();
  }
  const auto add = [](VoxelPieces& pieces, const Vec3d& x, double volume) {
    pieces.x.push_back(x);
    pieces.volume.push_back(volume);
  };
  const auto reserve = [](VoxelPieces& pieces, std::size_t size) {
    pieces.x.reserve(size);
    pieces.volume.reserve(size);
  };
  reserve(matter.voxels, count);
  for (const bool whole : {true, false}) {
    for (const VoxelRow& row : rows)
      for (const VoxelPart& part : row.parts)
        if ((part.tests == kParts) == whole) add(matter.voxels, part.x, part.tests * test_volume);
    if (whole) matter.whole_voxels = matter.voxels.size();
  }
  if (!with_parts) return;
  reserve(matter.surface_parts, tests);
  for (const VoxelRow& row : rows)
    for (const Vec3d& x : row.tests) add(matter.surface_parts, x, test_volume);
}

/// Small parts of a surface.
std::vector<TrianglePart> surface_parts(const TriangleMesh& surface, double piece_size) {
  std::vector<TrianglePart> parts;
  for (const auto& t : surface.triangles) {
    std::array<Vec3d, 3> corners;
    for (std::size_t n = 0; n < 3; ++n) corners[n] = surface.points[at(t[n])];
    const Vec3d normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    if (!(squared_norm(normal) > 0)) continue;
    cut_triangle(corners, {normal, normal, normal}, 0.5 * norm(normal), piece_size, parts);
  }
  return parts;
}

void add_faces(Matter& matter, const TriangleMesh& surface, std::span<const TrianglePart> parts) {
  const SurfaceFeatures features = find_features(surface);
  std::vector<std::array<int, 2>> edges;
  for (const SurfaceEdge& e : features.edges) edges.push_back(e.vertices);
  add_edges(matter, surface.points, edges, std::vector<EdgeMatter>(edges.size()), 3);
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

void add_solid(Matter& matter, const SolidDomain& domain, double piece_size, PieceUse use, ThreadPool& pool) {
  check_pieces(matter, piece_size, 0);
  if (!(domain.volume > 0)) throw InputError("the domain has no volume; its surface must enclose some");
  const VoxelGrid grid(domain, piece_size);
  check_pieces(matter, piece_size, grid.expected() + expected_parts(domain.surface, piece_size));
  const bool frames = use == PieceUse::frames;
  std::vector<TrianglePart> surface;
  if (frames || domain.contains) surface = surface_parts(domain.surface, piece_size);
  if (frames) add_faces(matter, domain.surface, surface);

  std::vector<VoxelRow> rows;
  if (domain.contains) {
    std::vector<Vec3d> places;
    places.reserve(surface.size());
    for (const TrianglePart& p : surface) places.push_back(p.x);
    rows = voxel_rows(grid, domain, places, pool);
  } else {
    rows = voxel_rows(grid, pool);
  }
  double tests = 0;
  for (const VoxelRow& row : rows)
    for (const VoxelPart& part : row.parts) tests += part.tests;
  if (!(tests > 0)) throw InputError("no piece of the sampling falls inside the domain; use a smaller spacing");
  take_voxels(matter, rows, domain.volume / tests, !frames);
  matter.voxel_edges = grid.cell();
  matter.measure[3] += domain.volume;
  matter.volume += domain.volume;
  matter.piece_size = std::max(matter.piece_size, piece_size);
  matter.solids.push_back(inside_test(domain));
}

}  // namespace fascia
