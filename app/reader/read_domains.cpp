#include "app/reader/readers.hpp"
#include "app/scene/units.hpp"
#include "io/mesh/mesh_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

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

/// Determinant of the trilinear map's edges at a corner, of unit length: the volume that they span.
double corner_determinant(const std::array<Vec3d, 8>& corners, std::size_t corner) {
  constexpr std::array<std::array<std::size_t, 3>, 8> neighbours{
      {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7}, {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}}};
  std::array<Vec3d, 3> edge;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d d = corners[neighbours[corner][i]] - corners[corner];
    edge[i] = 1 / norm(d) * d;
  }
  return dot(edge[0], cross(edge[1], edge[2]));
}

BlockDomain read_block(const TableReader& block) {
  constexpr double flat = 1e-6;
  BlockDomain domain;
  const auto corners = block.vectors("corners");
  if (!corners) return domain;
  std::copy(corners->begin(), corners->end(), domain.corners.begin());
  for (std::size_t i = 0; i < 8; ++i)
    if (const double volume = corner_determinant(domain.corners, i); !(volume > flat)) {
      block.error("corners", fmt::format("the block is {} at corner {}; must be four corners of the lower face, "
                                         "counter-clockwise seen from above, then the four above them",
                                         volume < -flat ? "inverted" : "flat", i));
      break;
    }
  return domain;
}

/// The keys `angle` and `closed` of a surface about an axis, which read_shell checks.
void read_turn(const TableReader& table, std::array<double, 2>& angle, bool& closed) {
  constexpr double whole = 2 * std::numbers::pi;
  if (const Value* list = table.value("angle"))
    for (std::size_t i = 0; i < 2; ++i) angle[i] = std::get<double>((*list->as_array())[i].data);
  const bool is_whole = std::abs(angle[1] - angle[0] - whole) <= 1e-9 * whole;
  if (is_whole) angle[1] = angle[0] + whole;
  closed = is_whole && table.boolean("closed").value_or(true);
}

CylinderDomain read_cylinder(const TableReader& cylinder) {
  const auto from = cylinder.vector("from"), to = cylinder.vector("to");
  if (from && to && *from == *to) cylinder.error("to", "is the same point as from; must be another point");
  CylinderDomain domain{from.value_or(Vec3d{}), to.value_or(Vec3d{}), cylinder.number("radius").value_or(1)};
  read_turn(cylinder, domain.angle, domain.closed);
  domain.caps = domain.closed && cylinder.boolean("caps").value_or(true);
  return domain;
}

AnnulusDomain read_annulus(const TableReader& annulus) {
  AnnulusDomain domain{annulus.vector("center").value_or(Vec3d{}),
                       annulus.direction("normal").value_or(Vec3d{{0, 0, 1}})};
  const auto inner = annulus.number("inner"), outer = annulus.number("outer");
  if (inner && outer && !(*outer > *inner))
    annulus.error("outer", fmt::format("{} m is not above inner, {} m; must be above it", *outer, *inner));
  domain.inner = inner.value_or(1);
  domain.outer = outer.value_or(2);
  read_turn(annulus, domain.angle, domain.closed);
  return domain;
}

EllipsoidDomain read_sphere(const TableReader& sphere) {
  const double radius = sphere.number("radius").value_or(1);
  return {sphere.vector("center").value_or(Vec3d{}), Vec3d{{radius, radius, radius}}};
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

/// What a number of the file means [m].
double unit_of_file(const TableReader& domain) {
  const std::optional<std::string> unit = domain.text("unit");
  if (!unit) return 1;
  const std::variant<double, UnitError> size = parse_quantity("1 " + *unit, "m");
  if (const auto* metres = std::get_if<double>(&size); metres && *metres > 0) return *metres;
  domain.error("unit", fmt::format("{} is no unit of length; must be one, as \"mm\"", in_quotes(*unit)));
  return 1;
}

FileDomain read_file(const TableReader& domain, const std::filesystem::path& folder) {
  const std::string name = *domain.text("file");
  if (name.empty()) domain.error("file", "is empty; must be the path of a mesh");
  const std::filesystem::path path = folder / name;
  return {path,
          domain.place("file"),
          unit_of_file(domain),
          domain.integer("refine").value_or(0),
          domain.place("refine"),
          [path](MidNodes mid_nodes) { return io::read_mesh(path, mid_nodes); }};
}

BetweenDomain read_between(const TableReader& body, const std::vector<std::string>& known) {
  const TableReader domain = body.table("domain");
  BetweenDomain between;
  const Array& names = *domain.value("between")->as_array();
  for (std::size_t i = 0; i < 2; ++i) {
    between.bodies[i] = *names[i].as_string();
    between.places[i] = domain.diagnostics().place(names[i].position, join(domain.path_of("between"), i));
    check_other_body(between.bodies[i], between.places[i], body.name(), known, domain.diagnostics());
  }
  if (between.bodies[0] == between.bodies[1] && between.bodies[0] != body.name())
    domain.diagnostics().add(between.places[1], "is the same body again; must be another one");
  between.where = read_region(domain, "where");
  const auto as = domain.text("as");
  if (as == "sheet") between.as = BetweenKind::sheet;
  if (as == "strands") between.as = BetweenKind::strands;
  body.refuse({"transform"}, "is not used by the space between two bodies, which is where they are");
  return between;
}

void require(const TableReader& table, const char* key, const char* message) {
  if (!table.has(key)) table.error(key, message);
}

/// The section of what lies between two bodies.
void check_between_section(const TableReader& body, Extent extent) {
  if (extent != Extent::surface) body.refuse({"thickness"}, "is used only with as = \"sheet\"");
  if (extent != Extent::line) body.refuse({"radius"}, "is used only with as = \"strands\"");
  if (extent == Extent::surface)
    require(body, "thickness", "is missing for as = \"sheet\"; must be a length in m above 0, or a list by region");
  if (extent == Extent::line) require(body, "radius", "is missing for as = \"strands\"; must be a length in m above 0");
}

}  // namespace

Domain read_domain(const TableReader& body, const std::vector<std::string>& bodies,
                   const std::filesystem::path& folder) {
  const TableReader domain = body.table("domain");
  if (domain.value("between")) return read_between(body, bodies);
  if (!domain.has("file")) {
    domain.refuse({"unit"}, "is used only with file; write lengths with their unit, as \"5 mm\"");
    domain.refuse({"refine"}, "is used only with file; give the number of cells");
  }
  if (!domain.has("between")) domain.refuse({"where", "as"}, "is used only with between");
  if (domain.value("file")) return read_file(domain, folder);
  if (domain.value("block")) return read_block(domain.table("block"));
  if (domain.value("cylinder")) return read_cylinder(domain.table("cylinder"));
  if (domain.value("rectangle")) return read_rectangle(domain.table("rectangle"));
  if (domain.value("line")) return read_line(domain.table("line"));
  if (domain.value("annulus")) return read_annulus(domain.table("annulus"));
  if (domain.value("sphere")) return read_sphere(domain.table("sphere"));
  if (domain.value("ellipsoid")) {
    const TableReader ellipsoid = domain.table("ellipsoid");
    return EllipsoidDomain{ellipsoid.vector("center").value_or(Vec3d{}),
                           ellipsoid.vector("radii").value_or(Vec3d{{1, 1, 1}})};
  }
  return read_box(domain.table("box"));
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

std::optional<Extent> read_extent(const TableReader& body) {
  const TableReader domain = body.table("domain");
  if (domain.value("between")) {
    const std::string as = domain.text("as").value_or(domain.has("as") ? "" : "volume");
    if (as.empty()) return std::nullopt;
    return as == "sheet" ? Extent::surface : as == "strands" ? Extent::line : Extent::solid;
  }
  if (domain.has("rectangle")) return Extent::surface;
  if (domain.has("annulus")) return Extent::thin_mesh;
  if (domain.has("line")) return Extent::line;
  if (domain.has("file")) return body.has("thickness") || body.has("radius") ? Extent::thin_mesh : Extent::solid;
  for (const char* solid : {"box", "block", "cylinder", "ellipsoid", "sphere"})
    if (domain.has(solid)) return Extent::solid;
  return std::nullopt;
}

void read_section(const TableReader& table, Body& body) {
  body.thickness_place = table.place("thickness");
  body.radius_place = table.place("radius");
  body.thickness = read_thickness(table);
  body.radius = table.number("radius");
  const std::optional<Extent> extent = read_extent(table);
  if (extent && table.table("domain").has("between")) return check_between_section(table, *extent);
  if (extent == Extent::solid) table.refuse({"thickness", "radius"}, "is not used by a solid");
  if (extent == Extent::surface) {
    require(table, "thickness", "is missing for a rectangle; must be a length in m above 0, or a list by region");
    table.refuse({"radius"}, "is not used by a rectangle, which has thickness");
  }
  if (table.table("domain").has("annulus")) {
    require(table, "thickness", "is missing for an annulus; must be a length in m above 0, or a list by region");
    table.refuse({"radius"}, "is not used by an annulus, which has thickness");
  }
  if (extent == Extent::line) {
    require(table, "radius", "is missing for a line; must be a length in m above 0");
    table.refuse({"thickness"}, "is not used by a line, which has radius");
  }
}

}  // namespace fascia::app
