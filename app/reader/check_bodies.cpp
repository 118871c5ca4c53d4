#include "app/reader/readers.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fascia::app {
namespace {

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
