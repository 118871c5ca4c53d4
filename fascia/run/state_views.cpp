#include "fascia/run/state_views.hpp"

#include "assembly/simulation/held_forces.hpp"
#include "core/base/index.hpp"

#include <algorithm>
#include <utility>

namespace fascia {

bool StateViews::Buffer::ask(std::size_t size) {
  if (wanted) return false;
  values.resize(size);
  return wanted = true;
}

Rows StateViews::Buffer::view(int columns) const {
  return {values.data(), static_cast<int>(values.size()) / columns, columns};
}

StateViews::StateViews(const Simulation& s) : s_(s), surfaces_(s.bodies.size()), attached_(s.bodies.size()) {}

bool StateViews::any() const {
  const auto wanted = [](const Buffer& b) { return b.wanted; };
  return wanted(positions_) || wanted(rotations_) || wanted(forces_) ||
         std::any_of(surfaces_.begin(), surfaces_.end(), wanted);
}

Rows StateViews::positions(const State& state) {
  if (positions_.ask(3 * nodes())) fill_positions(state);
  return positions_.view(3);
}

Rows StateViews::rotations(const State& state) {
  if (rotations_.ask(9 * nodes())) fill_rotations(state);
  return rotations_.view(9);
}

Rows StateViews::forces(const ReachedForces& acting) {
  if (forces_.ask(3 * nodes())) fill_forces(acting);
  return forces_.view(3);
}

Rows StateViews::surface(std::size_t body, const State& state) {
  const ModelBody& of = *s_.bodies[body].body;
  const std::size_t count = of.surface().points.size();
  if (!surfaces_[body].wanted) {
    std::vector<Attachment> attached;
    for (std::size_t i = 0; i < count; ++i) attached.push_back(of.attach_surface(i));
    attached_[body] = std::move(attached);
    surfaces_[body].ask(3 * count);
    fill_surface(body, state);
  }
  return surfaces_[body].view(3);
}

void StateViews::fill(const State& state, const ReachedForces& acting) {
  if (positions_.wanted) fill_positions(state);
  if (rotations_.wanted) fill_rotations(state);
  if (forces_.wanted) fill_forces(acting);
  for (std::size_t b = 0; b < surfaces_.size(); ++b)
    if (surfaces_[b].wanted) fill_surface(b, state);
}

void StateViews::fill_positions(const State& state) {
  double* out = positions_.values.data();
  for (std::size_t i = 0; i < state.u.size(); ++i) {
    const Vec3d x = s_.model.rest_position[i] + state.u[i];
    for (int k = 0; k < 3; ++k) *out++ = x[k];
  }
}

void StateViews::fill_rotations(const State& state) {
  double* out = rotations_.values.data();
  for (std::size_t i = 0; i < state.u.size(); ++i) {
    const Mat3d Q = Mat3d::identity() + state.D[i];
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) *out++ = Q(r, c);
  }
}

void StateViews::fill_forces(const ReachedForces& acting) {
  const std::vector<double> held = held_forces(s_, acting);
  for (int i = 0; i < s_.model.node_count(); ++i)
    std::copy_n(held.data() + s_.model.points.dofs.begin(i), 3, forces_.values.data() + 3 * at(i));
  for (const TetheredMaterial& m : s_.tethered) {
    if (squared_norm(s_.model.tethers[at(m.tether)].arm) > 0) continue;  // a couple
    for (int k = 0; k < 3; ++k) forces_.values[at(3 * m.frame + k)] += acting.tether_forces[at(m.tether)][k];
  }
}

void StateViews::fill_surface(std::size_t body, const State& state) {
  const std::vector<Vec3d>& rest = s_.bodies[body].body->surface().points;
  double* out = surfaces_[body].values.data();
  for (std::size_t p = 0; p < rest.size(); ++p) {
    const Vec3d x = rest[p] + field_at(attached_[body][p], state).u;
    for (int k = 0; k < 3; ++k) *out++ = x[k];
  }
}

}  // namespace fascia
