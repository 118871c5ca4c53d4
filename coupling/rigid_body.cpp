#include "coupling/rigid_body.hpp"

#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "core/geometry/bounds.hpp"
#include "core/geometry/inside.hpp"
#include "core/geometry/text.hpp"

#include <cmath>

namespace fascia {

namespace {

using message::text;

/// A point near all triangles: moments about it lose no digits far from the origin.
Vec3d near_point(const TriangleMesh& surface) {
  Bounds bounds;
  for (const auto& t : surface.triangles)
    for (const int node : t) bounds.include(surface.points[at(node)]);
  return bounds.empty() ? Vec3d{} : (bounds.low + bounds.high) * 0.5;
}

/// Sums over cells whose corners are those of a triangle and, of tetrahedra, the origin: of measure m, with n corners
/// in all, ∫ x = m Σ a / n and ∫ x xᵀ = m (Σ a aᵀ + Σ a Σ aᵀ) / (n (n + 1)).
template <class Measure>
MassProperties properties(const TriangleMesh& surface, int corners, const Measure& measure) {
  const Vec3d origin = near_point(surface);
  MassProperties sum;
  for (const auto& t : surface.triangles) {
    const Vec3d a = surface.points[at(t[0])] - origin, b = surface.points[at(t[1])] - origin,
                c = surface.points[at(t[2])] - origin, s = a + b + c;
    const double m = measure(a, b, c);
    sum.measure += m;
    sum.center += s * (m / corners);
    sum.second += (outer(a, a) + outer(b, b) + outer(c, c) + outer(s, s)) * (m / (corners * (corners + 1)));
  }
  if (!(sum.measure > 0)) return {sum.measure, origin, {}};
  const Vec3d mean = sum.center * (1 / sum.measure);
  return {sum.measure, origin + mean, sym(sum.second - outer(mean, mean) * sum.measure)};
}

/// Leading minors of M + shift 1 are positive.
bool positive(Mat3d M, double shift) {
  M += Mat3d::diagonal(shift);
  return M(0, 0) > 0 && M(0, 0) * M(1, 1) - M(0, 1) * M(1, 0) > 0 && determinant(M) > 0;
}

/// S = tr(I)/2 1 − I of a given inertia.
Mat3d second_moment(const Mat3d& I) {
  constexpr double rounding = 1e-9;
  const double scale = trace(I);
  if (!(scale > 0) || !std::isfinite(norm(I)))
    throw InputError("the inertia of the rigid body is not positive; give its moments about the mass centre [kg m²]");
  if (norm(I - transpose(I)) > rounding * scale)
    throw InputError("the inertia of the rigid body is not symmetric; entries (i, j) and (j, i) must be the same");
  const Mat3d unit = sym(I) * (1 / scale), S = Mat3d::diagonal(0.5) - unit;
  if (!positive(unit, -rounding))
    throw InputError("the inertia of the rigid body is not positive; every moment about an axis must be above 0");
  if (!positive(S, rounding))
    throw InputError(
        "no mass has the inertia of the rigid body: a principal moment is larger than the sum of the two others; check "
        "the signs and the units [kg m²]");
  return S * scale;
}

/// What the surface says of the mass: the volume where it is closed.
MassProperties measured(const RigidBodySpec& spec) {
  if (!spec.closed) {
    const MassProperties area = properties_of_area(spec.surface);
    if (!(area.measure > 0)) throw InputError("the surface of the rigid body has no area; give one with triangles");
    return area;
  }
  const MassProperties volume = properties_of_volume(spec.surface);
  if (!(volume.measure > 0))
    throw InputError("the surface of the rigid body encloses a volume of " + text(volume.measure) +
                     " m³, which must be above 0; turn its triangles outward");
  return volume;
}

double mass_of(const RigidBodySpec& spec, double measure) {
  if (spec.mass && spec.density) throw InputError("the rigid body has a mass and a density; give one of the two");
  if (!spec.mass && !spec.density) throw InputError("the rigid body has no mass; give its mass or its density");
  if (!spec.mass && !spec.closed)
    throw InputError("the surface of the rigid body is open: a density has no volume there; give its mass");
  const double mass = spec.mass ? *spec.mass : *spec.density * measure;
  if (!(mass > 0) || !std::isfinite(mass))
    throw InputError("the mass of the rigid body is " + text(mass) + " kg; it must be above 0");
  return mass;
}

}  // namespace

MassProperties properties_of_volume(const TriangleMesh& closed) {
  return properties(closed, 4, [](const Vec3d& a, const Vec3d& b, const Vec3d& c) { return dot(a, cross(b, c)) / 6; });
}

MassProperties properties_of_area(const TriangleMesh& surface) {
  return properties(surface, 3,
                    [](const Vec3d& a, const Vec3d& b, const Vec3d& c) { return 0.5 * norm(cross(b - a, c - a)); });
}

RigidBody::RigidBody(RigidBodySpec spec, Model& model, PointSetBuilder& points) : tree_(spec.surface) {
  const MassProperties matter = measured(spec);
  mass_ = mass_of(spec, matter.measure);
  volume_ = spec.closed ? matter.measure : 0;
  center_ = matter.center;
  const Mat3d second = spec.inertia ? second_moment(*spec.inertia) : matter.second * (mass_ / matter.measure);
  if (!spec.inertia && !positive(Mat3d::diagonal(1) - second * (1 / trace(second)), -1e-9))
    throw InputError(
        "the surface of the rigid body has no width: nothing resists a turn about its length; give its "
        "inertia");
  if (spec.closed) inside_ = std::make_shared<InsideTest>(spec.surface);
  surface_ = std::move(spec.surface);
  size_ = bounds_of(surface_.points).diagonal();

  first_node_ = model.node_count();
  node_count_ = 1;
  model.rest_position.push_back(center_);
  model.rest_orientation.push_back(Mat3d::identity());
  model.frame_kind.push_back(FrameKind::rigid);
  model.inertia.resize(model.rest_position.size());
  model.inertia.back() = {mass_, {}, second};
  if (!model.mass_damping.empty()) model.mass_damping.resize(model.rest_position.size());
  points.join({first_node_}, size_);
}

Attachment RigidBody::attach(const Vec3d& X) const {
  Attachment a;
  a.nodes = {first_node_};
  a.influences = {{1, {}, X - center_, Mat3d::identity()}};
  return a;
}

double RigidBody::distance(const Vec3d& X) const { return inside_ && inside_->contains(X) ? 0 : tree_.distance(X); }

std::string RigidBody::quality() const { return "mass centre at " + text(center_); }

}  // namespace fascia
