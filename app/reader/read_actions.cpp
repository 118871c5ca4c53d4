#include "app/reader/readers.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace fascia::app {
namespace {

constexpr std::array<const char*, 6> component_names{"x", "y", "z", "rx", "ry", "rz"};

/// Marks the components that a list such as ["x", "ry"] names.
std::array<bool, 6> components_in(const Value& list) {
  std::array<bool, 6> marked{};
  for (const Value& item : *list.as_array())
    for (std::size_t i = 0; i < 6; ++i)
      if (*item.as_string() == component_names[i]) marked[i] = true;
  return marked;
}

/// Rows: a unit vector along `first` and two across it.
Mat3d axes_along(const Vec3d& first) {
  const Vec3d a = normalized(first);
  int smallest = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(a[i]) < std::abs(a[smallest])) smallest = i;
  Vec3d helper;
  helper[smallest] = 1;
  const Vec3d b = normalized(cross(a, helper));
  return transpose(Mat3d::from_columns(a, b, cross(a, b)));
}

Mat3d read_axes(const TableReader& table) {
  const Value* value = table.value("axes");
  if (!value) return Mat3d::identity();
  std::array<Vec3d, 3> rows;
  for (std::size_t i = 0; i < 3; ++i) {
    rows[i] = to_vector((*value->as_array())[i]);
    const double length = norm(rows[i]);
    if (!(length > 1e-150) || !std::isfinite(length)) {
      table.error("axes", fmt::format("axis {} has no direction; must be three perpendicular vectors", i));
      return Mat3d::identity();
    }
    rows[i] = normalized(rows[i]);
  }
  for (std::size_t i = 0; i < 3; ++i)
    if (const double cosine = dot(rows[i], rows[(i + 1) % 3]); std::abs(cosine) > 1e-6) {
      table.error(
          "axes",
          fmt::format("axes {} and {} are not perpendicular (cosine {:.3g}); must be three perpendicular vectors", i,
                      (i + 1) % 3, cosine));
      break;
    }
  return transpose(Mat3d::from_columns(rows[0], rows[1], rows[2]));
}

/// A plane or hinge: its own axes, the first along `key`.
void fix_along(const TableReader& table, const char* key, std::array<bool, 6> fixed, Constraint& constraint) {
  constraint.fixed = fixed;
  table.refuse({"axes"}, fmt::format("cannot stand beside {}", key));
  if (!table.has(key))
    table.error(key, fmt::format("is missing beside fix = {}; must be a vector", describe(*table.value("fix"))));
  if (const auto direction = table.direction(key)) constraint.axes = axes_along(*direction);
}

void read_fix(const TableReader& table, Constraint& constraint) {
  const Value* fix = table.value("fix");
  if (!fix) return;
  const std::string word = fix->as_string() ? *fix->as_string() : "";
  if (word != "symmetry") table.refuse({"normal"}, "is used only with fix = \"symmetry\"");
  if (word != "hinge") table.refuse({"axis"}, "is used only with fix = \"hinge\"");
  if (word.empty()) constraint.fixed = components_in(*fix);
  if (word == "all") constraint.fixed.fill(true);
  if (word == "position") constraint.fixed = {true, true, true, false, false, false};
  if (word == "rotation") constraint.fixed = {false, false, false, true, true, true};
  if (word == "symmetry") fix_along(table, "normal", {true, false, false, false, true, true}, constraint);
  if (word == "hinge") fix_along(table, "axis", {true, true, true, false, true, true}, constraint);
}

void read_move(const TableReader& table, Constraint& constraint) {
  const TableReader move = table.table("move");
  const TableReader rotate = move.table("rotate");
  Motion motion;
  motion.translate = move.vector("translate").value_or(motion.translate);
  motion.axis = rotate.direction("axis").value_or(motion.axis);
  motion.angle = rotate.number("angle").value_or(motion.angle);
  motion.center = rotate.vector("center").value_or(motion.center);
  if (move.exists() && !move.has("translate") && !move.has("rotate"))
    move.error("moves nothing; must have translate, rotate or both");
  constraint.fixed.fill(true);
  if (const Value* axes = move.value("axes")) constraint.fixed = components_in(*axes);
  constraint.motion = motion;
}

/// The quantities of a load belong either to `where` or to `at`.
void check_load_keys(const TableReader& table) {
  const std::vector<std::string> of_region{"total_force", "total_torque", "force_per_node",
                                           "traction",    "pressure",     "line_force"},
      of_point{"force", "torque"};
  const bool at = table.has("at"), where = table.has("where");
  if (at == where) return;
  table.refuse(at ? of_region : of_point,
               at ? "goes with where, not with at"
                  : fmt::format("goes with at, not with where (there: {})", fmt::join(of_region, ", ")));
  const std::vector<std::string>& wanted = at ? of_point : of_region;
  const auto given = [&](const std::string& key) { return table.has(key); };
  if (std::none_of(of_region.begin(), of_region.end(), given) && std::none_of(of_point.begin(), of_point.end(), given))
    table.error(fmt::format("applies nothing; must have {}", join_or(wanted)));
}

}  // namespace

std::string read_body_name(const TableReader& table, const std::vector<std::string>& bodies) {
  const auto name = table.text("body");
  if (!name) return "";
  if (std::find(bodies.begin(), bodies.end(), *name) == bodies.end())
    table.error("body", unknown_name("body", *name, bodies));
  return *name;
}

void check_other_body(const std::string& name, const Place& place, const std::string& own,
                      const std::vector<std::string>& bodies, Diagnostics& diagnostics) {
  if (name == own) return diagnostics.add(place, "is the body itself; must be another one");
  if (std::find(bodies.begin(), bodies.end(), name) != bodies.end()) return;
  std::vector<std::string> others;
  std::copy_if(bodies.begin(), bodies.end(), std::back_inserter(others), [&](const auto& b) { return b != own; });
  diagnostics.add(place, others.empty() ? fmt::format("{} is no known body; the scene has no other", in_quotes(name))
                                        : unknown_name("body", name, others));
}

Constraint read_constraint(const TableReader& table, const std::vector<std::string>& bodies) {
  Constraint constraint;
  constraint.place = table.place();
  constraint.body = read_body_name(table, bodies);
  constraint.where = read_region(table, "where");
  constraint.axes = read_axes(table);
  if (table.has("move")) {
    table.refuse({"normal", "axis", "driver"}, "is not used with move");
    read_move(table, constraint);
    constraint.schedule = read_schedule(table);
  } else {
    read_fix(table, constraint);
    table.refuse({"over", "profile", "dial"}, "is used only with move");
    constraint.driver = table.text("driver").value_or("");
  }
  return constraint;
}

Load read_load(const TableReader& table, const std::vector<std::string>& bodies) {
  Load load;
  load.place = table.place();
  load.body = read_body_name(table, bodies);
  if (table.has("where")) load.where = read_region(table, "where");
  load.at = table.vector("at");
  load.at_place = table.place("at");
  load.total_force = table.vector("total_force");
  load.total_torque = table.vector("total_torque");
  load.force_per_node = table.vector("force_per_node");
  load.force = table.vector("force");
  load.torque = table.vector("torque");
  load.traction = table.vector("traction");
  load.pressure = table.number("pressure");
  load.pressure_follows = table.boolean("follower").value_or(true);
  load.line_force = table.vector("line_force");
  load.follower = table.boolean("follower").value_or(false);
  load.schedule = read_schedule(table);
  check_load_keys(table);
  if (load.follower && table.has("traction"))
    table.error("follower", "true does not go with traction, which keeps its direction; must be false");
  return load;
}

}  // namespace fascia::app
