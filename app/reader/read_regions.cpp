#include "app/reader/readers.hpp"

#include <fmt/format.h>

namespace fascia::app {
namespace {

Region region_from(const Value& value, const std::string& path, Diagnostics& diagnostics);

BoxRegion read_box_region(const TableReader& box) {
  const BoxRegion region{box.vector("min").value_or(Vec3d{}), box.vector("max").value_or(Vec3d{})};
  if (box.value("min") && box.value("max"))
    for (int i = 0; i < 3; ++i)
      if (region.min[i] > region.max[i])
        box.error("max", fmt::format("{} along {} is below min, {}; must be at least min", region.max[i], "xyz"[i],
                                     region.min[i]));
  return region;
}

CylinderRegion read_cylinder_region(const TableReader& cylinder) {
  const CylinderRegion region{cylinder.vector("from").value_or(Vec3d{}), cylinder.vector("to").value_or(Vec3d{}),
                              cylinder.number("radius").value_or(1)};
  if (cylinder.value("from") && cylinder.value("to") && region.from == region.to)
    cylinder.error("to", "is the same point as from; must be another point");
  return region;
}

std::vector<Region> read_parts(const TableReader& table, std::string_view key) {
  std::vector<Region> parts;
  const Value* list = table.value(key);
  if (!list) return parts;
  std::size_t index = 0;
  for (const Value& item : *list->as_array())
    parts.push_back(region_from(item, join(table.path_of(key), index++), table.diagnostics()));
  return parts;
}

GroupRegion read_group(const TableReader& table) {
  const Value& group = *table.value("group");
  if (const auto* number = std::get_if<std::int64_t>(&group.data)) return {std::to_string(*number)};
  if (group.as_string()->empty()) table.error("group", "is empty; must be the name or number of a group");
  return {*group.as_string()};
}

BoundaryRegion read_boundary(const TableReader& table) {
  if (!*table.boolean("boundary"))
    table.error("boundary", "false selects nothing; must be true, or not = { boundary = true }");
  return {};
}

decltype(Region::shape) shape_from(const TableReader& table) {
  if (table.value("box")) return read_box_region(table.table("box"));
  if (table.value("cylinder")) return read_cylinder_region(table.table("cylinder"));
  if (table.value("boundary")) return read_boundary(table);
  if (table.value("group")) return read_group(table);
  if (table.value("all_of")) return AllOfRegion{read_parts(table, "all_of")};
  if (table.value("any_of")) return AnyOfRegion{read_parts(table, "any_of")};
  if (const auto point = table.vector("nearest")) return NearestRegion{*point};
  if (const auto ids = table.integers("ids")) return IdsRegion{*ids};
  if (table.value("sphere")) {
    const TableReader sphere = table.table("sphere");
    return SphereRegion{sphere.vector("center").value_or(Vec3d{}), sphere.number("radius").value_or(1)};
  }
  if (table.value("halfspace")) {
    const TableReader halfspace = table.table("halfspace");
    return HalfspaceRegion{halfspace.vector("point").value_or(Vec3d{}),
                           halfspace.direction("normal").value_or(Vec3d{{0, 0, 1}})};
  }
  if (table.value("not")) return NotRegion{std::make_shared<const Region>(read_region(table, "not"))};
  return AllRegion{};
}

Region region_from(const Value& value, const std::string& path, Diagnostics& diagnostics) {
  Region region{diagnostics.place(value.position, path), AllRegion{}};
  if (value.usable && value.as_table()) region.shape = shape_from(TableReader(&value, path, diagnostics));
  return region;
}

std::vector<std::array<double, 2>> read_profile_table(const TableReader& table, const Array& rows) {
  std::vector<std::array<double, 2>> points;
  for (const Value& row : rows) {
    const Array& pair = *row.as_array();
    points.push_back({std::get<double>(pair[0].data), std::get<double>(pair[1].data)});
  }
  for (std::size_t i = 1; i < points.size(); ++i)
    if (!(points[i][0] > points[i - 1][0]))
      table.diagnostics().add(
          rows[i].position, join(table.path_of("profile"), i),
          fmt::format("time {} s is not after {} s; times must ascend", points[i][0], points[i - 1][0]));
  return points;
}

}  // namespace

Region read_region(const TableReader& table, std::string_view key) {
  const Value* found = table.value(key);
  if (!found) return {table.place(key), AllRegion{}};
  return region_from(*found, table.path_of(key), table.diagnostics());
}

Schedule read_schedule(const TableReader& table) {
  Schedule schedule;
  schedule.over = table.number("over").value_or(0);
  schedule.has_over = table.has("over");
  schedule.dial = table.text("dial").value_or("");
  const Value* profile = table.value("profile");
  if (!profile) return schedule;
  if (const Array* rows = profile->as_array())
    schedule.profile = TableProfile{read_profile_table(table, *rows)};
  else if (profile->as_table())
    schedule.profile = SineProfile{table.table("profile").table("sine").number("period").value_or(1)};
  else if (*profile->as_string() == "smooth")
    schedule.profile = SmoothProfile{};
  return schedule;
}

}  // namespace fascia::app
