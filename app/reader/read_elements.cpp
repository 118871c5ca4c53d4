#include "app/reader/readers.hpp"
#include "app/scene/laws.hpp"
#include "app/schema/schema.hpp"

#include <fmt/format.h>

namespace fascia::app {
namespace {

constexpr std::array<const char*, 5> generated{"box", "block", "cylinder", "ellipsoid", "sphere"};

/// The kind of a domain whose mesh is generated; null for others.
const char* generated_kind(const TableReader& domain) {
  for (const char* kind : generated)
    if (domain.value(kind)) return kind;
  return nullptr;
}

/// About how many hexahedra a generated mesh has, before they are split. Round ones: a core of around/4 cells a side
/// in layers of cells, of a cylinder around/12.
double cell_count(const std::string& kind, const std::vector<int>& cells) {
  const auto square = [](double x) { return x * x; };
  if (kind == "cylinder") return cells[0] * (square(cells[1] / 4.0) + square(cells[1]) / 12.0);
  if (kind == "ellipsoid" || kind == "sphere") return square(cells[0] / 4.0) * (cells[0] / 4.0 + 6.0 * cells[1]);
  return 1.0 * cells[0] * cells[1] * cells[2];
}

void read_cells(const TableReader& shape, const std::string& kind, Body& body) {
  constexpr double most = 1e7;
  body.cells_place = shape.place("cells");
  if (body.model == BodyModel::hexahedra) shape.refuse({"split"}, unused_by(body.model));
  const Shape domain = domain_schema();
  const Shape& any = domain.find(kind)->shape.find("cells")->shape;
  const std::string wanted = in_words(array(any.items.front(), any.max_items, any.max_items));
  body.open = body.under_need && !shape.has("cells");
  if (!shape.has("cells") && !body.open)
    shape.error("cells",
                fmt::format("is missing for model = \"{}\"; must be {}{}", word(body.model), wanted, kNeedWouldChoose));
  const auto count = shape.integers("cells");
  if (!count) return;
  if (count->size() < any.max_items)
    return shape.error(
        "cells", fmt::format("has one number, as of a shell; must be {} for model = \"{}\"", wanted, word(body.model)));
  if (kind == "cylinder") check_around(shape, 1);
  if (kind == "ellipsoid" || kind == "sphere") check_around(shape, 0);
  if (const double cells = cell_count(kind, *count); cells > most)
    shape.error("cells", fmt::format("asks for about {:.3g} cells; must be at most {}", cells, most));
  body.cells = MeshCells{*count, shape.integer("split").value_or(6)};
}

void read_mesh(const TableReader& domain, Body& body) {
  for (const char* thin : {"rectangle", "annulus", "line"})
    if (domain.has(thin))
      domain.error(thin, fmt::format("is no solid, which model = \"{}\" needs; must be box, block, cylinder, "
                                     "ellipsoid, sphere or file",
                                     word(body.model)));
  if (domain.has("between"))
    domain.error("between", "is for meshless bodies; must be box, block, cylinder, ellipsoid, sphere or file");
  if (const char* kind = generated_kind(domain)) read_cells(domain.table(kind), kind, body);
}

void read_formulation(const TableReader& table, Body& body) {
  body.formulation_place = table.place("formulation");
  const std::string formulation = table.text("formulation").value_or("st-venant-kirchhoff");
  if (formulation == "st-venant-kirchhoff") return;
  body.formulation = formulation == "linear" ? Formulation::linear : Formulation::corotational;
  for (std::size_t i = 0; i < body.materials.size(); ++i)
    if (const Law law = body.materials[i].material.law; needs_large_strain(law))
      table.diagnostics().add(
          place_of_material(table, i),
          fmt::format("has the law \"{}\", which formulation = \"{}\" does not take; must be of the "
                      "law \"{}\", or change the formulation",
                      word(law), formulation, kMaterialLaws[0].word));
}

void read_locking(const TableReader& table, Body& body) {
  body.locking_place = table.place("locking");
  const auto locking = table.text("locking");
  if (!locking) return;
  body.locking = *locking == "f-bar" ? Locking::f_bar : Locking::none;
  if (body.locking != Locking::f_bar || body.model != BodyModel::tetrahedra) return;
  if (body.order != 1) table.error("locking", "\"f-bar\" needs order = 1; must be \"none\" with order = 2");
  if (body.formulation != Formulation::large_strain)
    table.error("locking", fmt::format("\"f-bar\" needs large strain; must be \"none\" with formulation = \"{}\"",
                                       *table.text("formulation")));
}

/// An average about nodes has no part that fades by itself.
void check_averaged_viscosity(const TableReader& table, const Body& body) {
  if (body.locking != Locking::f_bar) return;
  refuse_shear_relaxation(table, body, "elements with locking = \"f-bar\"");
  const auto& first = body.materials.empty() ? nullptr : body.materials[0].material.viscosity;
  for (std::size_t i = 1; i < body.materials.size(); ++i) {
    if (!fade_alike(body.materials[i].material.viscosity, first))
      table.diagnostics().add(place_of_material(table, i),
                              "has another viscosity than the first material; with locking = \"f-bar\" all must have "
                              "the same");
  }
}

}  // namespace

const char* word(BodyModel model) {
  switch (model) {
    case BodyModel::meshless:
      return "meshless";
    case BodyModel::tetrahedra:
      return "tetrahedra";
    case BodyModel::hexahedra:
      return "hexahedra";
    case BodyModel::shell:
      return "shell";
    case BodyModel::rigid:
      return "rigid";
    case BodyModel::surface:
      return "surface";
  }
  return "";
}

std::string unused_by(BodyModel model) { return fmt::format("is not used by model = \"{}\"", word(model)); }

/// The cells around a cylinder or ellipsoid are as many on each of four sides.
void check_around(const TableReader& shape, std::size_t index) {
  const Value& around = (*shape.value("cells")->as_array())[index];
  const auto count = std::get<std::int64_t>(around.data), below = count / 4 * 4;
  if (count == below) return;
  const std::string right = below > 0 ? fmt::format("{} or {}", below, below + 4) : "4";
  shape.diagnostics().add(around.position, join(shape.path_of("cells"), index),
                          fmt::format("{} cells around are no multiple of 4; must be {}", count, right));
}

void read_elements(const TableReader& table, Body& body) {
  table.refuse({"frames", "points", "weights", "thickness", "radius"}, unused_by(body.model));
  if (body.model == BodyModel::hexahedra) table.refuse({"incompressibility", "locking"}, unused_by(body.model));
  refuse_shell_keys(table);
  read_mesh(table.table("domain"), body);
  read_formulation(table, body);
  body.order = table.integer("order").value_or(body.order);
  body.order_place = table.place("order");
  body.incompressibility = table.number("incompressibility").value_or(body.incompressibility);
  body.incompressibility_place = table.place("incompressibility");
  read_locking(table, body);
  check_averaged_viscosity(table, body);
}

void refuse_element_keys(const TableReader& table) {
  const std::string unused = unused_by(BodyModel::meshless);
  table.refuse({"formulation", "order", "incompressibility", "locking"}, unused);
  const TableReader domain = table.table("domain");
  if (domain.has("file")) domain.refuse({"refine"}, unused + "; give more frames");
  if (const char* kind = generated_kind(domain)) domain.table(kind).refuse({"cells", "split"}, unused);
  for (const char* flat : {"rectangle", "annulus"}) domain.table(flat).refuse({"cells"}, unused);
  refuse_shell_keys(table);
}

}  // namespace fascia::app
