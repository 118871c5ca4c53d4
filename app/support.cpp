#include "app/scene/errors.hpp"

#include "app/simulation.hpp"
#include "core/math/index.hpp"

#include <fmt/format.h>
#include <Eigen/Dense>

#include <cmath>
#include <set>
#include <vector>

namespace fascia::app {

namespace {

using Motion6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

std::string named_motion(const Motion6& m) {
  const Vec3d v{{m[0], m[1], m[2]}}, w{{m[3], m[4], m[5]}};
  const bool turns = norm(w) > 0.1 * norm(v) || norm(v) < 1e-9;
  const Vec3d d = normalized(turns ? w : v);
  const char* names[3] = {"x", "y", "z"};
  for (int a = 0; a < 3; ++a)
    if (std::abs(d[a]) > 0.999) return fmt::format("{} {}", turns ? "rotation about" : "translation along", names[a]);
  return fmt::format("{} ({:.2f}, {:.2f}, {:.2f})", turns ? "rotation about" : "translation along", d[0], d[1], d[2]);
}

/// The motions without resistance: those along and about the axes first, then what is left of the null space.
std::string free_motions(const Matrix6& resistance) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(resistance);
  std::vector<Motion6> found;
  int dimension = 0;
  for (int k = 0; k < 6; ++k) {
    Motion6 axis = Motion6::Zero();
    axis[k] = 1;
    if (axis.dot(resistance * axis) < 1e-9) found.push_back(axis);
    if (eigen.eigenvalues()[k] < 1e-9) ++dimension;
  }
  for (int k = 0; k < dimension && static_cast<int>(found.size()) < dimension; ++k) {
    Motion6 rest = eigen.eigenvectors().col(k);
    for (const Motion6& f : found) rest -= f * f.dot(rest);
    if (rest.norm() > 1e-6) found.push_back(rest.normalized());
  }
  std::string names;
  for (const Motion6& f : found) names += (names.empty() ? "" : ", ") + named_motion(f);
  return names;
}

}  // namespace

/// Rigid motions of each part against what its constraints hold: a motion that none of them resists is free.
void check_support(const Simulation& s) {
  const std::vector<int>& part = s.model.points.node_part;
  std::vector<Diagnostic> errors;
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    const ModelBody& body = *s.bodies[b].body;
    std::set<int> parts;
    for (int i = body.first_node(); i < body.first_node() + body.node_count(); ++i) parts.insert(part[at(i)]);
    for (const int r : parts) {
      Vec3d center{};
      int count = 0;
      for (int i = 0; i < s.model.node_count(); ++i) {
        if (part[at(i)] != r) continue;
        center += s.model.rest_position[at(i)];
        ++count;
      }
      center *= 1.0 / count;
      Matrix6 resistance = Matrix6::Zero();
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
      for (const TetheredMaterial& t : s.tethered) {
        if (part[at(t.field.nodes[0])] != r) continue;
        const Vec3d arm = (s.model.tethers[at(t.tether)].X - center) * (1 / size);
        const bool turn = squared_norm(s.model.tethers[at(t.tether)].arm) > 0;
        for (const Vec3d& a : t.axes) {
          const Vec3d force = turn ? Vec3d{} : a, moment = turn ? a : cross(arm, a);
          const Motion6 row{{force[0], force[1], force[2], moment[0], moment[1], moment[2]}};
          resistance += row * row.transpose();
        }
      }
      const std::string free = free_motions(resistance);
      if (free.empty()) continue;
      const bool whole = count == body.node_count();
      errors.push_back(
          {s.scene.bodies[b].place,
           fmt::format("nothing holds {} in a static solve ({}); add a constraint, or use kind = \"implicit-euler\"",
                       whole ? "this body"
                             : fmt::format("its part of {} {}s around ({:.4g}, {:.4g}, {:.4g})", count,
                                           s.bodies[b].node_word(), center[0], center[1], center[2]),
                       free)});
    }
  }
  if (!errors.empty()) throw SceneError(std::move(errors));
}

}  // namespace fascia::app
