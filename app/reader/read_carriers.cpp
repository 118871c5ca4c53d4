#include "app/reader/readers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

/// The cells of a solid whose skin is taken.
void read_skin_of_solid(const TableReader& shape, Body& body) {
  constexpr double most = 1e7;
  shape.refuse({"split"}, unused_by(body.model));
  body.cells_place = shape.place("cells");
  const std::vector<int> n = shape.integers("cells").value_or(std::vector<int>{1, 1, 1});
  if (const double cells = 2.0 * n[0] * n[1] + 2.0 * n[1] * n[2] + 2.0 * n[2] * n[0]; cells > most)
    shape.error("cells", fmt::format("asks for {:.3g} cells of the skin; must be at most {}", cells, most));
  body.cells = MeshCells{n};
}

void read_surface(const TableReader& domain, Body& body) {
  constexpr const char* right = "must be box, block, cylinder, ellipsoid, sphere, file, rectangle or annulus";
  if (domain.has("line"))
    domain.error("line", fmt::format("is no surface, which model = \"{}\" needs; {}", word(body.model), right));
  if (domain.has("between")) domain.error("between", fmt::format("is for meshless bodies; {}", right));
  for (const char* solid : {"box", "block"})
    if (domain.value(solid)) return read_skin_of_solid(domain.table(solid), body);
  read_skin(domain, body);
}

/// Why a generated surface encloses nothing; null for others.
const char* why_open(const Domain& domain) {
  if (std::holds_alternative<RectangleDomain>(domain)) return "a rectangle encloses none";
  if (std::holds_alternative<AnnulusDomain>(domain)) return "an annulus encloses none";
  const auto* cylinder = std::get_if<CylinderDomain>(&domain);
  return cylinder && !cylinder->caps ? "a cylinder without caps encloses none" : nullptr;
}

/// What every inertia fulfils, in whatever axes: it is symmetric, and no moment exceeds the sum of the two others.
void check_inertia(const TableReader& table, const Mat3d& inertia) {
  constexpr double rounding = 1e-6;  // of numbers with six digits
  double largest = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) largest = std::max(largest, std::abs(inertia(i, j)));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < i; ++j)
      if (std::abs(inertia(i, j) - inertia(j, i)) > rounding * largest)
        return table.error(
            "inertia", fmt::format("is not symmetric: {}{} is {} kg m2, {}{} is {}; must be equal", "xyz"[j], "xyz"[i],
                                   inertia(j, i), "xyz"[i], "xyz"[j], inertia(i, j)));
  for (int i = 0; i < 3; ++i) {
    const double moment = inertia(i, i), others = inertia((i + 1) % 3, (i + 1) % 3) + inertia((i + 2) % 3, (i + 2) % 3);
    if (!(moment > 0))
      return table.error("inertia", fmt::format("{} kg m2 about {} is no inertia; must be above 0", moment, "xyz"[i]));
    if (moment > others + rounding * largest)
      return table.error("inertia", fmt::format("{} kg m2 about {} is above the sum of the two others, {}, which no "
                                                "mass has; must be at most the sum",
                                                moment, "xyz"[i], others));
  }
}

void read_inertia(const TableReader& table, Body& body) {
  body.inertia_place = table.place("inertia");
  if (!table.has("inertia")) return;
  if (!table.has("mass") && !table.has("density"))
    table.error("inertia", "needs the mass too; must stand beside mass or density");
  const auto rows = table.vectors("inertia");
  if (!rows) return;
  body.inertia = transpose(Mat3d::from_columns((*rows)[0], (*rows)[1], (*rows)[2]));
  check_inertia(table, *body.inertia);
}

}  // namespace

void read_carrier(const TableReader& table, Body& body) {
  table.refuse({"material", "frames", "points", "weights", "thickness", "radius", "fluid", "formulation", "order",
                "incompressibility", "locking"},
               unused_by(body.model));
  if (table.table("domain").has("file")) table.table("domain").refuse({"refine"}, unused_by(body.model));
  read_surface(table.table("domain"), body);
  if (body.model == BodyModel::surface)
    return table.refuse({"mass", "density", "inertia", "initial"}, unused_by(body.model));
  read_inertia(table, body);
  if (const char* why = why_open(body.domain); why && table.has("density"))
    table.error("density", fmt::format("needs a volume, and {}; give mass in its place", why));
}

}  // namespace fascia::app
