#include "core/tangent/stability.hpp"

#include "core/base/index.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace fascia {

namespace {

double weighted(std::span<const double> x, std::span<const double> weights) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += weights[i] * x[i] * x[i];
  return sum;
}

}  // namespace

std::vector<double> smooth_motion(const Model& model) {
  constexpr double kNoise = 0.05;
  std::mt19937 random(1);
  const auto number = [&] { return 2.0 * static_cast<double>(random()) / 4294967295.0 - 1.0; };
  Vec3d low = model.rest_position[0], high = low;
  for (const Vec3d& X : model.rest_position)
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], X[k]);
      high[k] = std::max(high[k], X[k]);
    }
  double size = 0;
  for (int k = 0; k < 3; ++k) size = std::max(size, high[k] - low[k]);
  if (size == 0) size = 1;
  double coefficient[3][10];
  for (auto& row : coefficient)
    for (double& c : row) c = number();
  const DofLayout& dofs = model.points.dofs;
  std::vector<double> motion(at(model.dof_count()));
  for (int node = 0; node < model.node_count(); ++node) {
    const Vec3d x = (model.rest_position[at(node)] - (low + high) * 0.5) * (2 / size);
    const double powers[10] = {1,           x[0],        x[1],        x[2],        x[0] * x[0],
                               x[1] * x[1], x[2] * x[2], x[0] * x[1], x[1] * x[2], x[2] * x[0]};
    double* d = motion.data() + dofs.begin(node);
    for (int k = 0; k < 3; ++k)
      for (int p = 0; p < 10; ++p) d[k] += coefficient[k][p] * powers[p];
    for (int k = 0; k < dofs.size(node); ++k) d[k] += kNoise * number() * (k < 3 ? 1.0 : 1 / size);
  }
  return motion;
}

std::vector<double> motion_weights(const Model& model, const DofFilter& filter) {
  const DofLayout& dofs = model.points.dofs;
  std::vector<double> weights(at(model.dof_count()), 0.0);
  for (int node = 0; node < model.node_count(); ++node) {
    const double length = model.points.part_length[at(model.points.node_part[at(node)])];
    for (int k = 0; k < dofs.size(node); ++k)
      if (const std::size_t i = at(dofs.begin(node) + k); !filter.is_fixed(i)) weights[i] = k < 3 ? 1 : length * length;
  }
  return weights;
}

std::vector<double> motion_lengths(const Model& model, const DofFilter& filter) {
  std::vector<double> lengths = motion_weights(model, filter);
  for (double& length : lengths) length = std::sqrt(length);
  return lengths;
}

double quotient(std::span<const double> x, std::span<const double> Kx, std::span<const double> weights) {
  double work = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (weights[i] > 0) work += x[i] * Kx[i];
  const double size = weighted(x, weights);
  return size > 0 ? work / size : 0.0;
}

SoftestDirection softest_direction(const Model& model, const DofFilter& filter, const ProbeSolve& solve, int rounds) {
  const std::vector<double> weights = motion_weights(model, filter);
  SoftestDirection out;
  std::vector<double> x = smooth_motion(model), b(x.size());
  for (int round = 0; round < rounds; ++round) {
    const double scale = 1 / std::sqrt(std::max(weighted(x, weights), 1e-300));
    for (std::size_t i = 0; i < x.size(); ++i) b[i] = weights[i] * x[i] * scale;
    const TangentProbe probe = solve(b, x);
    if (!probe.usable) return out;
    out.probe.usable = true;
    out.probe.unstable = std::max(out.probe.unstable, probe.unstable);
    out.stiffness = quotient(x, b, weights);
    out.direction = x;
  }
  return out;
}

int most_moved_node(const Model& model, std::span<const double> direction) {
  int best = -1;
  double largest = 0;
  for (int node = 0; node < model.node_count(); ++node) {
    const double* d = direction.data() + model.points.dofs.begin(node);
    if (const double moved = std::hypot(d[0], d[1], d[2]); moved > largest) {
      largest = moved;
      best = node;
    }
  }
  return best;
}

}  // namespace fascia
