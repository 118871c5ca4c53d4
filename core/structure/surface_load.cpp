#include "core/structure/surface_load.hpp"

#include "core/base/index.hpp"
#include "core/structure/model.hpp"
#include "core/structure/surface_face.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {

std::span<const int> SurfaceLoad::face(int f) const {
  return std::span(face_vertex).subspan(at(face_begin[at(f)]), at(face_begin[at(f + 1)] - face_begin[at(f)]));
}

std::span<const SurfaceShare> SurfaceLoad::shares_of(int vertex) const {
  const int begin = share_begin[at(vertex)];
  return std::span(shares).subspan(at(begin), at(share_begin[at(vertex + 1)] - begin));
}

int add_vertex(SurfaceLoad& load, const Vec3d& X, std::span<const SurfaceShare> shares) {
  load.X.push_back(X);
  load.shares.insert(load.shares.end(), shares.begin(), shares.end());
  load.share_begin.push_back(static_cast<int>(load.shares.size()));
  return load.vertex_count() - 1;
}

void add_face(SurfaceLoad& load, std::span<const int> vertices) {
  load.face_vertex.insert(load.face_vertex.end(), vertices.begin(), vertices.end());
  load.face_begin.push_back(static_cast<int>(load.face_vertex.size()));
}

void measure_at_rest(SurfaceLoad& load) {
  Vec3d middle;
  for (const Vec3d& X : load.X) middle += X * (1.0 / load.vertex_count());
  double volume = 0;
  Vec3d moment;
  std::vector<Vec3d> from_middle;
  for (const Vec3d& X : load.X) from_middle.push_back(X - middle);
  for (int k = 0; k < load.face_count(); ++k) {
    const SurfaceFace face = SurfaceFace::of(load, k);
    for (int q = 0; q < face.points; ++q) {
      const FaceRulePoint& p = face.rule[q];
      const FacePlace rest(p, face, from_middle.data());
      const double cone = p.weight * triple(rest.x, rest.s, rest.t);
      volume += cone / 3;
      moment += rest.x * (cone / 4);
    }
  }
  load.rest_volume = load.volume = volume;
  load.datum = middle;
  if (load.closed && volume > 0) load.datum += moment * (1 / volume);
}

void evaluate(const SurfaceLoad& load, const State& state, std::span<const double> factors, SurfaceForces& f) {
  const std::size_t n = load.X.size();
  f.u.assign(n, {});
  f.x.resize(n);
  f.area.assign(n, {});
  f.force.resize(n);
  for (std::size_t v = 0; v < n; ++v) {
    for (const SurfaceShare& share : load.shares_of(static_cast<int>(v)))
      f.u[v] += share_displacement(share, state.u[at(share.node)], state.D[at(share.node)]);
    f.x[v] = load.X[v] - load.datum + f.u[v];
  }
  for (int k = 0; k < load.face_count(); ++k) {
    const SurfaceFace face = SurfaceFace::of(load, k);
    add_face_area(face, f.x.data(), [&](int a, const Vec3d& area) { f.area[at(face.vertex[a])] += area; });
  }
  const double s = factors[at(load.schedule)];
  f.pressure = s * load.pressure;
  f.energy = f.volume = f.stiffness = f.rounding = 0;
  double uncertain = 0;  // of the pressure [Pa]
  if (load.has_potential) {
    double change = 0, sizes = 0;
    for (int k = 0; k < load.face_count(); ++k)
      add_face_volume(SurfaceFace::of(load, k), load.X.data(), f.u.data(), f.x.data(), change, sizes);
    const SurfacePressure now =
        surface_pressure(load.pressure, load.bulk_modulus, load.rest_volume, load.volume, s, change, sizes);
    f.volume = now.volume;
    f.pressure = now.pressure;
    f.energy = now.energy;
    f.stiffness = now.stiffness;
    uncertain = now.rounding;
  }
  double squared_area = 0;
  for (std::size_t v = 0; v < n; ++v) {
    f.force[v] = f.area[v] * f.pressure;
    squared_area += squared_norm(f.area[v]);
  }
  f.rounding = uncertain * std::sqrt(squared_area);
  if (!(squared_norm(load.weight) > 0)) return;
  const Vec3d weight = load.weight * factors[at(load.weight_schedule)];
  double moment = 0;
  for (int k = 0; k < load.face_count(); ++k) {
    const SurfaceFace face = SurfaceFace::of(load, k);
    add_face_weight(face, f.x.data(), weight, moment,
                    [&](int a, const Vec3d& force) { f.force[at(face.vertex[a])] += force; });
  }
  f.energy -= moment;
}

}  // namespace fascia
