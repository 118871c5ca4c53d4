#include "meshless/cloud_shared.hpp"

#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "meshless/cloud_parts.hpp"

#include <algorithm>
#include <map>

namespace fascia {

namespace {

/// A support beyond a point that it must reach, over their distance: Wendland's kernel is 0.007 there.
constexpr double kBeyond = 1.25;

void reach_to(const Vec3d& X, const std::vector<Vec3d>& positions, const std::vector<int>& frames, std::size_t first,
              std::vector<double>& support) {
  for (const int f : frames) {
    const std::size_t frame = first + at(f);
    support[frame] = std::max(support[frame], kBeyond * norm(positions[frame] - X));
  }
}

/// Frames that a point follows before no more are led to it, and that it follows at most.
constexpr int kFull = 3 * kMaxSlots / 4, kMost = 7 * kMaxSlots / 8;

/// Shared frames on nodes of their own; the others are parts of a rigid body, one node together.
std::vector<char> single_nodes(const CloudFrames& set) {
  std::map<int, int> count;
  for (const SharedFrame& s : set.shared) ++count[s.node];
  std::vector<char> single(set.own, 1);
  for (const SharedFrame& s : set.shared) single.push_back(count[s.node] == 1 ? 1 : 0);
  return single;
}

/// Every frame in or at the matter reaches as many points as hold one. Where that would be too many frames a point,
/// nodes are denser than points can tell apart: such a frame stays as it is, and is left out if it turns.
void reach_points(const std::vector<CloudPoint>& points, CloudFrames& set) {
  std::vector<Vec3d> X;
  std::vector<int> dimension;
  for (const CloudPoint& p : points) {
    X.push_back(p.place.X);
    dimension.push_back(p.place.dimension);
  }
  const std::vector<double> spacing = local_spacing(X, dimension);
  const FrameSearch search(X);
  const std::vector<char> single = single_nodes(set);
  if (std::find(single.begin(), single.end(), 0) == single.end()) set.reach.most = kMost;
  std::vector<int> frames_at(X.size(), 0);
  for (std::size_t f = 0; f < set.frames.size(); ++f)
    for (const int p : search.within(set.frames[f].x, set.reach.support[f])) frames_at[at(p)] += single[f];
  for (std::size_t f = 0; f < set.frames.size(); ++f) {
    const CloudFrame& frame = set.frames[f];
    const std::vector<int> near = search.nearest(frame.x, frame.dimension + 1);
    double& support = set.reach.support[f];
    if (norm(X[at(near.front())] - frame.x) > std::max(support, spacing[at(near.front())])) continue;
    const double wanted = kBeyond * norm(X[at(near.back())] - frame.x);
    if (wanted <= support) continue;
    std::vector<int> added = search.within(frame.x, wanted);
    std::erase_if(added, [&](int p) { return norm(X[at(p)] - frame.x) <= support; });
    const bool full = std::any_of(added.begin(), added.end(), [&](int p) { return frames_at[at(p)] >= kFull; });
    if (full && single[f] != 0) {
      if (f >= set.own && set.shared[f - set.own].turns) support = 0;
      continue;
    }
    for (const int p : added) frames_at[at(p)] += single[f];
    support = wanted;
  }
}

/// Every point that lacks frames for linear weights gets more of the nearest own and shared ones, which may lie in a
/// plane for themselves.
void reach_frames(ScatteredKind kind, const std::vector<CloudPoint>& points, CloudFrames& set, ThreadPool& pool) {
  constexpr int kRounds = 4;
  const std::vector<Vec3d> positions = set.positions();
  const std::span<const Vec3d> all(positions);
  const FrameSearch own(all.first(set.own)), shared(all.subspan(set.own));
  for (int round = 1; round <= kRounds; ++round) {
    const auto weights = weights_of(scattered_field(kind, set.frames, set.reach), points, pool);
    bool enough = true;
    for (std::size_t n = 0; n < points.size(); ++n) {
      const WeightsView w = (*weights)[n];
      if (!w.frame.empty() && !w.lowered) continue;
      enough = false;
      const CloudPoint& p = points[n];
      const int count = (p.place.dimension + 1) * round;
      reach_to(p.place.X, positions, own.nearest(p.place.X, count), 0, set.reach.support);
      reach_to(p.place.X, positions, shared.nearest(p.place.X, count), set.own, set.reach.support);
    }
    if (enough) return;
  }
}

}  // namespace

std::vector<Vec3d> CloudFrames::positions() const {
  std::vector<Vec3d> x;
  for (const CloudFrame& f : frames) x.push_back(f.x);
  return x;
}

std::vector<Vec3d> positions_in_parts(const MatterParts& parts, std::span<const SharedFrame> shared) {
  std::vector<Vec3d> x;
  for (const SharedFrame& s : shared) x.push_back(transpose(parts.rotation) * (s.x - parts.translation));
  return x;
}

ListedChoice unoccupied(const ListedChoice& choice, std::span<const Vec3d> occupied, double tolerance,
                        std::vector<std::string>& messages) {
  const FrameSearch search(occupied);
  ListedChoice left;
  for (std::size_t i = 0; i < choice.position.size(); ++i) {
    if (!search.within(choice.position[i], tolerance).empty()) continue;
    left.position.push_back(choice.position[i]);
    if (!choice.rotation.empty()) left.rotation.push_back(choice.rotation[i]);
  }
  const std::size_t replaced = choice.position.size() - left.position.size();
  if (replaced > 0) messages.push_back(replaced_by_shares(replaced));
  return left;
}

void add_shared(std::span<const SharedFrame> shared, const std::vector<CloudPoint>& points, CloudFrames& set) {
  if (shared.empty()) return;
  std::vector<Vec3d> X;
  X.reserve(points.size());
  for (const CloudPoint& p : points) X.push_back(p.place.X);
  const FrameSearch search(X);
  for (const SharedFrame& s : shared) {
    const ScatteredPlace& near = points[at(search.nearest(s.x, 1).front())].place;
    set.frames.push_back({s.x, Mat3d::identity(), near.dimension, near.axes.column(2), true});
    set.shared.push_back(s);
  }
}

void widen_supports(ScatteredKind kind, const std::vector<CloudPoint>& points, CloudFrames& set, ThreadPool& pool) {
  if (set.shared.empty() || set.reach.neighbours > 0) return;
  reach_points(points, set);
  reach_frames(kind, points, set, pool);
}

std::shared_ptr<const KeptWeights> drop_idle_frames(ScatteredKind kind, const std::vector<CloudPoint>& points,
                                                    CloudFrames& set, std::vector<std::string>& messages,
                                                    ThreadPool& pool) {
  std::shared_ptr<const KeptWeights> weights;
  std::size_t dropped = 0, unshared = 0;
  for (bool all_used = false; !all_used;) {
    weights.reset();  // those of the last round go first
    weights = weights_of(scattered_field(kind, set.frames, set.reach), points, pool);
    std::vector<char> used(set.frames.size(), 0);
    for (std::size_t p = 0; p < points.size(); ++p) {
      const std::span<const int> frames = (*weights)[p].frame;
      if (frames.empty()) {
        throw InputError("the matter at " + text(points[p].place.X) +
                             " is out of reach of every frame; use more frames or a larger weights.radius",
                         Blame::weights);
      }
      for (const int f : frames) used[at(f)] = 1;
    }
    all_used = std::find(used.begin(), used.end(), 0) == used.end();
    if (all_used) break;
    CloudFrames kept;
    kept.reach.neighbours = set.reach.neighbours;
    kept.reach.most = set.reach.most;
    for (std::size_t f = 0; f < used.size(); ++f) {
      if (used[f] == 0) continue;
      kept.frames.push_back(set.frames[f]);
      kept.reach.support.push_back(set.reach.support[f]);
      if (f < set.own)
        ++kept.own;
      else
        kept.shared.push_back(set.shared[f - set.own]);
    }
    dropped += set.own - kept.own;
    unshared += set.shared.size() - kept.shared.size();
    set = std::move(kept);
  }
  if (dropped > 0) messages.push_back(std::to_string(dropped) + " frames that reach no point were dropped");
  if (unshared > 0) messages.push_back(unreached_shares(unshared));
  return weights;
}

void share_grid_frames(std::span<const SharedFrame> shared, double size, CloudSpec& spec) {
  if (shared.empty()) return;
  std::vector<Vec3d> positions;
  for (const CloudFrame& f : spec.frames) positions.push_back(f.x);
  const FrameSearch search(positions);
  std::vector<int> share(positions.size(), -1);
  for (const SharedFrame& s : shared) {
    const int nearest = search.nearest(s.x, 1).front();
    const double distance = norm(positions[at(nearest)] - s.x);
    if (distance > kCoincident * size) refuse_off_grid(s.x, distance);
    refuse_second_share(share[at(nearest)] < 0 ? nullptr : &spec.shared[at(share[at(nearest)])], s);
    if (share[at(nearest)] >= 0) continue;
    share[at(nearest)] = static_cast<int>(spec.shared.size());
    spec.shared.push_back(s);
  }
  std::vector<CloudFrame> own;
  std::vector<int> number(positions.size());
  const int own_count = static_cast<int>(positions.size() - spec.shared.size());
  for (std::size_t f = 0; f < positions.size(); ++f) {
    number[f] = share[f] < 0 ? static_cast<int>(own.size()) : own_count + share[f];
    if (share[f] < 0) own.push_back(spec.frames[f]);
  }
  spec.frames = std::move(own);
  spec.field = renumbered_field(spec.field, std::move(number));
}

}  // namespace fascia
