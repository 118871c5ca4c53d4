#include "core/base/index.hpp"
#include "core/base/throwing_loops.hpp"
#include "core/physics/shell_triangle.hpp"
#include "core/physics/von_mises.hpp"
#include "shells/shell_body.hpp"

#include <cmath>

/// Strains, stresses and section forces of shells, for results.
namespace fascia {

namespace {

constexpr std::array<double, 3> kMiddle{1.0 / 3, 1.0 / 3, 1.0 / 3};

/// A symmetric tensor of the plane, from its entries 11, 22, 12 in the columns of `axes`.
Mat3d in_plane(const Mat3d& axes, double a11, double a22, double a12) {
  Mat3d local;
  local(0, 0) = a11;
  local(1, 1) = a22;
  local(0, 1) = local(1, 0) = a12;
  return times_transpose(axes * local, axes);
}

/// U A U of symmetric matrices given by 11, 12, 22 (U) and 11, 22, 12 (A).
std::array<double, 3> pushed(const std::array<double, 3>& U, const std::array<double, 3>& A) {
  const double b11 = U[0] * A[0] + U[1] * A[2], b12 = U[0] * A[2] + U[1] * A[1];
  const double b21 = U[1] * A[0] + U[2] * A[2], b22 = U[1] * A[2] + U[2] * A[1];
  return {b11 * U[0] + b12 * U[1], b21 * U[1] + b22 * U[2], b11 * U[1] + b12 * U[2]};
}

void append(std::vector<double>& out, const Mat3d& m) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out.push_back(m(i, j));
}

std::array<double, 3> at_height(const std::array<double, 3>& membrane, const std::array<double, 3>& curvature,
                                double offset) {
  return {membrane[0] + offset * curvature[0], membrane[1] + offset * curvature[1],
          membrane[2] + offset * curvature[2]};
}

}  // namespace

/// The strain whose stress acts: the part that never fades, and what is left of the rest.
ShellStrain<double> ShellBody::acting_strain(std::size_t t, const ShellStrain<double>& strain,
                                             const State& state) const {
  if (points_[t].viscosity == nullptr) return strain;
  ShellStrain<double> e = strain * points_[t].viscosity->long_term();
  const std::array<int, 3>& nodes = mesh_.triangles[t];
  for (int k = 0; k < 3; ++k) e.membrane[k] += remembered_strain(t, k, state);
  for (int a = 0; a < 3; ++a) {
    int place = 0;  // corners of the mechanics are in ascending order
    for (const int other : nodes) place += other < nodes[at(a)] ? 1 : 0;
    e.membrane[3 + a] += remembered_strain(t, 3 + place, state);
    for (int j = 0; j < 2; ++j) e.bending[2 * a + j] += remembered_strain(t, 6 + 2 * place + j, state);
  }
  return e;
}

ShellBody::Strained ShellBody::strained(std::size_t t, const std::array<double, 3>& L, const State& state) const {
  const PlaneTriangle p = corners(t);
  const LinearGradients linear = linear_gradients(p);
  ShellConstants<double> constants;
  Vec3d u[3];
  Mat3d D[3];
  Strained s;
  s.rest_axes = triangle_axes_[t];
  for (std::size_t a = 0; a < 3; ++a) {
    const auto node = at(first_node_ + mesh_.triangles[t][a]);
    for (std::size_t j = 0; j < 2; ++j) constants.g[a][j] = linear.g[a][j];
    u[a] = transpose(s.rest_axes) * state.u[node];
    D[a] = transpose_times(s.rest_axes, state.D[node] * s.rest_axes);
  }
  const ShellTriangle<double> triangle(constants, u, D);
  const ShellStrain<double>& e = triangle.strain();
  const auto drilling = drilling_strains(p);
  const PlateStrains plate = plate_strains(p, section(t), L);
  const auto resolve = [&](const ShellStrain<double>& strain, auto& membrane, auto& curvature) {
    for (std::size_t i = 0; i < 3; ++i) {
      membrane[i] = strain.membrane[i];
      for (std::size_t a = 0; a < 3; ++a) membrane[i] += drilling[i][a] * strain.membrane[3 + a];
      for (std::size_t k = 0; k < 6; ++k) curvature[i] += plate.curvature[i][k] * strain.bending[k];
    }
  };
  resolve(e, s.membrane, s.curvature);
  resolve(acting_strain(t, e, state), s.acting_membrane, s.acting_curvature);
  s.axes = s.rest_axes + s.rest_axes * triangle.turned();
  s.stretch = {triangle.stretch()[0], triangle.stretch()[1], triangle.stretch()[2]};
  return s;
}

std::array<double, 3> ShellBody::membrane_stress(std::size_t t, const std::array<double, 3>& strain) const {
  const auto C = plane_stress(section(t));
  std::array<double, 3> S{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) S[i] += C[i][j] * strain[j];
  return S;
}

/// F S Fᵀ / det F, with the thickness that plane stress leaves.
Mat3d ShellBody::cauchy(std::size_t t, const Strained& s, double offset) const {
  const std::array<double, 3> E = at_height(s.membrane, s.curvature, offset);
  const std::array<double, 3> acting = at_height(s.acting_membrane, s.acting_curvature, offset);
  const std::array<double, 3> tau = pushed(s.stretch, membrane_stress(t, acting));
  const double nu = section(t).poisson, thinning = 1 - 2 * nu / (1 - nu) * (E[0] + E[1]);
  const double J = (s.stretch[0] * s.stretch[2] - s.stretch[1] * s.stretch[1]) * std::sqrt(std::max(1e-6, thinning));
  return in_plane(s.axes, tau[0] / J, tau[1] / J, tau[2] / J);
}

PointTensors ShellBody::tensors_of(std::size_t t, const Strained& s, double offset) const {
  const std::array<double, 3> E = at_height(s.membrane, s.curvature, offset), S = membrane_stress(t, E);
  const double lasting = points_[t].viscosity ? points_[t].viscosity->long_term() : 1.0;
  return {in_plane(s.rest_axes, E[0], E[1], 0.5 * E[2]), cauchy(t, s, offset),
          0.5 * lasting * (E[0] * S[0] + E[1] * S[1] + E[2] * S[2])};
}

/// In the middle surface.
void ShellBody::store_tensors(const State& state, ThreadPool& pool, std::span<PointTensors> out) const {
  constexpr int kGrain = 128;
  for_throwing_ranges(pool, static_cast<int>(out.size()), kGrain, [&](int begin, int end) {
    for (std::size_t t = at(begin); t < at(end); ++t) out[t] = tensors_of(t, strained(t, kMiddle, state), 0);
  });
}

PointTensors ShellBody::tensors_at(const Attachment& place, std::size_t /*nearest*/, const State& state) const {
  const auto t = at(place.cell);
  std::array<double, 3> L{};
  double offset = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t a = 0; a < 3; ++a)
      if (first_node_ + mesh_.triangles[t][a] == place.nodes[k]) L[a] = place.influences[k].w;
    offset += dot(place.influences[k].b, triangle_axes_[t].column(2));
  }
  return tensors_of(t, strained(t, L, state), offset);
}

Mat3d ShellBody::strain_at(const Attachment& place, const State& state) const {
  return tensors_at(place, 0, state).strain;
}

/// Of the corners of all triangles, weighted with area.
BodyField ShellBody::node_means(const BodyField& cells) const {
  const auto n = at(cells.components);
  BodyField nodes{cells.name, false, cells.components, std::vector<double>(n * mesh_.nodes.size())};
  std::vector<double> area(mesh_.nodes.size());
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
    for (const int node : mesh_.triangles[t]) {
      area[at(node)] += area_[t];
      for (std::size_t k = 0; k < n; ++k) nodes.values[n * at(node) + k] += area_[t] * cells.values[n * t + k];
    }
  for (std::size_t i = 0; i < nodes.values.size(); ++i) nodes.values[i] /= area[i / n];
  return nodes;
}

std::vector<BodyField> ShellBody::own_fields(const State& state) const {
  BodyField thickness{"thickness", true, 1, thickness_}, force{"membrane_force", true, 9, {}},
      moment{"bending_moment", true, 9, {}}, outer_face{"stress_outer", true, 9, {}},
      inner_face{"stress_inner", true, 9, {}}, worst{"von_mises", true, 1, {}};
  std::vector<Vec3d> normal(mesh_.nodes.size());
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    const Strained s = strained(t, kMiddle, state);
    const double h = thickness_[t], stiffness = h * h * h / 12;
    const std::array<double, 3> S = membrane_stress(t, s.acting_membrane), M = membrane_stress(t, s.acting_curvature);
    append(force.values, in_plane(s.axes, h * S[0], h * S[1], h * S[2]));
    append(moment.values, in_plane(s.axes, stiffness * M[0], stiffness * M[1], stiffness * M[2]));
    const Mat3d out = cauchy(t, s, 0.5 * h), in = cauchy(t, s, -0.5 * h);
    append(outer_face.values, out);
    append(inner_face.values, in);
    worst.values.push_back(std::max(von_mises(out), von_mises(in)));
    for (const int node : mesh_.triangles[t]) normal[at(node)] += triangle_axes_[t].column(2) * area_[t];
  }
  std::vector<BodyField> fields{thickness, force, moment, outer_face, inner_face, worst};
  for (std::size_t k = 0, cells = fields.size(); k < cells; ++k) fields.push_back(node_means(fields[k]));
  const std::vector<double> thickness_of_nodes = node_means(thickness).values;
  BodyField director{"director", false, 3, {}}, outward{"to_outer_face", false, 3, {}};
  for (std::size_t i = 0; i < normal.size(); ++i) {
    const Vec3d n = squared_norm(normal[i]) > 0 ? normalized(normal[i]) : Vec3d{{0, 0, 1}};
    const Vec3d d = n + state.D[at(first_node_) + i] * n, half = d * (0.5 * thickness_of_nodes[i]);
    director.values.insert(director.values.end(), d.v, d.v + 3);
    outward.values.insert(outward.values.end(), half.v, half.v + 3);
  }
  fields.push_back(std::move(director));
  fields.push_back(std::move(outward));
  return fields;
}

}  // namespace fascia
