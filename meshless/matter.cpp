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

constexpr int kMostTests = 6;  // of a voxel at the surface, in each direction

/// Tests of a voxel, by x, y and z, are inside where this is true; some directions have fewer than there is room for.
using Tests = std::array<char, kMostTests * kMostTests * kMostTests>;

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

/// The part of a voxel or of its eighth inside of a solid, in tests: whole numbers, whose sum is exact.
struct VoxelPart {
  Vec3d x{};  ///< its centroid; of a voxel, where that is outside, the test next to it
  int tests = 0;
};

/// What a row of voxels has inside of a solid.
struct VoxelRow {
  std::vector<VoxelPart> parts;
  std::vector<VoxelPart> eighths;  ///< of the voxels that are not whole, one after the other
};

/// Calls act(number, i, j, k) for the tests of a voxel.
template <class Act>
void for_tests(int along, const Act& act) {
  int n = 0;
  for (int k = 0; k < along; ++k)
    for (int j = 0; j < along; ++j)
      for (int i = 0; i < along; ++i) act(at(n++), i, j, k);
}

/// @param along   tests in each direction
/// @param inside  of the voxel's tests
void add_part(VoxelRow& row, const VoxelGrid& grid, const std::array<int, 3>& voxel, int along, const Tests& inside,
              const std::function<bool(const Vec3d&)>& contains) {
  const auto place = [&](int i, int j, int k) {
    const double step = 1.0 / along;
    return grid.place(voxel[0], voxel[1], voxel[2], (i + 0.5) * step, (j + 0.5) * step, (k + 0.5) * step);
  };
  std::array<VoxelPart, 8> eighths;  // sums
  for_tests(along, [&](std::size_t n, int i, int j, int k) {
    if (inside[n] == 0) return;
    VoxelPart& part = eighths[at(2 * i / along + 2 * (2 * j / along) + 4 * (2 * k / along))];
    part.x += place(i, j, k);
    ++part.tests;
  });
  VoxelPart all;
  for (const VoxelPart& part : eighths) {
    all.x += part.x;
    all.tests += part.tests;
  }
  if (all.tests == 0) return;
  const Vec3d centroid = all.x = all.x * (1.0 / all.tests);
  if (!contains(centroid)) {
    double least = std::numeric_limits<double>::max();
    for_tests(along, [&](std::size_t n, int i, int j, int k) {
      const Vec3d x = place(i, j, k);
      const double squared = squared_norm(x - centroid);
      if (inside[n] == 0 || squared >= least * (1 - kTie)) return;
      least = squared;
      all.x = x;
    });
  }
  row.parts.push_back(all);
  if (all.tests == along * along * along) return;
  for (const VoxelPart& part : eighths)
    if (part.tests > 0) row.eighths.push_back({part.x * (1.0 / part.tests), part.tests});
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

/// The tests of some voxels of a row, line by line along x.
std::vector<Tests> tests_of(const VoxelGrid& grid, const SolidDomain& domain, std::span<const int> voxels, int along,
                            int j, int k) {
  std::vector<Tests> tests(voxels.size());
  if (voxels.empty()) return tests;
  std::vector<double> x;
  for (const int i : voxels)
    for (int n = 0; n < along; ++n) x.push_back(grid.place(i, j, k, (n + 0.5) / along)[0]);
  std::vector<char> inside(x.size());
  for (int line = 0; line < along * along; ++line) {
    const int b = line % along, c = line / along;
    const Vec3d first = grid.place(0, j, k, 0.5, (b + 0.5) / along, (c + 0.5) / along);
    contains_on_line(domain, first[1], first[2], x, inside);
    for (std::size_t m = 0; m < x.size(); ++m) tests[m / at(along)][at(line * along) + m % at(along)] = inside[m];
  }
  return tests;
}

/// The voxels of a domain that is not a box, by row. @param along  tests of a voxel at the surface in each direction
std::vector<VoxelRow> voxel_rows(const VoxelGrid& grid, const SolidDomain& domain, std::span<const Vec3d> surface,
                                 int along, ThreadPool& pool) {
  const std::vector<char> inside = inner_voxels(grid, domain, pool), cut = cut_voxels(grid, inside, surface, pool);
  const int length = grid.count()[0];
  std::vector<VoxelRow> rows(grid.size() / at(length));
  grid.for_each_row(pool, [&](int j, int k) {
    const std::size_t begin = grid.number(0, j, k);
    std::vector<int> at_surface;
    for (int i = 0; i < length; ++i)
      if (cut[begin + at(i)] != 0) at_surface.push_back(i);
    const std::vector<Tests> tests = tests_of(grid, domain, at_surface, along, j, k);
    VoxelRow& row = rows[begin / at(length)];
    std::size_t taken = 0;
    for (int i = 0; i < length; ++i) taken += cut[begin + at(i)] != 0 || inside[begin + at(i)] != 0 ? 1 : 0;
    row.parts.reserve(taken);
    std::size_t next = 0;
    for (int i = 0; i < length; ++i) {
      if (cut[begin + at(i)] != 0)
        add_part(row, grid, {i, j, k}, along, tests[next++], domain.contains);
      else if (inside[begin + at(i)] != 0)
        row.parts.push_back({grid.place(i, j, k), along * along * along});
    }
  });
  return rows;
}

/// The voxels of a box, by row.
std::vector<VoxelRow> voxel_rows(const VoxelGrid& grid, int along, ThreadPool& pool) {
  const int length = grid.count()[0];
  std::vector<VoxelRow> rows(grid.size() / at(length));
  grid.for_each_row(pool, [&](int j, int k) {
    VoxelRow& row = rows[grid.number(0, j, k) / at(length)];
    row.parts.reserve(at(length));
    for (int i = 0; i < length; ++i) row.parts.push_back({grid.place(i, j, k), along * along * along});
  });
  return rows;
}

/// Takes the voxels of all rows, whole ones first.
/// @param whole        tests of a whole voxel
/// @param test_volume  of one test [m³]
void take_voxels(Matter& matter, std::span<const VoxelRow> rows, int whole, double test_volume, bool with_eighths) {
  std::size_t count = 0, eighths = 0;
  for (const VoxelRow& row : rows) {
    count += row.parts.size();
    eighths += row.eighths.size();
  }
  const auto add = [&](VoxelPieces& pieces, const VoxelPart& part) {
    pieces.x.push_back(part.x);
    pieces.volume.push_back(part.tests * test_volume);
  };
  const auto reserve = [](VoxelPieces& pieces, std::size_t size) {
    pieces.x.reserve(size);
    pieces.volume.reserve(size);
  };
  reserve(matter.voxels, count);
  for (const bool wanted : {true, false}) {
    for (const VoxelRow& row : rows)
      for (const VoxelPart& part : row.parts)
        if ((part.tests == whole) == wanted) add(matter.voxels, part);
    if (wanted) matter.whole_voxels = matter.voxels.size();
  }
  if (!with_eighths) return;
  reserve(matter.surface_parts, eighths);
  for (const VoxelRow& row : rows)
    for (const VoxelPart& part : row.eighths) add(matter.surface_parts, part);
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

  // Pieces for points are up to twice as wide as those for frames, and shares want to know the surface well.
  const int along = frames ? kMostTests / 2 : kMostTests;
  std::vector<VoxelRow> rows;
  if (domain.contains) {
    std::vector<Vec3d> places;
    places.reserve(surface.size());
    for (const TrianglePart& p : surface) places.push_back(p.x);
    rows = voxel_rows(grid, domain, places, along, pool);
  } else {
    rows = voxel_rows(grid, along, pool);
  }
  double tests = 0;
  for (const VoxelRow& row : rows)
    for (const VoxelPart& part : row.parts) tests += part.tests;
  if (!(tests > 0)) throw InputError("no piece of the sampling falls inside the domain; use a smaller spacing");
  take_voxels(matter, rows, along * along * along, domain.volume / tests, !frames);
  matter.voxel_edges = grid.cell();
  matter.measure[3] += domain.volume;
  matter.volume += domain.volume;
  matter.piece_size = std::max(matter.piece_size, piece_size);
  matter.solids.push_back(inside_test(domain));
}

}  // namespace fascia
