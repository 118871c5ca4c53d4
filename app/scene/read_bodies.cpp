#include "app/scene/readers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

template <std::size_t N>
std::array<int, N> to_array(const std::vector<int>& numbers) {
  std::array<int, N> result{};
  std::copy_n(numbers.begin(), N, result.begin());
  return result;
}

Material find_material(const Value& name, const std::string& path, const Materials& materials,
                       Diagnostics& diagnostics) {
  const std::string& wanted = *name.as_string();
  if (const auto found = materials.find(wanted); found != materials.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [key, material] : materials) known.push_back(key);
  diagnostics.add(name.position, path, unknown_name("material", wanted, known));
  return {};
}

Material material_from(const Value& value, const std::string& path, const Materials& materials,
                       Diagnostics& diagnostics) {
  if (value.as_string()) return find_material(value, path, materials, diagnostics);
  return read_material(TableReader(&value, path, diagnostics));
}

std::vector<MaterialUse> read_material_list(const TableReader& body, const Materials& materials) {
  std::vector<MaterialUse> uses;
  const std::vector<TableReader> parts = body.tables("material");
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const TableReader& part = parts[i];
    if (!part.has("where") && i + 1 < parts.size())
      part.error("has no where, so that no later entry can match; must be the last one");
    MaterialUse use{read_region(part, "where"), {}};
    if (const Value* material = part.value("use"))
      use.material = material_from(*material, part.path_of("use"), materials, body.diagnostics());
    uses.push_back(std::move(use));
  }
  return uses;
}

std::vector<MaterialUse> read_material_uses(const TableReader& body, const Materials& materials) {
  const Value* value = body.value("material");
  if (!value) return {};
  if (value->as_array()) return read_material_list(body, materials);
  const Place place = body.place("material");
  return {{{place, AllRegion{}}, material_from(*value, place.key, materials, body.diagnostics())}};
}

void read_frames(const TableReader& frames, Body& body) {
  body.grid_place = frames.place("grid");
  const auto grid = frames.integers("grid");
  if (!grid) return;
  body.grid = to_array<3>(*grid);
  constexpr double most = 1e7;
  const double count = 1.0 * body.grid[0] * body.grid[1] * body.grid[2];
  if (count > most) frames.error("grid", fmt::format("asks for {} frames; must be at most {}", count, most));
}

void read_points(const TableReader& points, Body& body) {
  body.points_place = points.exists() ? points.place() : body.place;
  if (const auto per_cell = points.integers("per_cell")) {
    body.per_cell = to_array<3>(*per_cell);
    body.points_place = points.place("per_cell");
    if (body.weights == WeightKind::linear)
      points.error("per_cell",
                   "is not used by weights of kind \"linear\", which have 4 points in each tetrahedron; remove it");
  }
  const std::string integration = points.text("integration").value_or("auto");
  if (integration == "full") body.integration = Integration::full;
  if (integration == "selective") body.integration = Integration::selective;
}

void read_weights(const TableReader& weights, Body& body) {
  if (weights.text("kind") == "linear") body.weights = WeightKind::linear;
  const std::string blend = weights.text("blend").value_or("auto");
  if (blend == "half") body.blend = Blend::half;
  if (blend == "full") body.blend = Blend::full;
  body.drilling = weights.number("drilling").value_or(body.drilling);
}

InitialMotion read_initial(const TableReader& initial) {
  return {initial.vector("velocity").value_or(Vec3d{}), initial.vector("angular_velocity").value_or(Vec3d{}),
          initial.vector("about")};
}

Transform read_transform(const TableReader& transform) {
  Transform result;
  const TableReader rotate = transform.table("rotate");
  result.translate = transform.vector("translate").value_or(result.translate);
  result.axis = rotate.direction("axis").value_or(result.axis);
  result.angle = rotate.number("angle").value_or(result.angle);
  result.scale = transform.number("scale").value_or(result.scale);
  return result;
}

void read_lame(const TableReader& table, Material& material) {
  const TableReader lame = table.table("lame");
  const auto lambda = lame.number("lambda"), mu = lame.number("mu");
  if (!lambda || !mu) return;
  material.lambda = *lambda;
  material.mu = *mu;
  if (!(3 * *lambda + 2 * *mu > 0))
    lame.error("lambda", fmt::format("{} Pa gives no stable material; must be above -2/3 mu, {:.6g} Pa", *lambda,
                                     -2.0 / 3.0 * *mu));
}

void read_young(const TableReader& table, Material& material) {
  const auto young = table.number("young"), poisson = table.number("poisson");
  if (!young || !poisson) return;
  material.lambda = *young * *poisson / ((1 + *poisson) * (1 - 2 * *poisson));
  material.mu = *young / (2 * (1 + *poisson));
  if (!std::isfinite(material.lambda) || !std::isfinite(material.mu) || !(material.mu > 0))
    table.error("young", fmt::format("{} Pa with Poisson's ratio {} gives no finite stiffness; must be less extreme",
                                     *young, *poisson));
}

}  // namespace

Material read_material(const TableReader& table) {
  Material material;
  material.place = table.place();
  if (table.has("young")) {
    if (!table.has("poisson"))
      table.error("poisson", "is missing beside young; must be a number above -1 and below 0.5");
    read_young(table, material);
  } else if (table.has("lame")) {
    table.refuse({"poisson"}, "is not used beside lame");
    read_lame(table, material);
  }
  const TableReader damping = table.table("damping");
  material.mass_damping = damping.number("mass").value_or(0);
  material.stiffness_damping = damping.number("stiffness").value_or(0);
  return material;
}

Materials read_materials(const TableReader& scene) {
  Materials materials;
  for (const TableReader& table : scene.tables("materials")) {
    Material material = read_material(table);
    material.name = table.name();
    materials.emplace(table.name(), std::move(material));
  }
  return materials;
}

Body read_body(const TableReader& table, const Materials& materials, const std::filesystem::path& folder) {
  Body body;
  body.place = table.place();
  body.name = table.name();
  body.domain_place = table.place("domain");
  body.domain = read_domain(table.table("domain"), folder);
  body.transform = read_transform(table.table("transform"));
  body.materials = read_material_uses(table, materials);
  body.mass = table.number("mass");
  body.density = table.number("density");
  read_frames(table.table("frames"), body);
  read_weights(table.table("weights"), body);
  read_points(table.table("points"), body);
  body.initial = read_initial(table.table("initial"));
  return body;
}

}  // namespace fascia::app
