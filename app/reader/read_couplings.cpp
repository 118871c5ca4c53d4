#include "app/reader/readers.hpp"

#include "app/schema/schema.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fascia::app {
namespace {

std::string unused_by_kind(const std::string& kind) { return fmt::format("is not used by kind = \"{}\"", kind); }

void need(const TableReader& coupling, const char* key, const std::string& kind) {
  const Shape keys = couplings_schema().shape.items.front();
  if (!coupling.has(key))
    coupling.error(key, fmt::format("is missing for kind = \"{}\"; must be {}", kind, in_words(keys.find(key)->shape)));
}

void read_spring(const TableReader& table, Coupling& coupling) {
  coupling.kind = CouplingKind::spring;
  table.refuse({"to"}, unused_by_kind("spring") + ": springs to another body are not supported yet");
  need(table, "point", "spring");
  need(table, "stiffness", "spring");
  coupling.point = table.vector("point").value_or(coupling.point);
  coupling.stiffness = table.number("stiffness").value_or(1);
  if (const auto direction = table.direction("direction")) coupling.direction = normalized(*direction);
}

void read_attachment(const TableReader& table, const std::string& kind, const std::vector<std::string>& bodies,
                     Coupling& coupling) {
  coupling.kind = kind == "embed" ? CouplingKind::embed : CouplingKind::weld;
  table.refuse({"point", "stiffness", "direction"}, unused_by_kind(kind));
  need(table, "to", kind);
  coupling.to = table.text("to").value_or("");
  if (table.value("to")) check_other_body(coupling.to, coupling.to_place, coupling.body, bodies, table.diagnostics());
}

}  // namespace

Coupling read_coupling(const TableReader& table, const std::vector<std::string>& bodies) {
  Coupling coupling;
  coupling.place = table.place();
  coupling.name = table.name();
  coupling.to_place = table.place("to");
  if (std::find(bodies.begin(), bodies.end(), coupling.name) != bodies.end())
    table.error("is the name of a body too, and results list both together; must be another name");
  coupling.body = read_body_name(table, bodies);
  coupling.where = read_region(table, "where");
  if (const auto kind = table.text("kind")) {
    if (*kind == "spring")
      read_spring(table, coupling);
    else
      read_attachment(table, *kind, bodies, coupling);
  }
  return coupling;
}

}  // namespace fascia::app
