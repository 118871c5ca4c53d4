#include "core/base/index.hpp"
#include "core/math/mat3.hpp"
#include "fem/locator.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {
namespace {

bool in_reference(ElementFamily family, const Vec3d& xi) {
  if (family == ElementFamily::tetrahedra) return std::min({xi[0], xi[1], xi[2], 1 - xi[0] - xi[1] - xi[2]}) >= 0;
  return std::max({std::abs(xi[0]), std::abs(xi[1]), std::abs(xi[2])}) <= 1;
}

Mat3d jacobian(const ElementMesh& mesh, std::size_t element, const Vec3d& xi) {
  const ShapeGradients dN = shape_gradients(mesh.shape, xi);
  const auto nodes = mesh.element(element);
  Mat3d J;
  for (std::size_t n = 1; n < nodes.size(); ++n) J += outer(mesh.nodes[at(nodes[n])] - mesh.nodes[at(nodes[0])], dN[n]);
  return J;
}

Vec3d place(const ElementMesh& mesh, std::size_t element, const Vec3d& xi) {
  const ShapeValues N = shape_values(mesh.shape, xi);
  const auto nodes = mesh.element(element);
  Vec3d d;
  for (std::size_t n = 1; n < nodes.size(); ++n) d += N[n] * (mesh.nodes[at(nodes[n])] - mesh.nodes[at(nodes[0])]);
  return mesh.nodes[at(nodes[0])] + d;
}

/// Minimises |r + J (η − ξ)|² over the places η of the reference element.
class LinearNearest {
 public:
  LinearNearest(ElementFamily family, const Vec3d& xi, const Mat3d& J, const Vec3d& r)
      : family_(family), xi_(xi), best_(xi), J_(J), r_(r), least_(squared_norm(r)) {}

  /// The least of a convex function lies inside, or is the least one of a face or an edge.
  Vec3d solve() {
    const double det = determinant(J_);
    if (det != 0) {
      const Vec3d eta = xi_ - inverse(J_) * r_;
      if (in_reference(family_, eta)) return eta;
    }
    for (const auto& face : faces_of(family_))
      try_face(corner(face[0]), corner(face[1]), corner(face[3] < 0 ? face[2] : face[3]));
    for (const auto& [a, b] : edges_of(family_)) try_edge(corner(a), corner(b));
    return best_;
  }

 private:
  const Vec3d& corner(int n) const { return reference_corners(family_)[at(n)]; }
  Vec3d residual(const Vec3d& eta) const { return r_ + J_ * (eta - xi_); }

  void offer(const Vec3d& eta) {
    const double value = squared_norm(residual(eta));
    if (!(value < least_)) return;
    least_ = value;
    best_ = eta;
  }
  void try_face(const Vec3d& o, const Vec3d& a, const Vec3d& b) {
    const Vec3d u = J_ * (a - o), v = J_ * (b - o), r = residual(o);
    const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), ur = dot(u, r), vr = dot(v, r);
    const double det = uu * vv - uv * uv;
    if (!(det > 0)) return;
    const double s = (uv * vr - vv * ur) / det, t = (uv * ur - uu * vr) / det;
    const bool triangle = family_ == ElementFamily::tetrahedra;
    if (s >= 0 && t >= 0 && (triangle ? s + t <= 1 : s <= 1 && t <= 1)) offer(o + s * (a - o) + t * (b - o));
  }
  void try_edge(const Vec3d& o, const Vec3d& a) {
    const Vec3d u = J_ * (a - o);
    const double uu = squared_norm(u);
    offer(o + (uu > 0 ? std::clamp(-dot(u, residual(o)) / uu, 0.0, 1.0) : 0.0) * (a - o));
  }

  ElementFamily family_;
  Vec3d xi_, best_;
  Mat3d J_;
  Vec3d r_;
  double least_;
};

Located nearest_in_curved(const ElementMesh& mesh, std::size_t element, const Vec3d& X) {
  const ElementFamily family = family_of(mesh.shape);
  Vec3d xi = reference_center(family);
  Vec3d r = place(mesh, element, xi) - X;
  for (int iteration = 0; iteration < 50; ++iteration) {
    const Vec3d s = LinearNearest(family, xi, jacobian(mesh, element, xi), r).solve() - xi;
    double part = 1;
    Vec3d next = xi + s, r_next = place(mesh, element, next) - X;
    while (squared_norm(r_next) > squared_norm(r) && part > 1e-3) {
      part /= 2;
      next = xi + part * s;
      r_next = place(mesh, element, next) - X;
    }
    if (squared_norm(r_next) > squared_norm(r)) break;
    xi = next;
    r = r_next;
    if (part * norm(s) < 1e-13) break;
  }
  return {static_cast<int>(element), xi, norm(r)};
}

Located nearest_in_tetrahedron(const ElementMesh& mesh, std::size_t element, const Vec3d& X) {
  const auto nodes = mesh.element(element);
  const auto corner = [&](int n) -> const Vec3d& { return mesh.nodes[at(nodes[at(n)])]; };
  const Mat3d inverse_J = inverse(jacobian(mesh, element, {}));
  Located result{static_cast<int>(element), inverse_J * (X - corner(0)), 0};
  if (in_reference(ElementFamily::tetrahedra, result.xi)) return result;
  Vec3d best = corner(0);
  for (const auto& face : faces_of(ElementFamily::tetrahedra)) {
    const Vec3d y = nearest_on_triangle(X, corner(face[0]), corner(face[1]), corner(face[2]));
    if (squared_norm(y - X) < squared_norm(best - X)) best = y;
  }
  // Rounding may leave the face; the place returns to it.
  result.xi = inverse_J * (best - corner(0));
  for (int c = 0; c < 3; ++c) result.xi[c] = std::max(result.xi[c], 0.0);
  const double sum = result.xi[0] + result.xi[1] + result.xi[2];
  if (sum > 1) result.xi *= 1 / sum;
  result.distance = norm(best - X);
  return result;
}

}  // namespace

Located nearest_in_element(const ElementMesh& mesh, std::size_t element, const Vec3d& X) {
  return mesh.shape == ElementShape::tet4 ? nearest_in_tetrahedron(mesh, element, X)
                                          : nearest_in_curved(mesh, element, X);
}

}  // namespace fascia
