#include "core/base/errors.hpp"
#include "meshless/scattered/block_search.hpp"
#include "meshless/scattered/owned_pieces.hpp"
#include "meshless/scattered/scatter_parts.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace fascia {

OwnerSearch::OwnerSearch(const Matter& matter, std::span<const SamplePlace> samples) : samples_(samples) {
  std::array<int, 4> count{};
  for (const SamplePlace& s : samples) ++count[at(s.dimension)];
  const auto spacing = [&](int d) { return std::pow(matter.measure[at(d)] / count[at(d)], 1.0 / d); };
  for (int d = 1; d < 3; ++d) {
    OneDimension& one = dimension_[at(d)];
    if (count[at(d)] == 0 || !(matter.measure[at(d)] > 0)) continue;
    one.spacing = spacing(d);
    one.grid = PointGrid(one.spacing);
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples[i].dimension == 3) continue;
    OneDimension& one = dimension_[at(samples[i].dimension)];
    if (!(one.spacing > 0)) continue;
    one.grid.insert(samples[i].x);
    one.sample.push_back(static_cast<int>(i));
  }
}

int OwnerSearch::owner(const MatterPiece& piece, const Vec3d& x) const {
  const OneDimension& one = dimension_[at(piece.dimension)];
  if (one.sample.empty()) return -1;
  const double reach = 2 * one.spacing;
  int found = one.grid.nearest(x, reach, [&](int k) { return alike(samples_[at(one.sample[at(k)])], piece); });
  const bool near = found >= 0 && norm(samples_[at(one.sample[at(found)])].x - x) <= reach;
  if (!near) found = one.grid.nearest(x, INFINITY, [](int) { return true; });
  return one.sample[at(found)];
}

double spacing_in_solids(const Matter& matter, std::size_t count) {
  return std::cbrt(matter.measure[3] / static_cast<double>(count));
}

std::vector<Vec3d> positions_of(std::span<const SamplePlace> samples) {
  std::vector<Vec3d> x;
  x.reserve(samples.size());
  for (const SamplePlace& s : samples) x.push_back(s.x);
  return x;
}

namespace {

void give(Share& share, const Vec3d& x, double volume) {
  share.centroid += x * volume;
  share.volume += volume;
}

/// Divides a line's piece between the owners of its ends, at the plane halfway between them.
void divide(const MatterPiece& piece, const OwnerSearch& search, std::span<const SamplePlace> samples,
            std::vector<Share>& shares) {
  const Vec3d half = piece.axes.column(0) * (0.5 * piece.measure);
  const Vec3d from = piece.x - half, to = piece.x + half;
  const int i = search.owner(piece, from), j = search.owner(piece, to);
  const auto excess = [&](const Vec3d& x) {
    return squared_norm(x - samples[at(i)].x) - squared_norm(x - samples[at(j)].x);
  };
  const double slope = i == j ? 0 : excess(to) - excess(from);
  const double u = slope > 0 ? std::clamp(-excess(from) / slope, 0.0, 1.0) : 1;
  give(shares[at(i)], from + half * u, piece.volume * u);
  give(shares[at(j)], to - half * (1 - u), piece.volume * (1 - u));
}

[[noreturn]] void refuse_without_samples(int dimension) {
  static constexpr std::array<const char*, 4> kNames{"", "line", "sheet", "solid"};
  throw InputError("no point lies in the " + std::string(kNames[at(dimension)]) +
                   " part of the domain; it needs at least one");
}

}  // namespace

namespace {

/// Places of the eighths of a voxel around its middle.
std::array<Vec3d, 8> eighths(const Vec3d& edges) {
  std::array<Vec3d, 8> at_eighth;
  for (int n = 0; n < 8; ++n)
    for (int a = 0; a < 3; ++a) at_eighth[at(n)][a] = 0.25 * edges[a] * ((n >> a & 1) * 2 - 1);
  return at_eighth;
}

/// Shares of a solid. Voxels a third of the spacing wide place samples well, but leave cells so ragged that integrals
/// over them are off by an eighth more than over eighths of voxels.
void share_solid(const Matter& matter, std::span<const SamplePlace> samples, std::vector<Share>& shares,
                 ThreadPool& pool) {
  std::vector<int> in_solid;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (samples[i].dimension == 3) in_solid.push_back(static_cast<int>(i));
  if (in_solid.empty()) refuse_without_samples(3);
  std::vector<Vec3d> places;
  places.reserve(in_solid.size());
  for (const int i : in_solid) places.push_back(samples[at(i)].x);
  const auto share = [&](std::span<const Vec3d> x, std::span<const double> volume, std::span<const Vec3d> around) {
    const std::size_t parts = around.size();
    RawArray<int> owner(parts * x.size());
    BlockSearch(x, spacing_in_solids(matter, in_solid.size()), pool, static_cast<double>(parts))
        .nearest(places, owner.span(), pool, around);
    OwnedPieces(owner.span(), places.size()).for_each(pool, [&](std::size_t n, std::size_t own) {
      const std::size_t p = n / parts;
      give(shares[at(in_solid[own])], x[p] + around[n % parts], volume[p] / static_cast<double>(parts));
    });
  };
  constexpr std::size_t kMostToCut = 4'000'000;
  constexpr std::array<Vec3d, 1> whole{};
  const std::span<const Vec3d> x = matter.voxels.x;
  const std::span<const double> volume = matter.voxels.volume;
  const bool has_parts = matter.whole_voxels == x.size() || matter.surface_parts.size() > 0;
  if (!has_parts || x.size() > kMostToCut) return share(x, volume, whole);
  share(x.first(matter.whole_voxels), volume.first(matter.whole_voxels), eighths(matter.voxel_edges));
  share(matter.surface_parts.x, matter.surface_parts.volume, whole);
}

}  // namespace

std::vector<Share> voronoi_shares(const Matter& matter, std::span<const SamplePlace> samples, ThreadPool& pool) {
  std::vector<Share> shares(samples.size());
  if (matter.voxels.size() > 0) share_solid(matter, samples, shares, pool);
  const OwnerSearch search(matter, samples);
  for (const MatterPiece& piece : matter.pieces) {
    if (!(piece.volume > 0)) continue;
    const int i = search.owner(piece);
    if (i < 0) refuse_without_samples(piece.dimension);
    if (piece.dimension == 1)
      divide(piece, search, samples, shares);
    else
      give(shares[at(i)], piece.x, piece.volume);
  }
  for (std::size_t i = 0; i < samples.size(); ++i)
    shares[i].centroid = shares[i].volume > 0 ? shares[i].centroid * (1 / shares[i].volume) : samples[i].x;
  return shares;
}

}  // namespace fascia
