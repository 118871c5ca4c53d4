#include "meshless/cloud_build.hpp"

#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "meshless/cloud_parts.hpp"
#include "meshless/cloud_shared.hpp"
#include "meshless/gauss.hpp"
#include "meshless/kept_samples.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

namespace fascia {

namespace {

/// Supports in spacings: short ones integrate best (docs/decisions/scattered_frames.md).
constexpr double kMlsSupport = 1.8, kKernelSupport = 2.0;
constexpr int kShepardNeighbours = 8;
/// Spacing of integration points over that of frames: bending needs the points to see the section
/// (docs/manual/meshless.md).
constexpr double kPointSpacing = 0.4;

/// Samples of matter as a choice asks for.
struct Samples {
  Matter matter;
  double spacing = 0;
  std::vector<SamplePlace> places;
};

/// Runs a step whose errors are due to one part of the description.
template <class Step>
auto blaming(Blame blame, const Step& step) {
  try {
    return step();
  } catch (const InputError& e) {
    throw InputError(e.what(), blame);
  }
}

/// @param fallback  spacing where the choice has none
/// @param occupied  places that keep frames off, in the axes of the parts
Samples samples_of(const MatterParts& parts, const SampleChoice& choice, bool frames, double fallback, int seed,
                   ThreadPool& pool, std::span<const Vec3d> occupied = {}) {
  const int others = static_cast<int>(occupied.size());
  Samples s;
  s.spacing = fallback;
  const auto* counted = std::get_if<CountedChoice>(&choice);
  const auto* listed = std::get_if<ListedChoice>(&choice);
  if (const auto* spaced = std::get_if<SpacedChoice>(&choice)) {
    s.spacing = spaced->spacing;
    seed = spaced->seed;
  } else if (counted) {
    s.spacing = rough_spacing(parts, counted->count + others);
    seed = counted->seed;
  } else if (listed) {
    s.spacing = rough_spacing(parts, static_cast<int>(listed->position.size()) + others);
  }
  s.matter = matter_for(parts, s.spacing, frames ? PieceUse::frames : PieceUse::points, pool);
  if (counted && counted->count == 0 && others > 0) return s;
  if (counted) s.spacing = spacing_for_count(s.matter, counted->count, seed, frames, pool, occupied);
  s.places =
      listed ? places_at(s.matter, listed->position) : poisson_disk(s.matter, s.spacing, seed, frames, pool, occupied);
  return s;
}

std::vector<CloudFrame> frames_of(const ScatterSpec& choice, const ListedChoice* listed,
                                  const std::vector<SamplePlace>& places) {
  std::vector<CloudFrame> frames;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const SamplePlace& p = places[i];
    Mat3d own = choice.parts.rotation * p.axes;  // a user's are those of the placed body
    if (listed && !listed->rotation.empty()) own = Mat3d::identity() + rotation_increment(listed->rotation[i]);
    frames.push_back({to_world(choice.parts, p.x), own, p.dimension, choice.parts.rotation * p.axes.column(2),
                      p.feature < p.dimension});
  }
  return frames;
}

void check_frames(const ScatterSpec& choice, const std::vector<CloudFrame>& frames, double size) {
  std::vector<Vec3d> positions(frames.size());
  std::transform(frames.begin(), frames.end(), positions.begin(), [](const CloudFrame& f) { return f.x; });
  const auto pairs = coincident(positions, 1e-9 * size);
  if (!pairs.empty()) {
    throw InputError("frames " + std::to_string(pairs[0].first) + " and " + std::to_string(pairs[0].second) +
                         " coincide at " + text(positions[at(pairs[0].first)]) + "; remove one of them",
                     Blame::frames);
  }
  const int needed = choice.parts.dimension() + 1;
  const std::size_t count = frames.size() + choice.shared.size();
  if (choice.weights == ScatteredKind::mls && static_cast<int>(count) < needed)
    throw InputError(std::to_string(count) + " frames cannot carry linear fields in this domain; use at least " +
                         std::to_string(needed),
                     Blame::frames);
  if (choice.neighbours && *choice.neighbours < needed)
    throw InputError("a point that follows " + std::to_string(*choice.neighbours) +
                         " frames cannot be held in this domain; neighbours must be at least " + std::to_string(needed),
                     Blame::weights);
}

/// @param spacing  around each frame [m]
Reach reach_of(const ScatterSpec& choice, const std::vector<double>& spacing) {
  Reach reach;
  if (choice.neighbours) reach.neighbours = *choice.neighbours;
  if (!choice.neighbours && !choice.support && choice.weights == ScatteredKind::shepard)
    reach.neighbours = kShepardNeighbours;
  const double factor = choice.weights == ScatteredKind::mls ? kMlsSupport : kKernelSupport;
  for (const double s : spacing) reach.support.push_back(choice.support ? *choice.support : factor * s);
  return reach;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

/// A sheet is thicker than it is curved where its inner face would fold over.
void check_curvature(const std::vector<CloudPoint>& points, std::vector<std::string>& messages) {
  std::vector<Vec3d> x, normal;
  std::vector<double> thickness;
  for (const CloudPoint& p : points) {
    if (p.place.dimension != 2) continue;
    x.push_back(p.place.X);
    normal.push_back(p.place.axes.column(2));
    thickness.push_back(p.extent);
  }
  if (x.size() < 3) return;
  const FrameSearch search(x);
  std::vector<double> folded;  // thickness over curvature radius
  for (std::size_t i = 0; i < x.size(); ++i) {
    double curvature = 0;
    for (const int j : search.nearest(x[i], 5)) {
      const Vec3d turn = normal[at(j)] - normal[i];
      if (at(j) != i && norm(turn) < 1) curvature = std::max(curvature, norm(turn) / norm(x[at(j)] - x[i]));
    }
    folded.push_back(thickness[i] * curvature);
  }
  const auto many = std::count_if(folded.begin(), folded.end(), [](double f) { return f > 1; });
  if (2 * at(static_cast<int>(many)) > folded.size())
    throw InputError("the sheet's thickness is larger than its curvature radius; use a smaller thickness or a solid");
  if (20 * at(static_cast<int>(many)) > folded.size())
    messages.push_back("the sheet is thicker than its curvature radius at " + std::to_string(many) + " of " +
                       std::to_string(folded.size()) + " points: bending is rough there");
}

/// Points with their shares of the matter; sampled ones move along the tangents to the middle of their share, where
/// linear fields are integrated exactly.
std::vector<CloudPoint> made_points(const MatterParts& parts, const SampleChoice& choice, double spacing,
                                    ThreadPool& pool) {
  Samples s = blaming(Blame::points, [&] { return samples_of(parts, choice, false, spacing, 2, pool); });
  const auto* listed = std::get_if<ListedChoice>(&choice);
  std::vector<Share> shares = voronoi_shares(s.matter, s.places, pool);
  if (listed && !listed->volume.empty()) {
    double sum = 0;
    for (const double v : listed->volume) sum += v;
    for (std::size_t i = 0; i < shares.size(); ++i) shares[i].volume = listed->volume[i] * s.matter.volume / sum;
  }
  std::vector<CloudPoint> points;
  for (std::size_t i = 0; i < s.places.size(); ++i) {
    SamplePlace& p = s.places[i];
    if (!(shares[i].volume > 0)) continue;
    if (!listed) {
      Vec3d centered = p.x;
      for (int a = 0; a < p.dimension; ++a)
        centered += p.axes.column(a) * dot(p.axes.column(a), shares[i].centroid - p.x);
      if (p.dimension < 3 || !parts.solid->contains || parts.solid->contains(centered)) p.x = centered;
    }
    points.push_back({{to_world(parts, p.x), parts.rotation * p.axes, p.dimension}, shares[i].volume, p.extent});
  }
  return points;
}

/// Takes points from a store, or makes them.
std::vector<CloudPoint> points_of(const MatterParts& parts, const SampleChoice& choice, double spacing,
                                  const SampleStore* store, ThreadPool& pool) {
  if (!store) return made_points(parts, choice, spacing, pool);
  SampleDescription description("points", parts, choice);
  description.add(spacing);
  return kept_or_made<CloudPoint>(store, description,
                                  [&] {
                                    return KeptSamples<CloudPoint>{spacing, made_points(parts, choice, spacing, pool)};
                                  })
      .samples;
}

/// Takes the places of a body's frames from a store, or makes them.
KeptSamples<SamplePlace> frame_places(const MatterParts& parts, const SampleChoice& choice,
                                      const std::vector<Vec3d>& occupied, const SampleStore* store, ThreadPool& pool) {
  const auto make = [&] {
    Samples made = blaming(Blame::frames, [&] { return samples_of(parts, choice, true, 0, 1, pool, occupied); });
    return KeptSamples<SamplePlace>{made.spacing, std::move(made.places)};
  };
  if (!store) return make();
  SampleDescription description("frames", parts, choice);
  description.add_all(std::span(occupied));
  return kept_or_made<SamplePlace>(store, description, make);
}

std::vector<double> spacing_around(const std::vector<CloudFrame>& frames, std::size_t own) {
  std::vector<Vec3d> positions;
  std::vector<int> dimension;
  for (const CloudFrame& f : frames) {
    positions.push_back(f.x);
    dimension.push_back(f.dimension);
  }
  return local_spacing(positions, dimension, own);
}

/// Around a body's own frames, where shared ones stand among them; around these where it has none itself.
std::vector<double> own_spacing(const ScatterSpec& choice, std::vector<CloudFrame> frames) {
  const std::size_t own = frames.size();
  for (const SharedFrame& s : choice.shared)
    frames.push_back({s.x, Mat3d::identity(), choice.parts.dimension(), {}, true});
  std::vector<double> spacing = spacing_around(frames, choice.shared.empty() ? 0 : own);
  if (own > 0) spacing.resize(own);
  return spacing;
}

/// A user's points must lie in the matter, to a thousandth of its size.
void check_inside(const CloudSpec& spec, double size) {
  for (const CloudPoint& p : spec.points) {
    const double distance = spec.locate(p.place.X).distance;
    if (distance <= 1e-3 * size) continue;
    throw InputError("the point at " + text(p.place.X) + " lies " + std::to_string(distance) +
                         " m outside the body; give points of its rest shape",
                     Blame::points);
  }
}

/// A layer or two of points across a solid feel next to none of its bending, as points on the middle of a sheet do.
void check_layers(const MatterParts& parts, std::size_t points, std::vector<std::string>& messages) {
  constexpr double kLayers = 1.5;
  if (!parts.solid) return;
  const double thickness = thickness_of(*parts.solid);
  if (thickness > kLayers * std::cbrt(parts.solid->volume / static_cast<double>(points))) return;
  std::ostringstream out;
  out.precision(2);
  out << "the body is about " << thickness << " m thick, and its " << points
      << " integration points lie in a layer or two across that: they feel little of its bending, so that the body "
         "bends far too much; use several times as many points, frames on a grid, or a rectangle, annulus or line with "
         "thickness or radius";
  messages.push_back(out.str());
}

}  // namespace

void scatter_cloud(const ScatterSpec& choice, CloudSpec& spec, std::vector<std::string>& messages) {
  ThreadPool pool(choice.threads);
  const double size = size_of(choice.parts);
  const std::vector<Vec3d> occupied = positions_in_parts(choice.parts, choice.shared);
  const bool listed = std::holds_alternative<ListedChoice>(choice.frames);
  SampleChoice left;
  if (listed && !occupied.empty())
    left = unoccupied(std::get<ListedChoice>(choice.frames), occupied, kCoincident * size, messages);
  const SampleChoice& own = std::holds_alternative<ListedChoice>(left) ? left : choice.frames;
  const KeptSamples<SamplePlace> frames = frame_places(choice.parts, own, occupied, choice.store, pool);
  CloudFrames set;
  set.frames = frames_of(choice, std::get_if<ListedChoice>(&own), frames.samples);
  set.own = set.frames.size();
  check_frames(choice, set.frames, size);
  std::vector<double> spacing = own_spacing(choice, set.frames);
  spec.spacing = std::max(mean(spacing), 1e-9 * size);
  spec.points = points_of(choice.parts, choice.points,
                          kPointSpacing * (listed || set.own == 0 ? spec.spacing : frames.spacing), choice.store, pool);
  if (spec.points.empty()) throw InputError("no integration point lies in the domain; use more points", Blame::points);
  finish_cloud(choice.parts, spec);
  if (std::holds_alternative<ListedChoice>(choice.points)) check_inside(spec, size);
  check_curvature(spec.points, messages);
  check_layers(choice.parts, spec.points.size(), messages);
  add_shared(choice.shared, spec.points, set);
  if (!set.shared.empty()) spacing = spacing_around(set.frames, set.own);
  set.reach = reach_of(choice, spacing);
  widen_supports(choice.weights, spec.points, set, pool);
  spec.weights = drop_idle_frames(choice.weights, spec.points, set, messages, pool);
  spec.field = scattered_field(choice.weights, set.frames, set.reach);
  if (choice.weights == ScatteredKind::mls)
    spec.share = weights_of(scattered_field(ScatteredKind::wendland, set.frames, set.reach), spec.points, pool);
  spec.shared = std::move(set.shared);
  set.frames.resize(set.own);
  spec.frames = std::move(set.frames);
}

namespace {

/// Lets the points of each cell of a grid stand for the volume of that cell, so that all cells are equally stiff.
void balance_cells(const MatterParts& parts, const ThinGrid& grid, std::vector<CloudPoint>& points) {
  const FrameField weights = thin_grid_field(grid);
  std::map<int, std::vector<std::size_t>> members;  // by the cell's first frame
  double volume = 0, balanced = 0;
  for (std::size_t q = 0; q < points.size(); ++q) {
    const Vec3d x = transpose(parts.rotation) * (points[q].place.X - parts.translation);
    members[weights({x, Mat3d::identity(), 3}).frame.front()].push_back(q);
    volume += points[q].volume;
  }
  std::size_t cells = 1;
  for (const int n : grid.count) cells *= at(n - 1);
  if (members.size() < cells)
    throw InputError(std::to_string(cells - members.size()) + " of " + std::to_string(cells) +
                         " cells of the grid of frames hold no integration point; use more points",
                     Blame::points);
  for (const auto& [cell, inside] : members) {
    double share = 0, across = 0;
    for (const std::size_t q : inside) {
      share += points[q].volume;
      across += std::pow(points[q].extent, 3 - points[q].place.dimension) / static_cast<double>(inside.size());
    }
    for (const std::size_t q : inside) points[q].volume *= across / share;
    balanced += across;
  }
  for (CloudPoint& p : points) p.volume *= volume / balanced;
}

}  // namespace

void grid_cloud(const ThinGridSpec& choice, CloudSpec& spec) {
  const MatterParts& parts = choice.parts;
  const ThinGrid& grid = choice.grid;
  const std::size_t directions = grid.edge.size();
  const Vec3d tangent = normalized(grid.edge[0]);
  const Vec3d normal = directions == 2 ? normalized(cross(grid.edge[0], grid.edge[1])) : basis_from(tangent).row(2);
  const Mat3d axes = Mat3d::from_columns(tangent, cross(normal, tangent), normal);
  for (int i = 0; i < grid.node_count(); ++i) {
    bool rim = false;
    int rest = i;
    for (const int n : grid.count) {
      rim = rim || rest % n == 0 || rest % n == n - 1;
      rest /= n;
    }
    spec.frames.push_back({to_world(parts, grid.position(i)), parts.rotation * axes, parts.dimension(),
                           parts.rotation * axes.column(2), rim});
  }
  double cells = 1;
  for (const int n : grid.count) cells *= n - 1;
  ThreadPool pool(choice.threads);
  if (!std::holds_alternative<std::monostate>(choice.points)) {
    spec.points =
        points_of(parts, choice.points, rough_spacing(parts, static_cast<int>(4 * cells)), choice.store, pool);
    balance_cells(parts, grid, spec.points);
  } else {
    spec.points = gauss_cells(choice, axes);
  }
  ThinGrid placed = grid;
  placed.origin = to_world(parts, grid.origin);
  for (Vec3d& e : placed.edge) e = parts.rotation * e;
  spec.field = thin_grid_field(placed);
  spec.grid = true;
  const double measure = directions == 2 ? norm(cross(grid.edge[0], grid.edge[1])) : norm(grid.edge[0]);
  spec.spacing = std::pow(measure / cells, 1.0 / static_cast<double>(directions));
  share_grid_frames(choice.shared, size_of(parts), spec);
  spec.weights = weights_of(spec.field, spec.points, pool);
  finish_cloud(parts, spec);
}

}  // namespace fascia
