#include "app/scene/readers.hpp"

#include <fmt/format.h>

namespace fascia::app {
namespace {

BoxDomain read_box(const TableReader& box) {
  const auto min = box.vector("min"), max = box.vector("max");
  if (min && max)
    for (int i = 0; i < 3; ++i)
      if (!((*min)[i] < (*max)[i]))
        box.error("max",
                  fmt::format("{} along {} is not above min, {}; must be above it", (*max)[i], "xyz"[i], (*min)[i]));
  return {min.value_or(Vec3d{}), max.value_or(Vec3d{})};
}

CylinderDomain read_cylinder(const TableReader& cylinder) {
  const auto from = cylinder.vector("from"), to = cylinder.vector("to");
  if (from && to && *from == *to) cylinder.error("to", "is the same point as from; must be another point");
  return {from.value_or(Vec3d{}), to.value_or(Vec3d{}), cylinder.number("radius").value_or(1)};
}

RectangleDomain read_rectangle(const TableReader& rectangle) {
  constexpr double least_sine = 1e-6;
  const auto u = rectangle.direction("edge_u"), v = rectangle.direction("edge_v");
  if (u && v && norm(cross(1 / norm(*u) * *u, 1 / norm(*v) * *v)) < least_sine)
    rectangle.error("edge_v", "is parallel to edge_u; must have another direction");
  return {rectangle.vector("origin").value_or(Vec3d{}), u.value_or(Vec3d{{1, 0, 0}}), v.value_or(Vec3d{{0, 1, 0}})};
}

LineDomain read_line(const TableReader& line) {
  const auto from = line.vector("from"), to = line.vector("to");
  if (from && to && *from == *to) line.error("to", "is the same point as from; must be another point");
  return {from.value_or(Vec3d{}), to.value_or(Vec3d{})};
}

FileDomain read_file(const TableReader& domain, const std::filesystem::path& folder) {
  const std::string name = *domain.text("file");
  if (name.empty()) domain.error("file", "is empty; must be the path of a mesh");
  return {folder / name};
}

std::vector<ThicknessUse> read_thickness(const TableReader& body) {
  const Value* value = body.value("thickness");
  if (!value) return {};
  if (!value->as_array()) return {{{body.place("thickness"), AllRegion{}}, *body.number("thickness")}};
  std::vector<ThicknessUse> uses;
  for (const TableReader& part : read_choices(body, "thickness"))
    uses.push_back({read_region(part, "where"), part.number("value").value_or(1)});
  return uses;
}

void require(const TableReader& table, const char* key, const char* message) {
  if (!table.has(key)) table.error(key, message);
}

}  // namespace

Domain read_domain(const TableReader& domain, const std::filesystem::path& folder) {
  if (domain.value("file")) return read_file(domain, folder);
  if (domain.value("cylinder")) return read_cylinder(domain.table("cylinder"));
  if (domain.value("rectangle")) return read_rectangle(domain.table("rectangle"));
  if (domain.value("line")) return read_line(domain.table("line"));
  if (domain.value("ellipsoid")) {
    const TableReader ellipsoid = domain.table("ellipsoid");
    return EllipsoidDomain{ellipsoid.vector("center").value_or(Vec3d{}),
                           ellipsoid.vector("radii").value_or(Vec3d{{1, 1, 1}})};
  }
  return read_box(domain.table("box"));
}

std::optional<Extent> read_extent(const TableReader& body) {
  const TableReader domain = body.table("domain");
  if (domain.has("rectangle")) return Extent::surface;
  if (domain.has("line")) return Extent::line;
  if (domain.has("file")) return body.has("thickness") || body.has("radius") ? Extent::thin_mesh : Extent::solid;
  if (domain.has("box") || domain.has("cylinder") || domain.has("ellipsoid")) return Extent::solid;
  return std::nullopt;
}

void read_section(const TableReader& table, Body& body) {
  body.thickness_place = table.place("thickness");
  body.radius_place = table.place("radius");
  body.thickness = read_thickness(table);
  body.radius = table.number("radius");
  const std::optional<Extent> extent = read_extent(table);
  if (extent == Extent::solid) table.refuse({"thickness", "radius"}, "is not used by a solid");
  if (extent == Extent::surface) {
    require(table, "thickness", "is missing for a rectangle; must be a length in m above 0, or a list by region");
    table.refuse({"radius"}, "is not used by a rectangle, which has thickness");
  }
  if (extent == Extent::line) {
    require(table, "radius", "is missing for a line; must be a length in m above 0");
    table.refuse({"thickness"}, "is not used by a line, which has radius");
  }
}

}  // namespace fascia::app
