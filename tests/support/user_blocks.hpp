#pragma once

#include "core/structure/user_block.hpp"

#include <memory>
#include <utility>
#include <vector>

/// Blocks as a program of the caller's own would bring them.
namespace fascia::test {

/// A spring of no length between two places, each moved by one node: ½ k |u₁ + D₁ b₁ − u₂ − D₂ b₂|².
class Bonds final : public UserBlock {
 public:
  struct Bond {
    int nodes[2];
    Vec3d b[2];  ///< from the node to the place
  };
  /// @param stiffness  k [N/m]
  /// @param spacing    of the nodes [m]
  Bonds(const std::vector<Bond>& bonds, double stiffness, double spacing)
      : UserBlock(2, nodes_of(bonds), spacing), bonds_(bonds), stiffness_(stiffness) {}

  double forces(int cell, std::span<const CellPose> poses, std::span<CellForce> gradient) const override {
    const Bond& bond = bonds_[at(cell)];
    const Vec3d apart = poses[0].u + poses[0].D * bond.b[0] - poses[1].u - poses[1].D * bond.b[1];
    pull(bond, apart, gradient);
    return 0.5 * stiffness_ * squared_norm(apart);
  }
  void product(int cell, std::span<const CellPose>, Tangent, std::span<const CellMotion> motions,
               std::span<CellForce> out) const override {
    const Bond& bond = bonds_[at(cell)];
    pull(bond, motions[0].dx + motions[0].dA * bond.b[0] - motions[1].dx - motions[1].dA * bond.b[1], out);
  }
  double stiffness(int) const override { return stiffness_ / length; }

 private:
  static std::vector<int> nodes_of(const std::vector<Bond>& bonds) {
    std::vector<int> nodes;
    for (const Bond& b : bonds) nodes.insert(nodes.end(), b.nodes, b.nodes + 2);
    return nodes;
  }
  void pull(const Bond& bond, const Vec3d& apart, std::span<CellForce> out) const {
    for (std::size_t a = 0; a < 2; ++a) {
      const Vec3d force = apart * (a == 0 ? stiffness_ : -stiffness_);
      out[a].force += force;
      out[a].N += outer(force, bond.b[a]);
    }
  }

  std::vector<Bond> bonds_;
  double stiffness_;
};

/// Linear tetrahedra of St. Venant and Kirchhoff, as a textbook has them.
class PlainTetrahedra final : public UserBlock {
 public:
  PlainTetrahedra(std::vector<int> cells, const std::vector<Vec3d>& rest, const Lame& lame, double size)
      : UserBlock(4, std::move(cells), size), lame_(lame) {
    for (int c = 0; c < count(); ++c) {
      const std::span<const int> n = cell(c);
      const Vec3d X = rest[at(n[0])];
      const Mat3d edges = Mat3d::from_columns(rest[at(n[1])] - X, rest[at(n[2])] - X, rest[at(n[3])] - X);
      const Mat3d slopes = inverse(edges);
      Tetrahedron t;
      t.volume = determinant(edges) / 6;
      for (int a = 1; a < 4; ++a) {
        t.g[a] = slopes.row(a - 1);
        t.g[0] -= t.g[a];
      }
      all_.push_back(t);
    }
  }

  double forces(int cell, std::span<const CellPose> poses, std::span<CellForce> gradient) const override {
    const Tetrahedron& t = all_[at(cell)];
    const Mat3d F = gradient_of(t, poses), E = strain(F), S = stress(E);
    for (std::size_t a = 0; a < 4; ++a) gradient[a].force += F * S * t.g[a] * t.volume;
    return 0.5 * t.volume * contract(S, E);
  }
  void product(int cell, std::span<const CellPose> poses, Tangent tangent, std::span<const CellMotion> motions,
               std::span<CellForce> out) const override {
    const Tetrahedron& t = all_[at(cell)];
    const Mat3d F = gradient_of(t, poses);
    Mat3d dF;
    for (std::size_t a = 0; a < 4; ++a) dF += outer(motions[a].dx, t.g[a]);
    Mat3d dP = F * stress(sym(transpose_times(F, dF)));
    if (tangent == Tangent::full) dP += dF * stress(strain(F));
    for (std::size_t a = 0; a < 4; ++a) out[a].force += dP * t.g[a] * t.volume;
  }
  double stiffness(int) const override { return lame_.lambda + 2 * lame_.mu; }
  double spin(int cell, std::span<const Vec3d> dx) const override {
    Mat3d slope;
    for (std::size_t a = 0; a < 4; ++a) slope += outer(dx[a], all_[at(cell)].g[a]);
    return norm(axl(slope)) * 0.5;
  }

 private:
  struct Tetrahedron {
    double volume = 0;
    Vec3d g[4];
  };
  static Mat3d gradient_of(const Tetrahedron& t, std::span<const CellPose> poses) {
    Mat3d F = Mat3d::identity();
    for (std::size_t a = 0; a < 4; ++a) F += outer(poses[a].u, t.g[a]);
    return F;
  }
  static Mat3d strain(const Mat3d& F) { return (transpose_times(F, F) - Mat3d::identity()) * 0.5; }
  Mat3d stress(const Mat3d& E) const { return Mat3d::diagonal(lame_.lambda * trace(E)) + E * (2 * lame_.mu); }

  std::vector<Tetrahedron> all_;
  Lame lame_;
};

}  // namespace fascia::test
