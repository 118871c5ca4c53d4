#include "core/geometry/bounds.hpp"
#include "meshless/cloud_body.hpp"

#include "core/base/errors.hpp"
#include "core/base/index.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace fascia {

namespace {

constexpr std::size_t kFull = kGroupSize;

std::set<int> all_nodes(const std::vector<std::size_t>& members, const std::vector<Attachment>& attachments) {
  std::set<int> nodes;
  for (const std::size_t q : members) nodes.insert(attachments[q].nodes.begin(), attachments[q].nodes.end());
  return nodes;
}

}  // namespace

/// Points with the same frames make groups of their own; the others are cut into groups by halving their box, since
/// points near one another share most frames.
void CloudBody::add_points(const CloudSpec& spec, const std::vector<ScatteredWeights>& weights, const Model& model,
                           PointSetBuilder& builder) {
  std::vector<Attachment> attachments;
  std::map<std::pair<Law, std::vector<int>>, std::vector<std::size_t>> same;
  for (std::size_t q = 0; q < points_.size(); ++q) {
    const PointPlace& p = point_places_[q];
    attachments.push_back(attach_place(places_[p.place], weights[p.place], p.offset));
    same[{points_[q].law, attachments.back().nodes}].push_back(q);
  }
  if (!still_.empty()) take_turning_weights(spec, model, attachments);
  std::map<Law, std::vector<std::size_t>> rest;
  for (const auto& [key, members] : same) {
    if (2 * members.size() >= kFull)
      split_group(spec, members, attachments, builder);
    else
      rest[key.first].insert(rest[key.first].end(), members.begin(), members.end());
  }
  for (const auto& [law, members] : rest) split_group(spec, members, attachments, builder);
  if (spec.affine) add_middle_ties(spec, weights, builder);
}

/// Weights of the points' blended rotations, among nodes that turn.
void CloudBody::take_turning_weights(const CloudSpec& spec, const Model& model, std::vector<Attachment>& attachments) {
  std::vector<char> held(at(model.node_count()));
  for (std::size_t q = 0; q < attachments.size(); ++q) {
    Attachment& a = attachments[q];
    const bool still = std::any_of(a.nodes.begin(), a.nodes.end(),
                                   [&](int node) { return std::binary_search(still_.begin(), still_.end(), node); });
    point_places_[q].stabilized = blend_turning(a.nodes, still_, a.influences);
    if (still && !(point_places_[q].stabilized && spec.stabilization > 0)) continue;
    for (const int node : a.nodes) held[at(node)] = 1;
  }
  check_held(*this, model, still_, held);
}

/// Affine frames of thin matter are tied to F on its middle, where neither bending nor torsion turns it against them.
void CloudBody::add_middle_ties(const CloudSpec& spec, const std::vector<ScatteredWeights>& weights,
                                PointSetBuilder& builder) const {
  for (std::size_t p = 0; p < places_.size(); ++p) {
    if (places_[p].dimension == 3 || spec.through == 1) continue;  // tied at their points
    const Attachment a = attach_place(places_[p], weights[p], {});
    const double mu = spec.material(places_[p].X).mu;
    const PointSample tie{{}, places_[p].X, spec.points[p].volume, spec.stabilization * mu, 0, a.influences, {}};
    builder.add_points(a.nodes, std::span(&tie, 1), spec.spacing,
                       {Law::st_venant_kirchhoff, Stabilization::affine, true});
  }
}

void CloudBody::split_group(const CloudSpec& spec, std::vector<std::size_t> members,
                            const std::vector<Attachment>& attachments, PointSetBuilder& builder) const {
  const bool fits = members.size() <= kFull;
  if (fits && all_nodes(members, attachments).size() <= at(kMaxSlots))
    return add_group(spec, members, attachments, builder);
  if (members.size() == 1)
    throw InputError(std::to_string(attachments[members[0]].nodes.size()) + " frames reach one point; at most " +
                         std::to_string(kMaxSlots) + " may: use a smaller weights.radius or fewer neighbours",
                     Blame::weights);
  Bounds bounds;
  for (const std::size_t q : members) bounds.include(points_[q].X);
  const int axis = longest_axis(bounds);
  std::sort(members.begin(), members.end(), [&](std::size_t p, std::size_t q) {
    const double x = points_[p].X[axis], y = points_[q].X[axis];
    return x < y || (x == y && p < q);
  });
  // Whole groups in the first half.
  const std::size_t half = members.size() / 2;
  const auto cut = static_cast<std::ptrdiff_t>(fits ? half : std::max(kFull, (half + kFull / 2) / kFull * kFull));
  split_group(spec, {members.begin(), members.begin() + cut}, attachments, builder);
  split_group(spec, {members.begin() + cut, members.end()}, attachments, builder);
}

void CloudBody::add_group(const CloudSpec& spec, const std::vector<std::size_t>& members,
                          const std::vector<Attachment>& attachments, PointSetBuilder& builder) const {
  const std::set<int> nodes = all_nodes(members, attachments);
  std::vector<PointSample> samples;
  for (const std::size_t q : members) {
    const BodyPoint& p = points_[q];
    // Torsion turns material off a line's axis against the frame: drilling would resist it, and a line needs none.
    const bool none = p.law == Law::line || (p.law == Law::sheet && spec.affine) || !point_places_[q].stabilized;
    const double stabilization = none ? 0.0 : spec.stabilization * p.mu;
    PointSample s{{thin_lame(p.law, p), p.own, p.viscosity, p.active},
                  p.X,
                  p.volume,
                  stabilization,
                  spec.material(p.middle).stiffness_damping,
                  {},
                  p.axes < 0 ? Mat3d{} : axes_[at(p.axes)],
                  static_cast<int>(q)};
    const Attachment& a = attachments[q];
    for (const int node : nodes) {
      const auto k = std::lower_bound(a.nodes.begin(), a.nodes.end(), node) - a.nodes.begin();
      const bool there = at(static_cast<int>(k)) < a.nodes.size() && a.nodes[at(static_cast<int>(k))] == node;
      s.influences.push_back(there ? a.influences[at(static_cast<int>(k))] : Influence{});
    }
    samples.push_back(std::move(s));
  }
  builder.add_points(
      std::vector<int>(nodes.begin(), nodes.end()), samples, spec.spacing,
      {points_[members[0]].law, spec.affine ? Stabilization::affine : Stabilization::drilling, spec.affine});
}

}  // namespace fascia
