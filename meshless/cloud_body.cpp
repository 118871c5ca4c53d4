#include "meshless/cloud_body.hpp"

#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "core/geometry/bounds.hpp"
#include "meshless/cloud_parts.hpp"
#include "meshless/gauss.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <sstream>

namespace fascia {

CloudBody::CloudBody(const CloudSpec& spec, Model& model, PointSetBuilder& points)
    : field_(spec.field),
      weights_(spec.weights),
      locate_(spec.locate),
      half_blend_(spec.half_blend),
      interpolates_(spec.grid),
      share_(spec.shared),
      still_(still_nodes(spec.shared)) {
  shared_ = distinct_nodes(spec.shared);
  surface_ = spec.surface;
  segments_ = spec.segments;
  for (const CloudPoint& p : spec.points) volume_ += p.volume;
  mass_ = spec.density * volume_;
  Bounds bounds = bounds_of(surface_.points);
  for (const CloudPoint& p : spec.points) bounds.include(p.place.X);
  size_ = bounds.diagonal();
  places_.reserve(spec.points.size());
  for (const CloudPoint& p : spec.points) places_.push_back(p.place);
  split_points(spec);
  number_frames(spec, model);
  check_still_nodes();
  check_points(spec, model);
  add_points(spec, model, points);
  add_inertia(spec, model);
  describe(spec);
}

namespace {

/// The part of an active stress that a thin law bears: of fibres' share within the sheet, or along the line.
/// @param T  columns, tangents first
ActiveStress within(const ActiveStress& active, const Mat3d& T, Law law) {
  Mat3d P;
  for (int k = 0; k < (law == Law::line ? 1 : 2); ++k) P += outer(T.column(k), T.column(k));
  return {P * active.S * P, active.schedule};
}

}  // namespace

/// Offsets through the thickness (Gauss points) or across the section (four points with the second moments of a disc),
/// each with its part of the volume.
void CloudBody::split_points(const CloudSpec& spec) {
  constexpr double kHardly = 1e-3;
  std::optional<double> borne;  // the largest part of an active stress that a thin law bears
  for (std::size_t place = 0; place < spec.points.size(); ++place) {
    const CloudPoint& p = spec.points[place];
    const Mat3d& T = p.place.axes;
    const PointMaterialSpec m = spec.material(p.place.X);
    const auto add = [&](const Vec3d& offset, double part, Law law) {
      point_places_.push_back({place, offset});
      const int axes = is_thin(law) ? static_cast<int>(axes_.size()) : -1;
      points_.push_back({m, p.place.X + offset, p.volume * part, p.place.X, law, spec.affine, axes});
      if (axes < 0) return;
      axes_.push_back(T);
      if (!m.active) return;
      points_.back().active = std::make_shared<const ActiveStress>(within(*m.active, T, law));
      borne = std::max(borne.value_or(0), norm(points_.back().active->S) / norm(m.active->S));
    };
    if (p.place.dimension == 3 || spec.through == 1) {
      add({}, 1, m.law);
    } else if (p.place.dimension == 2) {
      for (const GaussPoint& g : gauss_legendre(spec.through > 0 ? spec.through : 2))
        add(T.column(2) * ((g.x - 0.5) * p.extent), g.weight, Law::sheet);
    } else {
      const double r = 0.5 * p.extent;
      for (int k = 0; k < 4; ++k)
        add(T.column(1) * (k % 2 == 0 ? r : -r) + T.column(2) * (k < 2 ? r : -r), 0.25, Law::line);
    }
  }
  if (borne && *borne < kHardly)
    messages_.push_back(
        "has fibres across the sheet or line, which bears a stress within it alone: they do nothing; give fibres a "
        "direction along it");
}

void CloudBody::number_frames(const CloudSpec& spec, Model& model) {
  first_node_ = model.node_count();
  node_count_ = static_cast<int>(spec.frames.size());
  for (const CloudFrame& f : spec.frames) {
    model.rest_position.push_back(f.x);
    model.rest_orientation.push_back(f.orientation);
    model.frame_kind.push_back(spec.affine ? FrameKind::affine : FrameKind::rigid);
    frame_position_.push_back(f.x);
    on_boundary_.push_back(f.on_boundary ? 1 : 0);
  }
  for (const SharedFrame& s : share_) frame_position_.push_back(s.x);
  on_boundary_.insert(on_boundary_.end(), shared_.size(), 1);
}

bool CloudBody::follows_still(std::span<const int> frames) const {
  return !still_.empty() && std::any_of(frames.begin(), frames.end(), [&](int frame) {
    return frame >= node_count_ && !share_[at(frame - node_count_)].turns;
  });
}

/// Nodes that move a place, ascending.
std::vector<int> CloudBody::nodes_at(const WeightsView& weights) const {
  std::vector<int> nodes;
  nodes.reserve(weights.frame.size());
  for (const int frame : weights.frame) nodes.push_back(node_of(frame));
  if (!share_.empty()) make_distinct(nodes);
  assert(std::is_sorted(nodes.begin(), nodes.end()));
  return nodes;
}

/// Displacements alone must give F exactly where vertices without rotation take part.
void CloudBody::check_still_nodes() const {
  constexpr double kRounding = 1e-9;
  for (std::size_t p = 0; p < places_.size(); ++p) {
    const WeightsView weights = (*weights_)[p];
    if (!follows_still(weights.frame)) continue;
    if (places_[p].dimension < 3)
      throw InputError("a sheet or line turns with its frames, but the matter at " + text(places_[p].X) +
                           " follows vertices without rotation; share them with rotations = true",
                       Blame::frames);
    if (norm(weights.consistent - Mat3d::identity()) > kRounding)
      throw InputError("the weights at " + text(places_[p].X) +
                           " do not reproduce linear fields, which vertices without rotation need; share them with "
                           "rotations = true, or use kind = \"mls\" and more frames or a larger weights.radius",
                       Blame::weights);
  }
}

/// A point resists six strains: with fewer of these than degrees of freedom, frames would be loose. Of a shared node,
/// what its own body does not hold counts: the rotation of a vertex.
void CloudBody::check_points(const CloudSpec& spec, const Model& model) const {
  std::size_t dofs = at(node_count_) * (spec.affine ? 12 : 6);
  int turned = 0;
  for (const int node : shared_) {
    const bool turns = !std::binary_search(still_.begin(), still_.end(), node);
    const bool held = at(node) < model.inertia.size() && trace(model.inertia[at(node)].second) > 0;
    if (turns && !held) ++turned;
  }
  dofs += at(3 * turned);
  if (6 * points_.size() >= dofs) return;
  const bool thin = is_thin(points_[0].law);
  throw InputError(std::to_string(points_.size()) + " integration points cannot hold " + std::to_string(node_count_) +
                       (spec.affine ? " affine" : "") + " frames" +
                       (turned > 0 ? " and the rotations of " + std::to_string(turned) + " shared vertices" : "") +
                       "; use at least " + std::to_string((dofs + 5) / 6) +
                       (thin ? ", those through the matter included"
                             : ", and several times as many for accuracy; of a solid thinner than their spacing take "
                               "a rectangle, annulus or line with thickness or radius"),
                   Blame::points);
}

Attachment CloudBody::attach_place(const ScatteredPlace& place, const WeightsView& weights, const Vec3d& offset) const {
  const Mat3d halved = half_blend_ ? weights.consistent : Mat3d{};
  const bool still = follows_still(weights.frame);
  Attachment a;
  a.nodes.reserve(weights.frame.size());
  a.influences.reserve(weights.frame.size());
  for (std::size_t k = 0; k < weights.frame.size(); ++k) {
    const int frame = weights.frame[k];
    a.nodes.push_back(node_of(frame));
    const Vec3d d = place.X - frame_position_[at(frame)];
    const Influence own = still ? Influence{weights.w[k], weights.gradient[k], {}, {}}
                                : blended(weights.w[k], weights.gradient[k], halved, d, offset);
    a.influences.push_back(frame < node_count_ ? own : on_node(own, share_[at(frame - node_count_)].arm));
  }
  if (!share_.empty()) merge_nodes(a);
  return a;
}

Attachment CloudBody::attach(const Vec3d& X) const {
  const Location l = locate_(X);
  return attach_place(l.place, field_(l.place), l.offset);
}

Attachment CloudBody::attach_point(std::size_t point) const {
  const PointPlace& p = point_places_[point];
  return attach_place(places_[p.place], (*weights_)[p.place], p.offset);
}

/// Any partition of unity gives a rigid motion its exact kinetic energy, since each frame takes the full lever; one
/// that is never negative gives every frame a positive mass.
void CloudBody::add_inertia(const CloudSpec& spec, Model& model) {
  model.inertia.resize(model.rest_position.size());
  const KeptWeights& share = spec.share ? *spec.share : *weights_;
  std::vector<MassShare> masses;
  for (std::size_t q = 0; q < points_.size(); ++q) {
    const double mass_damping = spec.material(points_[q].middle).mass_damping;
    if (mass_damping > 0) model.mass_damping.resize(model.rest_position.size());
    const WeightsView w = share[point_places_[q].place];
    masses.clear();
    for (std::size_t k = 0; k < w.frame.size(); ++k) {
      const int node = node_of(w.frame[k]);
      const bool turns = w.frame[k] < node_count_ || share_[at(w.frame[k] - node_count_)].turns;
      masses.push_back(
          {node, spec.density * points_[q].volume * w.w[k], points_[q].X - model.rest_position[at(node)], turns});
    }
    add_masses(masses, mass_damping, model);
  }
  if (!model.mass_damping.empty()) model.mass_damping.resize(model.rest_position.size());
}

/// Sheets, and lines of scattered frames, lock in bending where the spacing h of frames is large beside the thickness
/// t: a clamped square plate sags 2 % too little at h²/(L t) = 0.3, 12 % at 1.4, 26 % at 2.8, L its diagonal
/// (docs/decisions/thin_bodies.md).
void CloudBody::warn_of_locking(const CloudSpec& spec) {
  constexpr double kLocking = 0.5;
  double worst = 0, thickness = 0;
  for (const CloudPoint& p : spec.points) {
    if (p.place.dimension == 3 || (p.place.dimension == 1 && spec.grid) || spec.through == 1) continue;
    const double t = p.place.dimension == 2 ? p.extent : 2 * p.extent;
    const double ratio = spec.spacing * spec.spacing / (size_ * t);
    if (ratio <= worst) continue;
    worst = ratio;
    thickness = t;
  }
  if (worst < kLocking) return;
  std::ostringstream out;
  out.precision(2);
  out << "frames " << spec.spacing << " m apart are far for matter " << thickness
      << " m thick: clamped bending comes out too stiff; put them less than " << std::sqrt(kLocking * size_ * thickness)
      << " m apart";
  messages_.push_back(out.str());
}

/// Frames whose weights reach over many others hardly differ from the mean of these: motions of single frames strain
/// next to nothing, and the stiffness is as good as singular. On a line of 54 frames Newton's method takes 2 iterations
/// at 8 frames a point, 18 at 16, and finds no end at 24.
void CloudBody::warn_of_overlap(const CloudSpec& spec) {
  constexpr double kFar = 5;  // spacings
  double reach = 0, count = 0;
  for (std::size_t p = 0; p < places_.size(); ++p) {
    const std::span<const int> frames = (*weights_)[p].frame;
    double farthest = 0;
    for (const int f : frames) farthest = std::max(farthest, norm(frame_position_[at(f)] - places_[p].X));
    reach += farthest / static_cast<double>(places_.size());
    count += static_cast<double>(frames.size()) / static_cast<double>(places_.size());
  }
  reach /= spec.spacing;
  if (reach <= kFar) return;
  std::ostringstream out;
  out.precision(2);
  out << "points follow " << count << " frames, as far as " << reach
      << " spacings away (means): so many hardly differ in what they move, and the solver may take long or find no "
         "solution; use a smaller weights.neighbours or weights.radius, so that they are within 2 to "
      << kFar << " spacings";
  messages_.push_back(out.str());
}

void CloudBody::describe(const CloudSpec& spec) {
  const KeptWeights& weights = *weights_;
  warn_of_locking(spec);
  if (spec.grid && !share_.empty()) choices_.push_back(replaced_by_shares(share_.size()));
  if (spec.grid) return;
  warn_of_overlap(spec);
  std::size_t least = frame_position_.size(), most = 0, lowered = 0, first_lowered = 0, narrowest = 0;
  for (std::size_t p = 0; p < weights.size(); ++p) {
    least = std::min(least, weights[p].frame.size());
    most = std::max(most, weights[p].frame.size());
    if (weights[p].spread < weights[narrowest].spread) narrowest = p;
    if (weights[p].lowered && lowered++ == 0) first_lowered = p;
  }
  const bool consistent = trace(weights[0].consistent) > 0;
  const Consistency c = consistency(weights, frame_position_, places_, spec.spacing);
  std::ostringstream out;
  out.precision(2);
  out << "weights: " << least << " to " << most << " frames a point; ";
  if (consistent && lowered == 0)
    out << "linear fields along the matter are reproduced";
  else if (consistent)
    out << "linear fields along the matter are reproduced but at " << lowered << " of " << places_.size() << " points";
  else
    out << "linear fields are off by " << c.position << " spacings (rms), a uniform stretch by " << 100 * c.gradient
        << " %";
  if (consistent)
    out << "; frames are spread least about " << text(places_[narrowest].X) << ", by " << weights[narrowest].spread
        << " in their narrowest direction";
  quality_ = out.str();
  if (!consistent) messages_.push_back(quality_ + "; use kind = \"mls\" where the stiffness matters");
  if (lowered > 0)
    messages_.push_back(std::to_string(lowered) +
                        " points have too few frames around them, or all in a plane, for linear weights in every "
                        "direction; their order was lowered (the first at " +
                        text(places_[first_lowered].X) + "); use more frames or a larger weights.radius");
}

}  // namespace fascia
