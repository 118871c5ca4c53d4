#include "app/reader/readers.hpp"

#include <fmt/format.h>

/// Fibres of a material, and the stress that they make by themselves.
namespace fascia::app {

namespace {

Fibres read_fibres(const TableReader& table) {
  Fibres fibres{table.place(), StraightFibres{}};
  if (!table.has("cylindrical")) {
    if (const auto direction = table.direction("direction")) fibres.field = StraightFibres{normalized(*direction)};
    return fibres;
  }
  const TableReader wound = table.table("cylindrical");
  WoundFibres field;
  field.point = wound.vector("point").value_or(field.point);
  if (const auto axis = wound.direction("axis")) field.axis = normalized(*axis);
  field.angle = wound.number("angle").value_or(0);
  fibres.field = field;
  return fibres;
}

}  // namespace

void read_muscle(const TableReader& table, Material& material) {
  if (!table.has("active")) return table.refuse({"fibres"}, "is used only beside active");
  for (const TableReader& family : table.tables("fibres")) material.fibres.push_back(read_fibres(family));
  const TableReader active = table.table("active");
  if (!active.usable()) return;
  if (!table.has("fibres"))
    return table.error("fibres", "is missing; active needs fibres, such as fibres = [{ direction = [1, 0, 0] }]");
  Activation activation{active.place()};
  activation.stress = active.number("stress").value_or(0);
  const int family = active.integer("direction").value_or(0), families = static_cast<int>(material.fibres.size());
  if (families > 0 && (family < 0 || family >= families))
    active.error("direction", fmt::format("{} is no family of fibres; must be 0{}", family,
                                          families > 1 ? fmt::format(" to {}", families - 1) : ""));
  activation.fibres = family < 0 ? 0 : static_cast<std::size_t>(family);
  activation.schedule = read_schedule(active);
  material.activation = activation;
}

void refuse_activation(const TableReader& body, const Body& read, const char* who) {
  for (std::size_t i = 0; i < read.materials.size(); ++i) {
    const Material& material = read.materials[i].material;
    if (!material.activation) continue;
    const std::string named = material.name.empty() ? "" : fmt::format("\"{}\" ", material.name);
    body.diagnostics().add(
        place_of_material(body, i),
        fmt::format("{}has an active stress, which {} do not take; remove active, or take a meshless sheet or elements",
                    named, who));
  }
}

}  // namespace fascia::app
