#include "core/body/model_body.hpp"

#include "core/base/index.hpp"

#include <algorithm>

namespace fascia {

namespace {

/// The point's material as the mechanics use it, without stabilisation and damping.
ThinMaterial<double> stress_material(const BodyPoint& p, const Mat3d& axes) {
  const Lame lame = thin_lame(p.law, p);
  ThinMaterial<double> m{};
  m.volume = p.volume;
  m.lambda = lame.lambda;
  m.mu = lame.mu;
  m.law = p.law;
  m.axes = axes;
  m.transverse = p.transverse;
  return m;
}

Mat3d cauchy(const Mat3d& F, const Mat3d& S) { return times_transpose(F * S, F) * (1 / determinant(F)); }

/// @param Hv  where the volumetric strain is taken; H without selective integration
PointTensors tensors_of(const BodyPoint& p, const std::vector<Mat3d>& axes, const Mat3d& H, const Mat3d& Hv) {
  const Mat3d E = green_strain(H), F = Mat3d::identity() + H, Fv = Mat3d::identity() + Hv;
  if (is_thin(p.law)) {
    const ThinMaterial<double> m = stress_material(p, axes[at(p.axes)]);
    return {E, cauchy(F, second_piola(m, E)), energy_density(m, E)};
  }
  return with_solid_law(p.law, [&]<Law L>() -> PointTensors {
    LawConstants without_lambda = p, lambda_alone = p;
    without_lambda.lambda = lambda_alone.mu = 0;
    std::fill(lambda_alone.own.begin(), lambda_alone.own.end(), 0.0);
    const auto shear = make_law<SolidLaw<L, double>>(without_lambda),
               volume = make_law<SolidLaw<L, double>>(lambda_alone);
    return {E, cauchy(F, second_piola(shear, H)) + cauchy(Fv, second_piola(volume, Hv)),
            energy_density(shear, H) + energy_density(volume, Hv)};
  });
}

}  // namespace

FieldValue field_at(const Attachment& a, const State& state) {
  FieldValue f;
  for (std::size_t k = 0; k < a.nodes.size(); ++k) {
    const Influence& i = a.influences[k];
    const Vec3d& u = state.u[at(a.nodes[k])];
    const Mat3d& D = state.D[at(a.nodes[k])];
    f.u += u * i.w + D * i.b;
    f.D += D * i.w;
    f.H += outer(u, i.g) + D * i.B;
  }
  return f;
}

std::vector<std::vector<int>> ModelBody::faces() const {
  std::vector<std::vector<int>> faces;
  for (const auto& t : surface_.triangles) faces.push_back({t.begin(), t.end()});
  return faces;
}

std::vector<FacePoint> ModelBody::face_points() const {
  std::vector<FacePoint> points;
  for (const auto& t : surface_.triangles) {
    const Vec3d &a = surface_.points[at(t[0])], &b = surface_.points[at(t[1])], &c = surface_.points[at(t[2])];
    const double area = 0.5 * norm(cross(b - a, c - a));
    for (const Vec3d& X : {(a * 4.0 + b + c) * (1.0 / 6), (a + b * 4.0 + c) * (1.0 / 6), (a + b + c * 4.0) * (1.0 / 6)})
      points.push_back({X, area / 3, attach(X), {t[0], t[1], t[2]}});
  }
  return points;
}

std::vector<PointTensors> ModelBody::tensors(const State& state) const {
  std::vector<PointTensors> all;
  all.reserve(points_.size());
  for (std::size_t q = 0; q < points_.size(); ++q) all.push_back(tensors_at(attach_point(q), q, state));
  return all;
}

TensorField ModelBody::tensor_field(const State& state) const {
  return [this, &state](const Attachment& place, std::size_t nearest) { return tensors_at(place, nearest, state); };
}

PointTensors ModelBody::tensors_at(const Attachment& place, std::size_t nearest, const State& state) const {
  const Mat3d H = field_at(place, state).H;
  return tensors_of(points_[nearest], axes_, H, selective() ? field_at(attach_volumetric(place), state).H : H);
}

Mat3d ModelBody::strain_at(const Attachment& place, const State& state) const {
  return green_strain(field_at(place, state).H);
}

}  // namespace fascia
