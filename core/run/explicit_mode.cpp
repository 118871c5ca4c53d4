#include "core/run/explicit_mode.hpp"

#include "core/tangent/dependents.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {

namespace {

constexpr int kNodeGrain = 256;

}  // namespace

ExplicitMode::ExplicitMode(const Model& model, const DofFilter& filter, ThreadPool& pool, Forces forces)
    : model_(model), filter_(filter), pool_(pool), forces_(std::move(forces)) {
  const auto n = at(model.dof_count());
  for (auto* vector : {&base_, &v_, &w_}) vector->resize(n);
  for (std::vector<double>& y : basis_) y.resize(n);
  sums_.resize((at(model.node_count()) + kNodeGrain - 1) / kNodeGrain);
  sizes_.resize(sums_.size());
}

ModeNode ExplicitMode::node_at(int node) const {
  const PointSet& points = model_.points;
  return {model_.kind(node),     &model_.inertia[at(node)], state_->D[at(node)],
          filter_.turn_of(node), filter_.fixed_of(node),    points.part_length[at(points.node_part[at(node)])]};
}

/// Calls act(node number, its first degree of freedom, its size) and adds up what it returns; `act` may enlarge the
/// size.
template <class Act>
double ExplicitMode::for_nodes(const Act& act) {
  pool_.for_ranges(model_.node_count(), kNodeGrain, [&](int begin, int end) {
    double sum = 0, size = 0;
    for (int i = begin; i < end; ++i) sum += act(i, at(model_.points.dofs.begin(i)), size);
    sums_[at(begin / kNodeGrain)] = sum;
    sizes_[at(begin / kNodeGrain)] = size;
  });
  double sum = 0;
  for (const double part : sums_) sum += part;
  return sum;
}

double ExplicitMode::stable_step(const State& state, double about) {
  state_ = &state;
  return mode_.stable_step(*this, about, model_.points.damped);
}

void ExplicitMode::begin(double inverse_step) {
  inverse_step_ = inverse_step;
  moved_.u = state_->u;
  moved_.D = state_->D;
  forces_(*state_, inverse_step_, base_);
}

void ExplicitMode::add_noise(double part) {
  const double each = part / std::sqrt(static_cast<double>(std::max(1, filter_.free_count())));
  seed_ += base_.size();
  for_nodes([&](int i, std::size_t first, double&) {
    add_mode_noise(node_at(i), seed_ + first, each, basis_[0].data() + first);
    return 0.0;
  });
}

double ExplicitMode::normalize(int k) {
  const double sum = for_nodes([&](int i, std::size_t first, double& size) {
    const ModeNode node = node_at(i);
    const double product = solve_mass(node, basis_[k].data() + first, v_.data() + first);
    size = std::max(size, mode_size(node, v_.data() + first));
    return product;
  });
  largest_ = 0;
  for (const double size : sizes_) largest_ = std::max(largest_, size);
  return sum;
}

void ExplicitMode::scale(int k, double s) {
  for (double& y : basis_[k]) y *= s;
  for (double& v : v_) v *= s;
  largest_ *= s;
}

double ExplicitMode::product() {
  const double reach = kModeReach / std::max(largest_, 1e-300);
  for_nodes([&](int i, std::size_t first, double&) {
    const ModeNode node = node_at(i);
    Vec3d u = state_->u[at(i)];
    Mat3d D = node.D;
    move_along(node, v_.data() + first, reach, u, D);
    moved_.u[at(i)] = u;
    if (node.kind != FrameKind::vertex) moved_.D[at(i)] = D;
    return 0.0;
  });
  place_dependents(model_.points, moved_);
  forces_(moved_, inverse_step_, w_);
  return for_nodes([&](int i, std::size_t first, double&) {
    return take_difference(node_at(i), base_.data() + first, v_.data() + first, reach, w_.data() + first);
  });
}

void ExplicitMode::advance(int k, double a, double b) {
  const std::vector<double>&y = basis_[k], &before = basis_[k > 0 ? k - 1 : 0];
  std::vector<double>& next = basis_[k + 1];
  for (std::size_t i = 0; i < y.size(); ++i) next[i] = w_[i] - a * y[i] - b * before[i];
}

void ExplicitMode::combine(const double* s, int count) {
  std::vector<double>& y = basis_[0];
  for (std::size_t i = 0; i < y.size(); ++i) {
    double sum = 0;
    for (int k = 0; k < count; ++k) sum += s[k] * basis_[k][i];
    y[i] = sum;
  }
}

}  // namespace fascia
