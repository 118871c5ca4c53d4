#include "app/reader/readers.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fascia::app {
namespace {

/// Another body that must be there first, and where that is said.
struct Need {
  std::size_t body;
  Place place;
};

std::vector<std::vector<Need>> needs_of(const std::vector<Body>& bodies) {
  std::map<std::string, std::size_t> index;
  for (std::size_t b = 0; b < bodies.size(); ++b) index.emplace(bodies[b].name, b);
  std::vector<std::vector<Need>> needs(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto add = [&](const std::string& name, const Place& place) {
      const auto found = index.find(name);
      if (found != index.end() && found->second != b) needs[b].push_back({found->second, place});
    };
    if (const auto* between = std::get_if<BetweenDomain>(&bodies[b].domain))
      for (std::size_t i = 0; i < 2; ++i) add(between->bodies[i], between->places[i]);
    if (bodies[b].shares)
      for (const SharedNodes& share : *bodies[b].shares) add(share.body, share.body_place);
  }
  return needs;
}

/// A body on the way and the next of its needs.
struct Step {
  std::size_t body, next = 0;
};

/// The names of a circle: from a body on the way to its end, and back.
std::string chain(const std::vector<Body>& bodies, const std::vector<Step>& way, std::size_t closing) {
  std::string text;
  bool inside = false;
  for (const Step& step : way) {
    inside = inside || step.body == closing;
    if (inside) text += bodies[step.body].name + " → ";
  }
  return text + bodies[closing].name;
}

const Body* find_body(const std::vector<Body>& bodies, const std::string& name) {
  const auto found = std::find_if(bodies.begin(), bodies.end(), [&](const Body& b) { return b.name == name; });
  return found == bodies.end() ? nullptr : &*found;
}

bool is_of_matter(Quantity q) {
  return q == Quantity::strain || q == Quantity::stress || q == Quantity::volume || q == Quantity::mass ||
         q == Quantity::energy || q == Quantity::kinetic_energy || q == Quantity::total_energy ||
         q == Quantity::momentum || q == Quantity::angular_momentum || q == Quantity::fluid_volume ||
         q == Quantity::fluid_pressure;
}

}  // namespace

void check_circles(const std::vector<Body>& bodies, Diagnostics& diagnostics) {
  enum class State { open, on_the_way, done };
  const std::vector<std::vector<Need>> needs = needs_of(bodies);
  std::vector<State> state(bodies.size(), State::open);
  for (std::size_t first = 0; first < bodies.size(); ++first) {
    if (state[first] != State::open) continue;
    std::vector<Step> way{{first}};
    state[first] = State::on_the_way;
    while (!way.empty()) {
      Step& step = way.back();
      if (step.next == needs[step.body].size()) {
        state[step.body] = State::done;
        way.pop_back();
        continue;
      }
      const Need& need = needs[step.body][step.next++];
      if (state[need.body] == State::on_the_way)
        diagnostics.add(need.place, fmt::format("closes a circle, {}; share and between must not lead back to a body",
                                                chain(bodies, way, need.body)));
      if (state[need.body] != State::open) continue;
      state[need.body] = State::on_the_way;
      way.push_back({need.body});
    }
  }
}

void check_surfaces(const Scene& scene, const std::vector<std::string>& names, Diagnostics& diagnostics) {
  for (const Body& body : scene.bodies) {
    if (body.model != BodyModel::surface) continue;
    const auto may_carry = [&](const Coupling& c) {
      const bool known = std::find(names.begin(), names.end(), c.body) != names.end();
      return c.kind != CouplingKind::spring && (c.body == body.name || !known);
    };
    if (std::none_of(scene.couplings.begin(), scene.couplings.end(), may_carry))
      diagnostics.add(body.place,
                      fmt::format("rides on nothing; add [couplings.NAME] with kind = \"embed\", body = {} and to = "
                                  "the body that it rides on",
                                  in_quotes(body.name)));
  }
}

void check_model(const TableReader& table, const Constraint& constraint, const std::vector<Body>& bodies) {
  const Body* body = find_body(bodies, constraint.body);
  if (body && body->model == BodyModel::surface)
    table.error("body", fmt::format("{} is a surface, which only rides on others and has no unknowns to hold; must be "
                                    "a body that it rides on",
                                    in_quotes(body->name)));
}

void check_model(const TableReader& table, const Probe& probe, const std::vector<Body>& bodies) {
  const Body* body = probe.body ? find_body(bodies, *probe.body) : nullptr;
  if (!body || !is_carrier(*body)) return;
  const auto name = table.text("quantity");
  if (!name) return;
  const bool deformation = probe.quantity == Quantity::strain || probe.quantity == Quantity::stress;
  if (body->model == BodyModel::rigid && deformation)
    table.error("quantity", fmt::format("a rigid body has no {}; must be a quantity of motion, such as "
                                        "\"displacement\", or the probe of another body",
                                        *name));
  if (body->model == BodyModel::surface && is_of_matter(probe.quantity))
    table.error("quantity", fmt::format("\"{}\" is of matter, and a surface has none; must be a quantity of motion, "
                                        "such as \"displacement\", or the probe of a body that it rides on",
                                        *name));
}

}  // namespace fascia::app
