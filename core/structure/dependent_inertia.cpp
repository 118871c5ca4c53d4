#include "core/structure/dependent_inertia.hpp"

#include "core/base/errors.hpp"

#include <sstream>

namespace fascia {

namespace {

FrameInertia weighted(const FrameInertia& i, double w) { return {i.mass * w, i.first * w, i.second * w}; }

/// About a point from which the old origin is seen at r.
FrameInertia about(const FrameInertia& i, const Vec3d& r) {
  return {i.mass, i.first + r * i.mass, i.second + outer(i.first, r) + outer(r, i.first) + outer(r, r) * i.mass};
}

/// Gives the inertia of dependent nodes away, those first that others depend on last.
void give_away(const Model& model, std::vector<FrameInertia>& inertia, std::vector<char>& received) {
  const std::vector<DependentNode>& dependents = model.points.dependents;
  for (auto d = dependents.rbegin(); d != dependents.rend(); ++d) {
    FrameInertia& own = inertia[at(d->node)];
    const bool keeps = model.kind(d->node) != FrameKind::vertex && !d->turns;
    // A frame that turns by itself keeps the moment about its mass centre.
    const Mat3d carried = own.mass > 0 ? outer(own.first, own.first) * (1 / own.mass) : Mat3d{};
    const FrameInertia given = keeps ? FrameInertia{own.mass, own.first, carried} : own;
    own = keeps ? FrameInertia{0, {}, own.second - carried} : FrameInertia{};
    for (std::size_t k = 0; k < d->hosts.size(); ++k) {
      const int host = d->hosts[k];
      const Vec3d r = model.rest_position[at(d->node)] - model.rest_position[at(host)];
      const FrameInertia share = weighted(about(given, r), d->w[k]);
      if (share.mass != 0) received[at(host)] = 1;
      if (model.kind(host) == FrameKind::vertex)
        inertia[at(host)].mass += share.mass;
      else
        inertia[at(host)] += share;
    }
  }
  for (const DependentNode& d : dependents) received[at(d.node)] = 0;
}

/// Which nodes received mass.
std::vector<char> give_all_away(Model& model) {
  std::vector<char> received(at(model.node_count()), 0), unused = received;
  give_away(model, model.inertia, received);
  if (!model.mass_damping.empty()) give_away(model, model.mass_damping, unused);
  return received;
}

}  // namespace

void move_idle_inertia_to_hosts(Model& model) {
  if (!model.points.dependents.empty()) give_all_away(model);
}

void move_inertia_to_hosts(Model& model) {
  if (model.points.dependents.empty()) return;
  const std::vector<char> received = give_all_away(model);
  for (int host = 0; host < model.node_count(); ++host) {
    if (received[at(host)] == 0 || model.inertia[at(host)].mass > 0) continue;
    const Vec3d& X = model.rest_position[at(host)];
    std::ostringstream message;
    message << "the " << (model.kind(host) == FrameKind::vertex ? "vertex" : "frame") << " at (" << X[0] << ", " << X[1]
            << ", " << X[2] << ") would have a mass of " << model.inertia[at(host)].mass
            << " kg with what is embedded there, since weights are negative; give the host more density or less to "
               "what is embedded, move that further inside, or choose weights that are never negative";
    throw InputError(message.str(), Blame::weights);
  }
}

}  // namespace fascia
