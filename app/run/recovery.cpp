#include "app/run/recovery.hpp"

#include "core/base/index.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

/// The largest of (distance to the points' centre / their spread)² along an axis that a slope is trusted over: 3 at
/// the face of a hexahedron of 2 × 2 × 2 points, up to 7 at that of tetrahedra of one.
constexpr double kFarthest = 9;

/// Points lie in a plane or on a line where their spread along an axis is this part of the largest; rounding leaves
/// 1e-16.
constexpr double kFlat = 1e-10;

using Vector = Eigen::Vector3d;

Vector vector_of(const Vec3d& v) { return {v[0], v[1], v[2]}; }

bool of_one_material(const BodyPoint& a, const BodyPoint& b) {
  const LawConstants& constants = a;
  return b == constants && b.law == a.law;
}

/// Stresses jump where materials or thicknesses meet: no slope goes across.
void keep_nearest_material(const ModelBody& body, const Vec3d& X, std::vector<NodalRecovery::Share>& patch) {
  const auto point = [&](const NodalRecovery::Share& s) -> const BodyPoint& { return body.points()[at(s.point)]; };
  const auto nearest = std::min_element(patch.begin(), patch.end(), [&](const auto& a, const auto& b) {
    return squared_norm(point(a).X - X) < squared_norm(point(b).X - X);
  });
  if (nearest == patch.end()) return;
  const BodyPoint own = point(*nearest);
  std::erase_if(patch, [&](const auto& s) { return !of_one_material(own, point(s)); });
}

}  // namespace

NodalRecovery::NodalRecovery(const SimulatedBody& b) : begin_(b.nodes.size() + 1) {
  const ModelBody& body = *b.body;
  std::vector<std::vector<Share>> patches(b.nodes.size());
  for (std::size_t q = 0; q < body.points().size(); ++q) {
    const Attachment a = body.attach_point(q);
    for (std::size_t k = 0; k < a.nodes.size(); ++k)
      patches[b.index_of(a.nodes[k])].push_back(
          {static_cast<int>(q), body.points()[q].volume * std::max(a.influences[k].w, 1e-3)});
  }
  const bool uniform = std::all_of(body.points().begin(), body.points().end(),
                                   [&](const BodyPoint& p) { return of_one_material(body.points()[0], p); });
  const auto place = [&](const Share& s) { return vector_of(body.points()[at(s.point)].X); };
  for (std::size_t i = 0; i < patches.size(); ++i) {
    std::vector<Share>& patch = patches[i];
    if (!uniform) keep_nearest_material(body, b.nodes[i], patch);
    double sum = 0;
    for (const Share& s : patch) sum += s.weight;
    Vector centre = Vector::Zero();
    for (Share& s : patch) {
      s.weight /= sum;
      centre += s.weight * place(s);
    }
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Share& s : patch) spread += s.weight * (place(s) - centre) * (place(s) - centre).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
    const Vector offset = vector_of(b.nodes[i]) - centre;
    Vector slope = Vector::Zero();
    for (int k = 0; k < 3; ++k) {
      const Vector axis = axes.eigenvectors().col(k);
      const double o = axis.dot(offset), o2 = o * o;
      const double reach = std::max({axes.eigenvalues()[k], o2 / kFarthest, kFlat * axes.eigenvalues()[2]});
      if (o2 > 0) slope += axis * (o / reach);
    }
    for (const Share& s : patch) shares_.push_back({s.point, s.weight * (1 + slope.dot(place(s) - centre))});
    begin_[i + 1] = shares_.size();
  }
}

std::vector<PointTensors> NodalRecovery::at_nodes(const std::vector<PointTensors>& points) const {
  std::vector<PointTensors> nodes(begin_.size() - 1);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (std::size_t s = begin_[i]; s < begin_[i + 1]; ++s)
      add_share(nodes[i], points[at(shares_[s].point)], shares_[s].weight);
    nodes[i].energy_density = std::max(0.0, nodes[i].energy_density);  // no slope makes it negative
  }
  return nodes;
}

}  // namespace fascia::app
