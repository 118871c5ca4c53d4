#include "core/model/surface_load.hpp"

#include "core/math/index.hpp"
#include "core/model/model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fascia {

namespace {

/// Σ N x and its derivatives along s and t.
struct FacePlace {
  Vec3d x{}, s{}, t{};

  FacePlace(const FaceRulePoint& p, std::span<const int> face, const std::vector<Vec3d>& vertices) {
    for (std::size_t a = 0; a < face.size(); ++a) {
      const Vec3d& v = vertices[at(face[a])];
      x += v * p.N[a];
      s += v * p.ds[a];
      t += v * p.dt[a];
    }
  }
};

double triple(const Vec3d& a, const Vec3d& b, const Vec3d& c) { return dot(a, cross(b, c)); }

/// Volume − volume at rest, as a sum of terms with the displacement in each.
/// @param sizes  of the terms [m³]
double volume_change(const SurfaceLoad& load, const SurfaceForces& f, double& sizes) {
  double change = 0;
  for (int k = 0; k < load.face_count(); ++k) {
    const std::span<const int> face = load.face(k);
    for (const FaceRulePoint& p : face_rule(static_cast<int>(face.size()))) {
      const FacePlace rest(p, face, load.X), u(p, face, f.u), now(p, face, f.x);
      const double terms[3] = {triple(u.x, rest.s, rest.t), triple(now.x, u.s, rest.t), triple(now.x, now.s, u.t)};
      for (const double term : terms) {
        change += p.weight / 3 * term;
        sizes += p.weight / 3 * std::abs(term);
      }
    }
  }
  return change;
}

/// Adds the forces of a pressure w · x; returns ∫ w · x dV.
double add_weight(const SurfaceLoad& load, const Vec3d& w, SurfaceForces& f) {
  double moment = 0;
  for (int k = 0; k < load.face_count(); ++k) {
    const std::span<const int> face = load.face(k);
    for (const FaceRulePoint& p : face_rule(static_cast<int>(face.size()))) {
      const FacePlace now(p, face, f.x);
      const Vec3d n = cross(now.s, now.t) * p.weight;
      const double pressure = dot(w, now.x);
      for (std::size_t a = 0; a < face.size(); ++a) f.force[at(face[a])] += n * (pressure * p.N[a]);
      moment += 0.25 * pressure * dot(now.x, n);  // div(x (w · x)) = 4 w · x
    }
  }
  return moment;
}

}  // namespace

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
    const std::span<const int> face = load.face(k);
    for (const FaceRulePoint& p : face_rule(static_cast<int>(face.size()))) {
      const FacePlace rest(p, face, from_middle);
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
      f.u[v] += state.u[at(share.node)] * share.w + state.D[at(share.node)] * share.b;
    f.x[v] = load.X[v] - load.datum + f.u[v];
  }
  for (int k = 0; k < load.face_count(); ++k) {
    const std::span<const int> face = load.face(k);
    for (const FaceRulePoint& p : face_rule(static_cast<int>(face.size()))) {
      const FacePlace now(p, face, f.x);
      const Vec3d normal = cross(now.s, now.t) * p.weight;
      for (std::size_t a = 0; a < face.size(); ++a) f.area[at(face[a])] += normal * p.N[a];
    }
  }
  const double s = factors[at(load.schedule)];
  f.pressure = s * load.pressure;
  f.energy = f.volume = f.stiffness = f.rounding = 0;
  double uncertain = 0;  // of the pressure [Pa]
  if (load.has_potential) {
    constexpr double eps = std::numeric_limits<double>::epsilon();
    double sizes = 0;
    const double change = volume_change(load, f, sizes), wanted = s * (load.volume - load.rest_volume);
    f.volume = load.rest_volume + change;
    f.energy = -f.pressure * change;
    if (load.bulk_modulus > 0) {
      f.stiffness = load.bulk_modulus / (load.rest_volume + wanted);
      f.pressure += f.stiffness * (wanted - change);
      f.energy += 0.5 * f.stiffness * (change - wanted) * (change - wanted);
      uncertain = eps * f.stiffness * (sizes + std::abs(wanted));
    }
  }
  double squared_area = 0;
  for (std::size_t v = 0; v < n; ++v) {
    f.force[v] = f.area[v] * f.pressure;
    squared_area += squared_norm(f.area[v]);
  }
  f.rounding = uncertain * std::sqrt(squared_area);
  if (squared_norm(load.weight) > 0) f.energy -= add_weight(load, load.weight * factors[at(load.weight_schedule)], f);
}

}  // namespace fascia
