#include "app/reader/readers.hpp"
#include "app/scene/laws.hpp"
#include "app/schema/schema.hpp"

#include <fmt/format.h>

#include <numbers>

namespace fascia::app {
namespace {

/// The kind of a domain whose surface is generated; null for others.
const char* generated_surface(const TableReader& domain) {
  for (const char* kind : {"rectangle", "annulus", "cylinder", "ellipsoid", "sphere"})
    if (domain.value(kind)) return kind;
  return nullptr;
}

/// A surface about an axis: its angle, and that what the user wants closed can be.
void check_turn(const TableReader& shape, const std::array<double, 2>& angle, bool closed) {
  constexpr double whole = 2 * std::numbers::pi;
  const double turn = angle[1] - angle[0];
  if (!(turn > 0) || !(turn <= whole * (1 + 1e-9)))
    return shape.error("angle", fmt::format("goes from {:.6g} to {:.6g} rad; must be ascending, by a whole turn at "
                                            "most, degrees with their unit (\"360 degree\")",
                                            angle[0], angle[1]));
  if (!closed && turn < whole && shape.boolean("closed").value_or(false))
    shape.error("closed", "a sector has two edges apart; must be false, or angle a whole turn");
  if (!closed && shape.boolean("caps").value_or(false))
    shape.error("caps", "a skin that does not close around the axis has no caps; must be false");
}

void read_shell_cells(const TableReader& shape, const std::string& kind, Body& body) {
  constexpr double most = 1e7;
  const bool round = kind == "ellipsoid" || kind == "sphere";
  const std::size_t numbers = round ? 1 : 2;
  body.cells_place = shape.place("cells");
  body.open = body.under_need && is_shell(body) && !shape.has("cells");
  if (!shape.has("cells") && !body.open) {
    const Shape domain = domain_schema();
    const Shape& item = domain.find(kind)->shape.find("cells")->shape.items.front();
    shape.error("cells", fmt::format("is missing for model = \"{}\"; must be {}{}", word(body.model),
                                     in_words(array(item, numbers, numbers)), is_shell(body) ? kNeedWouldChoose : ""));
  }
  const auto count = shape.integers("cells");
  if (!count) return;
  if (count->size() != numbers)
    return shape.error("cells", fmt::format("has two numbers, as of a solid; must be one for model = \"{}\", the cells "
                                            "around",
                                            word(body.model)));
  if (round) check_around(shape, 0);
  const double cells = round ? 0.25 * (*count)[0] * (*count)[0] : 1.0 * (*count)[0] * (*count)[1];
  if (cells > most) shape.error("cells", fmt::format("asks for about {:.3g} cells; must be at most {}", cells, most));
  const auto* cylinder = std::get_if<CylinderDomain>(&body.domain);
  const auto* annulus = std::get_if<AnnulusDomain>(&body.domain);
  const bool closed = (cylinder && cylinder->closed) || (annulus && annulus->closed);
  if (cylinder) check_turn(shape, cylinder->angle, closed);
  if (annulus) check_turn(shape, annulus->angle, closed);
  if (closed && (*count)[1] < 3)
    shape.error("cells", fmt::format("{} cells around enclose nothing; must be at least 3 where closed", (*count)[1]));
  const std::string diagonal = shape.text("diagonal").value_or("right");
  body.cells = MeshCells{*count, 0,
                         diagonal == "left"          ? CellDiagonal::left
                         : diagonal == "alternating" ? CellDiagonal::alternating
                                                     : CellDiagonal::right};
}

}  // namespace

void read_skin(const TableReader& domain, Body& body) {
  if (const char* kind = generated_surface(domain)) read_shell_cells(domain.table(kind), kind, body);
}

void read_shell(const TableReader& table, Body& body) {
  table.refuse({"frames", "points", "weights", "radius", "formulation", "order", "incompressibility", "locking"},
               unused_by(body.model));
  const TableReader domain = table.table("domain");
  for (const char* other : {"box", "block", "line"})
    if (domain.has(other))
      domain.error(other,
                   "is no surface, which model = \"shell\" needs; must be rectangle, annulus, cylinder, "
                   "ellipsoid, sphere or file");
  if (domain.has("between"))
    domain.error("between", "is for meshless bodies; must be rectangle, annulus, cylinder, ellipsoid, sphere or file");
  read_skin(domain, body);
  body.thickness_place = table.place("thickness");
  body.thickness = read_thickness(table);
  if (!table.has("thickness"))
    table.error("thickness", "is missing for model = \"shell\"; must be a length in m above 0, or a list by region");
  refuse_shear_relaxation(table, body, "shells");
  refuse_activation(table, body, "shells");
  for (std::size_t i = 0; i < body.materials.size(); ++i)
    if (const Law law = body.materials[i].material.law; needs_large_strain(law))
      table.diagnostics().add(place_of_material(table, i),
                              fmt::format("has the law \"{}\", which shells do not take; must be of the law \"{}\"",
                                          word(law), kMaterialLaws[0].word));
}

void refuse_shell_keys(const TableReader& table) {
  const TableReader domain = table.table("domain");
  domain.table("cylinder").refuse({"diagonal", "angle", "closed", "caps"}, "is not used by a solid");
  domain.table("rectangle").refuse({"diagonal"}, "is not used by frames");
}

}  // namespace fascia::app
