#include "meshless/cloud_body.hpp"

#include "core/math/index.hpp"
#include "core/model/errors.hpp"
#include "meshless/gauss.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace fascia {

namespace {

std::string text(const Vec3d& x) {
  std::ostringstream out;
  out << "(" << x[0] << ", " << x[1] << ", " << x[2] << ")";
  return out.str();
}

}  // namespace

CloudBody::CloudBody(const CloudSpec& spec, Model& model, PointSetBuilder& points)
    : field_(spec.field), locate_(spec.locate), half_blend_(spec.half_blend), interpolates_(spec.grid) {
  surface_ = spec.surface;
  segments_ = spec.segments;
  for (const CloudPoint& p : spec.points) volume_ += p.volume;
  mass_ = spec.density * volume_;
  Vec3d low = spec.points.front().place.X, high = low;
  const auto include = [&](const Vec3d& x) {
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], x[a]);
      high[a] = std::max(high[a], x[a]);
    }
  };
  for (const CloudPoint& p : spec.points) include(p.place.X);
  for (const Vec3d& x : surface_.points) include(x);
  size_ = norm(high - low);
  places_ = split_points(spec);
  number_frames(spec, model);
  check_points(spec);
  add_points(spec, points);
  add_inertia(spec, model);
  describe(spec);
}

/// Offsets through the thickness (Gauss points) or across the section (four points with the second moments of a disc),
/// each with its part of the volume.
std::vector<CloudBody::PointPlace> CloudBody::split_points(const CloudSpec& spec) {
  std::vector<PointPlace> places;
  for (const CloudPoint& p : spec.points) {
    const Mat3d& T = p.place.axes;
    const PointMaterialSpec m = spec.material(p.place.X);
    const auto add = [&](const Vec3d& offset, double part, Law law) {
      places.push_back({p.place, offset});
      points_.push_back({p.place.X + offset, p.volume * part, m.lambda, m.mu, p.place.X, law, T, spec.affine});
    };
    if (p.place.dimension == 3 || spec.through == 1) {
      add({}, 1, Law::solid);
    } else if (p.place.dimension == 2) {
      for (const GaussPoint& g : gauss_legendre(spec.through > 0 ? spec.through : 2))
        add(T.column(2) * ((g.x - 0.5) * p.extent), g.weight, Law::sheet);
    } else {
      const double r = 0.5 * p.extent;
      for (int k = 0; k < 4; ++k)
        add(T.column(1) * (k % 2 == 0 ? r : -r) + T.column(2) * (k < 2 ? r : -r), 0.25, Law::line);
    }
  }
  return places;
}

/// Frames that move no point would be free: they are left out.
void CloudBody::number_frames(const CloudSpec& spec, Model& model) {
  std::vector<char> used(spec.frames.size(), 0);
  for (const CloudPoint& p : spec.points) {
    const ScatteredWeights w = field_(p.place);
    if (w.frame.empty())
      throw InputError("the matter at " + text(p.place.X) +
                           " is out of reach of every frame; use more frames or a larger weights.radius",
                       Blame::weights);
    for (const int f : w.frame) used[at(f)] = 1;
  }
  first_frame_ = model.node_count();
  node_of_frame_.assign(spec.frames.size(), -1);
  for (std::size_t f = 0; f < spec.frames.size(); ++f) {
    if (used[f] == 0) continue;
    node_of_frame_[f] = model.node_count();
    model.rest_position.push_back(spec.frames[f].x);
    model.rest_orientation.push_back(spec.frames[f].orientation);
    model.frame_kind.push_back(spec.affine ? FrameKind::affine : FrameKind::rigid);
    frame_position_.push_back(spec.frames[f].x);
    on_boundary_.push_back(spec.frames[f].on_boundary ? 1 : 0);
  }
  frame_count_ = model.node_count() - first_frame_;
  const auto dropped = std::count(used.begin(), used.end(), 0);
  if (dropped > 0) messages_.push_back(std::to_string(dropped) + " frames that reach no point were dropped");
}

/// A point resists six strains: with fewer of these than degrees of freedom, frames would be loose.
void CloudBody::check_points(const CloudSpec& spec) const {
  const std::size_t dofs = at(frame_count_) * (spec.affine ? 12 : 6);
  if (6 * places_.size() >= dofs) return;
  const bool thin = points_[0].law != Law::solid;
  throw InputError(std::to_string(places_.size()) + " integration points cannot hold " + std::to_string(frame_count_) +
                       (spec.affine ? " affine" : "") + " frames; use at least " + std::to_string(dofs / 6) +
                       (thin ? ", those through the matter included" : "") + ", and several times as many for accuracy",
                   Blame::points);
}

Attachment CloudBody::attach_place(const ScatteredPlace& place, const Vec3d& offset) const {
  const ScatteredWeights weights = field_(place);
  const Mat3d halved = half_blend_ ? weights.consistent : Mat3d{};
  Attachment a;
  for (std::size_t k = 0; k < weights.frame.size(); ++k) {
    const int node = node_of_frame_[at(weights.frame[k])];
    if (node < 0) continue;  // a dropped frame, beside the matter
    a.nodes.push_back(node);
    a.influences.push_back(blended(weights.w[k], weights.gradient[k], halved, place.X - frame_position(node), offset));
  }
  return a;
}

Attachment CloudBody::attach(const Vec3d& X) const {
  const Location l = locate_(X);
  return attach_place(l.place, l.offset);
}

Attachment CloudBody::attach_point(std::size_t point) const {
  return attach_place(places_[point].place, places_[point].offset);
}

/// Any partition of unity gives a rigid motion its exact kinetic energy, since each frame takes the full lever; one
/// that is never negative gives every frame a positive mass.
void CloudBody::add_inertia(const CloudSpec& spec, Model& model) {
  model.inertia.resize(model.rest_position.size());
  std::size_t q = 0;
  for (const CloudPoint& p : spec.points) {
    const ScatteredWeights share = spec.share(p.place);
    const double mass_damping = spec.material(p.place.X).mass_damping;
    if (mass_damping > 0) model.mass_damping.resize(model.rest_position.size());
    double reached = 0;
    for (std::size_t k = 0; k < share.frame.size(); ++k)
      if (node_of_frame_[at(share.frame[k])] >= 0) reached += share.w[k];
    for (; q < places_.size() && places_[q].place.X == p.place.X && places_[q].place.dimension == p.place.dimension;
         ++q) {
      for (std::size_t k = 0; k < share.frame.size(); ++k) {
        const int node = node_of_frame_[at(share.frame[k])];
        if (node < 0) continue;
        const double m = spec.density * points_[q].volume * share.w[k] / reached;
        const Vec3d d = points_[q].X - frame_position(node);
        const FrameInertia part{m, d * m, outer(d, d) * m};
        model.inertia[at(node)] += part;
        if (mass_damping > 0)
          model.mass_damping[at(node)] += {m * mass_damping, part.first * mass_damping, part.second * mass_damping};
      }
    }
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

void CloudBody::describe(const CloudSpec& spec) {
  warn_of_locking(spec);
  if (spec.grid) return;
  std::vector<ScatteredWeights> weights;
  std::vector<ScatteredPlace> places;
  std::vector<Vec3d> positions;
  std::size_t least = spec.frames.size(), most = 0, lowered = 0;
  Vec3d lowered_at;
  for (const CloudFrame& f : spec.frames) positions.push_back(f.x);
  for (const CloudPoint& p : spec.points) {
    places.push_back(p.place);
    weights.push_back(field_(p.place));
    least = std::min(least, weights.back().frame.size());
    most = std::max(most, weights.back().frame.size());
    if (!weights.back().lowered) continue;
    if (lowered++ == 0) lowered_at = p.place.X;
  }
  const bool consistent = trace(weights.front().consistent) > 0;
  const Consistency c = consistency(weights, positions, places, spec.spacing);
  std::ostringstream out;
  out.precision(2);
  out << "weights: " << least << " to " << most << " frames a point; ";
  if (consistent && lowered == 0)
    out << "linear fields along the matter are reproduced";
  else if (consistent)
    out << "linear fields along the matter are reproduced but at " << lowered << " of " << places.size() << " points";
  else
    out << "linear fields are off by " << c.position << " spacings (rms), a uniform stretch by " << 100 * c.gradient
        << " %";
  quality_ = out.str();
  if (!consistent) messages_.push_back(quality_ + "; use kind = \"mls\" where the stiffness matters");
  if (lowered > 0)
    messages_.push_back(std::to_string(lowered) +
                        " points have too few frames around them, or all in a plane, for linear weights in every "
                        "direction; their order was lowered (the first at " +
                        text(lowered_at) + "); use more frames or a larger weights.radius");
}

}  // namespace fascia
