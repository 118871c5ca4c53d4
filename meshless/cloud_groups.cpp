#include "core/geometry/bounds.hpp"
#include "meshless/cloud_body.hpp"

#include "core/base/errors.hpp"
#include "core/base/index.hpp"

#include <algorithm>
#include <compare>
#include <cstdint>
#include <map>

namespace fascia {

namespace {

constexpr std::size_t kFull = kGroupSize;

/// Nodes of all points, ascending for each.
struct PointNodes {
  std::vector<std::size_t> begin{0};
  std::vector<int> node;

  std::span<const int> of(std::size_t point) const {
    return std::span(node).subspan(begin[point], begin[point + 1] - begin[point]);
  }
};

/// A point with its law and, for quick comparison, its first nodes.
struct Keyed {
  Law law{};
  std::uint64_t first = 0;
  std::size_t point = 0;
};

/// By law, then by nodes, then by number.
std::vector<Keyed> by_nodes(const std::vector<BodyPoint>& points, const PointNodes& nodes) {
  std::vector<Keyed> keyed;
  keyed.reserve(points.size());
  for (std::size_t q = 0; q < points.size(); ++q) {
    const std::span<const int> n = nodes.of(q);
    const auto number = [&](std::size_t k) { return k < n.size() ? static_cast<std::uint64_t>(n[k]) + 1 : 0; };
    keyed.push_back({points[q].law, number(0) << 32U | number(1), q});
  }
  std::sort(keyed.begin(), keyed.end(), [&](const Keyed& a, const Keyed& b) {
    if (a.law != b.law) return a.law < b.law;
    if (a.first != b.first) return a.first < b.first;
    const std::span<const int> m = nodes.of(a.point), n = nodes.of(b.point);
    const auto order = std::lexicographical_compare_three_way(m.begin(), m.end(), n.begin(), n.end());
    return std::is_eq(order) ? a.point < b.point : std::is_lt(order);
  });
  return keyed;
}

}  // namespace

/// As attach_point() says, but where a point follows nodes that do not turn: the weights of its blended rotation, among
/// those that do.
Attachment CloudBody::attach_for_mechanics(std::size_t point) const {
  Attachment a = attach_point(point);
  if (!still_.empty()) blend_turning(a.nodes, still_, a.influences);
  return a;
}

/// Points with the same frames make groups of their own; the others are cut into groups by halving their box, since
/// points near one another share most frames.
void CloudBody::add_points(const CloudSpec& spec, const Model& model, PointSetBuilder& builder) {
  PointNodes nodes;
  nodes.begin.reserve(points_.size() + 1);
  for (std::size_t q = 0; q < points_.size(); ++q) {
    const std::vector<int> own = nodes_at((*weights_)[point_places_[q].place]);
    nodes.node.insert(nodes.node.end(), own.begin(), own.end());
    nodes.begin.push_back(nodes.node.size());
  }
  if (!still_.empty()) find_stabilized(spec, model);
  std::vector<std::size_t> members;
  members.reserve(points_.size());
  const std::vector<Keyed> keyed = by_nodes(points_, nodes);
  for (const Keyed& k : keyed) members.push_back(k.point);
  std::vector<Group> groups;
  std::map<Law, std::vector<std::size_t>> rest;
  for (std::size_t first = 0, end = 0; first < keyed.size(); first = end) {
    const Law law = keyed[first].law;
    const std::span<const int> own = nodes.of(keyed[first].point);
    const auto same = [&](const Keyed& k) {
      const std::span<const int> n = nodes.of(k.point);
      return k.law == law && std::equal(n.begin(), n.end(), own.begin(), own.end());
    };
    while (end < keyed.size() && same(keyed[end])) ++end;
    const std::span<std::size_t> run = std::span(members).subspan(first, end - first);
    if (2 * run.size() >= kFull)
      split_group(run, kUnsorted, groups);
    else
      rest[law].insert(rest[law].end(), run.begin(), run.end());
  }
  for (auto& [law, others] : rest) split_group(others, kUnsorted, groups);
  std::size_t slots = 0;
  for (const Group& g : groups) slots += g.frames;
  builder.reserve(groups.size(), slots);
  for (const Group& g : groups) add_group(spec, g.members, builder);
  if (spec.affine) add_middle_ties(spec, builder);
}

/// Says which points have enough frames that turn for a stabilisation.
void CloudBody::find_stabilized(const CloudSpec& spec, const Model& model) {
  std::vector<char> held(at(model.node_count()));
  for (std::size_t q = 0; q < points_.size(); ++q) {
    Attachment a = attach_point(q);
    const bool still = std::any_of(a.nodes.begin(), a.nodes.end(),
                                   [&](int node) { return std::binary_search(still_.begin(), still_.end(), node); });
    point_places_[q].stabilized = blend_turning(a.nodes, still_, a.influences);
    if (still && !(point_places_[q].stabilized && spec.stabilization > 0)) continue;
    for (const int node : a.nodes) held[at(node)] = 1;
  }
  check_held(*this, model, still_, held);
}

/// Affine frames of thin matter are tied to F on its middle, where neither bending nor torsion turns it against them.
void CloudBody::add_middle_ties(const CloudSpec& spec, PointSetBuilder& builder) const {
  for (std::size_t p = 0; p < places_.size(); ++p) {
    if (places_[p].dimension == 3 || spec.through == 1) continue;  // tied at their points
    const Attachment a = attach_place(places_[p], (*weights_)[p], {});
    const double mu = spec.material(places_[p].X).mu;
    const PointSample tie{{}, places_[p].X, spec.points[p].volume, spec.stabilization * mu, 0, a.influences, {}};
    builder.add_points(a.nodes, std::span(&tie, 1), spec.spacing,
                       {Law::st_venant_kirchhoff, Stabilization::affine, true});
  }
}

/// @param members       reordered
/// @param sorted_along  axis of the cut that made it, along which a group's points are put in order; kUnsorted: no cut
void CloudBody::split_group(std::span<std::size_t> members, int sorted_along, std::vector<Group>& groups) const {
  const auto along = [this](int axis) {
    return [this, axis](std::size_t p, std::size_t q) {
      const double x = points_[p].X[axis], y = points_[q].X[axis];
      return x < y || (x == y && p < q);
    };
  };
  const bool fits = members.size() <= kFull;
  if (fits) {
    if (sorted_along != kUnsorted) std::sort(members.begin(), members.end(), along(sorted_along));
    std::vector<int> nodes;
    for (const std::size_t q : members)
      for (const int frame : (*weights_)[point_places_[q].place].frame) nodes.push_back(node_of(frame));
    make_distinct(nodes);
    if (nodes.size() <= at(kMaxSlots)) {
      groups.push_back({members, nodes.size()});
      return;
    }
    if (members.size() == 1)
      throw InputError(std::to_string(nodes.size()) + " frames reach one point; at most " + std::to_string(kMaxSlots) +
                           " may: use a smaller weights.radius or fewer neighbours",
                       Blame::weights);
  }
  Bounds bounds;
  for (const std::size_t q : members) bounds.include(points_[q].X);
  const int axis = longest_axis(bounds);
  // Whole groups in the first half.
  const std::size_t half = members.size() / 2;
  const std::size_t cut = fits ? half : std::max(kFull, (half + kFull / 2) / kFull * kFull);
  std::nth_element(members.begin(), members.begin() + static_cast<std::ptrdiff_t>(cut), members.end(), along(axis));
  split_group(members.first(cut), axis, groups);
  split_group(members.subspan(cut), axis, groups);
}

void CloudBody::add_group(const CloudSpec& spec, std::span<const std::size_t> members, PointSetBuilder& builder) const {
  std::vector<Attachment> attachments;
  std::vector<int> nodes;
  for (const std::size_t q : members) {
    attachments.push_back(attach_for_mechanics(q));
    nodes.insert(nodes.end(), attachments.back().nodes.begin(), attachments.back().nodes.end());
  }
  make_distinct(nodes);
  std::vector<PointSample> samples;
  samples.reserve(members.size());
  for (std::size_t m = 0; m < members.size(); ++m) {
    const std::size_t q = members[m];
    const BodyPoint& p = points_[q];
    // Torsion turns material off a line's axis against the frame: drilling would resist it, and a line needs none.
    const bool none = p.law == Law::line || (p.law == Law::sheet && spec.affine) || !point_places_[q].stabilized;
    const double stabilization = none ? 0.0 : spec.stabilization * p.mu;
    PointSample s{{thin_lame(p.law, p), p.own, p.viscosity, p.active},
                  p.X,
                  p.volume,
                  stabilization,
                  spec.material(p.middle).stiffness_damping,
                  std::vector<Influence>(nodes.size()),
                  p.axes < 0 ? Mat3d{} : axes_[at(p.axes)],
                  static_cast<int>(q)};
    std::size_t slot = 0;  // both lists ascend
    for (std::size_t k = 0; k < attachments[m].nodes.size(); ++k) {
      while (nodes[slot] != attachments[m].nodes[k]) ++slot;
      s.influences[slot] = attachments[m].influences[k];
    }
    samples.push_back(std::move(s));
  }
  builder.add_points(
      nodes, samples, spec.spacing,
      {points_[members[0]].law, spec.affine ? Stabilization::affine : Stabilization::drilling, spec.affine});
}

}  // namespace fascia
