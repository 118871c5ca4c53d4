#include "core/executor/load_tangent.hpp"

#include "core/base/index.hpp"
#include "core/executor/surface_blocks.hpp"
#include "core/math/rotation.hpp"

#include <cmath>

namespace fascia {

namespace {

/// C of a torque t with ½ [t]× F⁻ᵀ, and how it changes with t and F.
struct TorqueCouple {
  Mat3d inverse, couple;

  TorqueCouple(const Vec3d& torque, const Mat3d& F)
      : inverse(transpose(fascia::inverse(F))), couple(skew(torque) * inverse * 0.5) {}
  Mat3d change(const Vec3d& dt, const Mat3d& dF) const {
    return skew(dt) * inverse * 0.5 - couple * transpose(dF) * inverse;
  }
};

void add_follower_product(const FollowerTangent& f, const DofLayout& dofs, const std::vector<Mat3d>& Q,
                          std::span<const double> x, std::span<double> y) {
  const FollowerLoad& load = *f.load;
  const bool vertices = !load.g.empty(), twists = squared_norm(f.torque) > 0;
  const auto increment = [&](std::size_t k) { return x.data() + dofs.begin(load.nodes[k]); };
  const auto variation = [&](std::size_t k) {
    return frame_variation(dofs.kind(load.nodes[k]), increment(k) + 3, Q[at(load.nodes[k])]);
  };
  Mat3d dF;
  for (std::size_t k = 0; k < load.nodes.size(); ++k) {
    const double* d = increment(k);
    dF += vertices ? outer(Vec3d{{d[0], d[1], d[2]}}, load.g[k]) : variation(k) * load.w[k];
  }
  const Vec3d spin = f.spin_of_change * axl(times_transpose(f.rotation, dF));
  const Vec3d df = cross(spin, f.force), dt = cross(spin, f.torque);
  const auto add = [](const Vec3d& v, double* out) {
    for (int i = 0; i < 3; ++i) out[i] -= v[i];
  };
  if (vertices) {
    const Mat3d dC = twists ? TorqueCouple(f.torque, f.F).change(dt, dF) : Mat3d{};
    for (std::size_t k = 0; k < load.nodes.size(); ++k)
      add(df * load.w[k] + dC * load.g[k], y.data() + dofs.begin(load.nodes[k]));
    return;
  }
  for (std::size_t k = 0; k < load.nodes.size(); ++k) {
    const int node = load.nodes[k];
    const double w = load.w[k], *d = increment(k) + 3;
    const Mat3d& A = Q[at(node)];
    double* out = y.data() + dofs.begin(node);
    add(df * w, out);
    if (dofs.kind(node) == FrameKind::rigid) {
      // The derivative of the torque m = A b × f + w t, and ½ m × θ.
      const Vec3d arm = A * load.b[k], turn{{d[0], d[1], d[2]}};
      const Vec3d torque = cross(arm, f.force) + f.torque * w;
      add(cross(arm, df) + cross(cross(turn, arm), f.force) + dt * w + cross(torque, turn) * 0.5, out + 3);
    } else if (dofs.kind(node) == FrameKind::affine) {
      Mat3d dN = outer(df, load.b[k]);
      if (twists) dN += TorqueCouple(f.torque * w, A).change(dt * w, variation(k));
      add_moment(FrameKind::affine, dN * -1.0, A, out + 3);
    }
  }
}

}  // namespace

FollowerTangent::FollowerTangent(const FollowerLoad& follower, const State& state, double factor) : load(&follower) {
  const bool vertices = !follower.g.empty();
  Mat3d D;
  for (std::size_t k = 0; k < follower.nodes.size(); ++k)
    D += vertices ? outer(state.u[at(follower.nodes[k])], follower.g[k])
                  : state.D[at(follower.nodes[k])] * follower.w[k];
  const TurnedFollower turned = turned_follower(follower.force, follower.torque, D, vertices, factor);
  force = turned.force;
  torque = turned.torque;
  F = Mat3d::identity() + D;
  rotation = Mat3d::identity() + polar_increment(D);
  const Mat3d stretch = times_transpose(F, rotation), turning = Mat3d::diagonal(trace(stretch)) - stretch;
  constexpr double kLeast = 1e-12;  // below, the rotation in F is not defined, and nothing is known of its change
  if (std::abs(determinant(turning)) > kLeast) spin_of_change = inverse(turning);
}

void LoadTangent::clear() {
  surfaces = nullptr;
  volumes.clear();
  followers.clear();
  torques.clear();
}

void LoadTangent::take(const Model& model, const State& state, std::span<const double> factors) {
  for (const DeadLoad& load : model.loads)
    for (const NodeLoad& n : load.nodes)
      if (model.kind(n.node) == FrameKind::rigid && squared_norm(n.torque) > 0)
        torques.push_back({n.node, n.torque * factors[at(load.schedule)]});
  for (const FollowerLoad& load : model.followers) followers.emplace_back(load, state, factors[at(load.schedule)]);
}

bool LoadTangent::symmetric() const {
  return followers.empty() && torques.empty() && (surfaces == nullptr || !surface.curved || surfaces->conservative());
}

void LoadTangent::add_product(const PointSet& set, const std::vector<Mat3d>& Q, std::span<const double> x,
                              std::span<double> y) const {
  if (surfaces != nullptr) surfaces->add_product(surface, nodes_of(set), Q.data(), x.data(), y.data());
  for (const RankOne& term : volumes) fascia::add_product(term, x, y);
}

void LoadTangent::add_to(BlockMatrix& matrix, const std::vector<Mat3d>& Q) const {
  if (surfaces != nullptr) add_blocks(surfaces->loads(), surface, Q, matrix);
}

void LoadTangent::add_unsymmetric_product(const PointSet& set, const std::vector<Mat3d>& Q, std::span<const double> x,
                                          std::span<double> y) const {
  const DofLayout& dofs = set.dofs;
  if (surfaces != nullptr && !surfaces->conservative())
    surfaces->add_product(surface, nodes_of(set), Q.data(), x.data(), y.data(), TangentPart::antisymmetric);
  for (const FollowerTangent& follower : followers) add_follower_product(follower, dofs, Q, x, y);
  for (const TorqueTangent& t : torques) {
    const auto i = at(dofs.begin(t.node) + 3);
    const Vec3d half = cross(t.torque, Vec3d{{x[i], x[i + 1], x[i + 2]}}) * 0.5;
    for (int k = 0; k < 3; ++k) y[i + at(k)] -= half[k];
  }
}

}  // namespace fascia
