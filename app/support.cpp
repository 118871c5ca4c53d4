#include "app/scene/errors.hpp"

#include "app/simulation.hpp"
#include "core/math/index.hpp"

#include <fmt/format.h>
#include <Eigen/Dense>

#include <cmath>
#include <numeric>

namespace fascia::app {

namespace {

using Motion6 = Eigen::Matrix<double, 6, 1>;

/// Representatives of the connected parts of a model: frames that share a group of points hang together.
std::vector<int> connected_parts(const Model& model) {
  std::vector<int> parent(at(model.node_count()));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int i) {
    while (parent[at(i)] != i) i = parent[at(i)] = parent[at(parent[at(i)])];
    return i;
  };
  for (int group = 0; group < model.points.group_count(); ++group)
    for (const int node : model.points.nodes(group)) parent[at(root(node))] = root(model.points.nodes(group)[0]);
  for (int i = 0; i < model.node_count(); ++i) parent[at(i)] = root(i);
  return parent;
}

std::string named_motion(const Motion6& m) {
  const Vec3d v{{m[0], m[1], m[2]}}, w{{m[3], m[4], m[5]}};
  const bool turns = norm(w) > 0.1 * norm(v) || norm(v) < 1e-9;
  const Vec3d d = normalized(turns ? w : v);
  const char* names[3] = {"x", "y", "z"};
  for (int a = 0; a < 3; ++a)
    if (std::abs(d[a]) > 0.999) return fmt::format("{} {}", turns ? "rotation about" : "translation along", names[a]);
  return fmt::format("{} ({:.2f}, {:.2f}, {:.2f})", turns ? "rotation about" : "translation along", d[0], d[1], d[2]);
}

}  // namespace

/// Rigid motions of each part against what its constraints hold: a motion that none of them resists is free.
void check_support(const Simulation& s) {
  const std::vector<int> part = connected_parts(s.model);
  std::vector<Diagnostic> errors;
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    const MeshlessBody& body = s.bodies[b].meshless;
    for (int r = body.first_frame(); r < body.first_frame() + body.frame_count(); ++r) {
      if (part[at(r)] != r) continue;
      Vec3d center{};
      int count = 0;
      for (int i = 0; i < s.model.node_count(); ++i) {
        if (part[at(i)] != r) continue;
        center += s.model.rest_position[at(i)];
        ++count;
      }
      center *= 1.0 / count;
      Eigen::Matrix<double, 6, 6> resistance = Eigen::Matrix<double, 6, 6>::Zero();
      const double size = body.size();
      for (const FrameConstraint& c : s.model.constraints) {
        if (part[at(c.node)] != r) continue;
        const Vec3d arm = (s.model.rest_position[at(c.node)] - center) * (1 / size);
        for (int k = 0; k < c.translations; ++k) {
          const Vec3d a = c.translation_axes.row(k), moment = cross(arm, a);
          const Motion6 row{{a[0], a[1], a[2], moment[0], moment[1], moment[2]}};
          resistance += row * row.transpose();
        }
        for (int k = 0; k < c.rotations; ++k) {
          const Vec3d a = c.rotation_axes.row(k);
          const Motion6 row{{0, 0, 0, a[0], a[1], a[2]}};
          resistance += row * row.transpose();
        }
      }
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(resistance);
      std::string free;
      for (int k = 0; k < 6; ++k)
        if (eigen.eigenvalues()[k] < 1e-9)
          free += (free.empty() ? "" : ", ") + named_motion(eigen.eigenvectors().col(k));
      if (free.empty()) continue;
      const bool whole = count == body.frame_count();
      errors.push_back(
          {s.scene.bodies[b].place,
           fmt::format("nothing holds {} in a static solve ({}); add a constraint, or use kind = \"implicit-euler\"",
                       whole ? "this body"
                             : fmt::format("its part of {} frames around ({:.4g}, {:.4g}, {:.4g})", count, center[0],
                                           center[1], center[2]),
                       free)});
    }
  }
  if (!errors.empty()) throw SceneError(std::move(errors));
}

}  // namespace fascia::app
