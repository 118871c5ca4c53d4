#include "app/reader/readers.hpp"
#include "app/scene/laws.hpp"
#include "app/schema/schema.hpp"

#include <fmt/format.h>

#include <cmath>

namespace fascia::app {
namespace {

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
  for (const TableReader& part : read_choices(body, "material")) {
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

InitialMotion read_initial(const TableReader& initial) {
  return {initial.vector("velocity").value_or(Vec3d{}), initial.vector("angular_velocity").value_or(Vec3d{}),
          initial.vector("about")};
}

Fluid read_fluid(const TableReader& table) {
  Fluid fluid;
  fluid.place = table.place();
  fluid.pressure = table.number("pressure");
  fluid.bulk_modulus = table.number("bulk_modulus");
  fluid.volume = table.number("volume");
  fluid.density = table.number("density").value_or(0);
  fluid.schedule = read_schedule(table);
  if (!table.has("bulk_modulus")) table.refuse({"volume"}, "is used only beside bulk_modulus");
  return fluid;
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
  static_cast<Lame&>(material) = Lame::from_young(*young, *poisson);
  if (!std::isfinite(material.lambda) || !std::isfinite(material.mu) || !(material.mu > 0))
    table.error("young", fmt::format("{} Pa with Poisson's ratio {} gives no finite stiffness; must be less extreme",
                                     *young, *poisson));
}

/// Constants that the law does not have.
void refuse_other_constants(const TableReader& table, const LawWord& law) {
  const std::string why = fmt::format("is no constant of the law \"{}\"", law.word);
  if (!law.own.empty()) return table.refuse({"young", "poisson", "lame"}, why);
  table.refuse({"bulk"}, why);
  for (const LawWord& other : kMaterialLaws)
    for (const LawKey& key : other.own)
      if (table.has(key.name))
        table.error(key.name, fmt::format("{}; remove it, or {} law = \"{}\"", why, table.has("law") ? "use" : "add",
                                          other.word));
}

/// Reads the constants that the law has of its own, and makes Lamé's of small strain from them.
void read_own_constants(const TableReader& table, const LawWord& law, Material& material) {
  bool complete = true;
  const auto read = [&](const char* name, bool needed) {
    const auto value = table.number(name);
    if (!value && needed && !table.has(name))
      table.error(name, fmt::format("is missing; the law \"{}\" needs it", law.word));
    complete = complete && (value || !needed);
    return value.value_or(0);
  };
  for (const LawKey& key : law.own) material.own.push_back(read(key.name, key.needed));
  const double bulk = read("bulk", true);
  if (!complete) return;
  const double mu = law.shear_modulus(material.own);
  static_cast<Lame&>(material) = Lame::from_bulk(bulk, mu);
  if (!(mu > 0) || !std::isfinite(mu))
    return table.error(law.own.front().name,
                       fmt::format("makes a shear modulus of {:.6g} Pa at small strain; must make one above 0", mu));
  constexpr double kLeast = 1e-9, kMost = 1e12;  // of bulk / mu, so that Poisson's ratio has digits left
  if (!(bulk >= kLeast * mu && bulk <= kMost * mu) || !std::isfinite(material.young()))
    table.error("bulk", fmt::format("{:.6g} Pa beside a shear modulus of {:.6g} Pa; must be {:g} to {:g} times as much",
                                    bulk, mu, kLeast, kMost));
}

/// @return null where there is none
std::shared_ptr<const Viscosity> read_viscosity(const TableReader& table) {
  if (!table.has("viscosity")) {
    table.refuse({"relax", "statics"}, "is used only beside viscosity");
    return nullptr;
  }
  Viscosity viscosity;
  for (const TableReader& branch : table.tables("viscosity")) {
    const auto share = branch.number("share"), time = branch.number("time");
    if (share && time) viscosity.branches.push_back({*share, *time});
  }
  viscosity.shear_only = table.text("relax") == "shear";
  viscosity.instantaneous_statics = table.text("statics") == "instantaneous";
  if (const double lasting = viscosity.long_term(); !(lasting > kLeastLasting))
    table.error("viscosity",
                fmt::format("has shares that sum up to {:.9g}; must sum up to less than {:.9g}, so that a part of the "
                            "stiffness lasts",
                            1 - lasting, 1 - kLeastLasting));
  if (table.table("damping").number("stiffness").value_or(0) > 0)
    table.table("damping").error("stiffness", "is a viscosity of its own; remove it, or the material's viscosity");
  return std::make_shared<const Viscosity>(std::move(viscosity));
}

std::optional<BodyModel> read_model(const TableReader& body) {
  const auto word = body.text("model");
  if (!word) return std::nullopt;
  for (const BodyModel model :
       {BodyModel::tetrahedra, BodyModel::hexahedra, BodyModel::shell, BodyModel::rigid, BodyModel::surface})
    if (*word == app::word(model)) return model;
  return BodyModel::meshless;
}

/// Thin bodies: their laws hold for a vanishing stress through the thickness or across the section.
void check_thin_laws(const TableReader& table, const Body& body) {
  const std::optional<Extent> extent = read_extent(table);
  if (!extent || *extent == Extent::solid) return;
  refuse_shear_relaxation(table, body, "thin bodies");
  for (std::size_t i = 0; i < body.materials.size(); ++i)
    if (const Law law = body.materials[i].material.law; needs_large_strain(law))
      table.diagnostics().add(
          place_of_material(table, i),
          fmt::format("has the law \"{}\", which thin bodies do not take; must be of the law \"{}\"", word(law),
                      kMaterialLaws[0].word));
}

void read_meshless(const TableReader& table, const std::vector<std::string>& bodies,
                   const std::filesystem::path& folder, Body& body) {
  refuse_element_keys(table);
  if (!table.has("frames") && !body.under_need)
    table.error("frames", "is missing; must be " + in_words(frames_schema()) + kNeedWouldChoose);
  read_section(table, body);
  read_discretisation(table, bodies, folder, body);
  check_thin_laws(table, body);
}

/// What a body is made of.
void check_matter(const TableReader& table, const Body& body) {
  if (!is_carrier(body)) {
    table.refuse({"inertia"}, unused_by(body.model));
    if (!table.has("material")) table.error("material", "is missing; must be " + in_words(body_material_schema()));
  }
  const bool weighs = body.model != BodyModel::surface;
  const bool of_inertia = body.model == BodyModel::rigid && table.has("inertia");  // asks for a mass by itself
  if (weighs && !of_inertia && !table.has("mass") && !table.has("density"))
    table.error("mass or density is missing; give exactly one");
}

/// The keys of the body's model.
void read_model_keys(const TableReader& table, const std::vector<std::string>& bodies,
                     const std::filesystem::path& folder, Body& body) {
  if (is_carrier(body)) return read_carrier(table, body);
  if (is_shell(body)) return read_shell(table, body);
  if (is_mesh_model(body)) return read_elements(table, body);
  read_meshless(table, bodies, folder, body);
}

}  // namespace

Place place_of_material(const TableReader& body, std::size_t use) {
  const Value* value = body.value("material");
  return value && value->as_array() ? body.tables("material")[use].place("use") : body.place("material");
}

void refuse_shear_relaxation(const TableReader& body, const Body& read, const char* who) {
  for (std::size_t i = 0; i < read.materials.size(); ++i) {
    const Material& material = read.materials[i].material;
    const std::string named = material.name.empty() ? "" : fmt::format("\"{}\" ", material.name);
    if (material.viscosity && material.viscosity->shear_only)
      body.diagnostics().add(
          place_of_material(body, i),
          fmt::format("{}relaxes in shear alone, which {} do not; must have relax = \"all\"", named, who));
  }
}

Material read_material(const TableReader& table) {
  Material material;
  material.place = table.place();
  const auto text = table.text("law");
  if (text) material.law = material_law(*text);
  const LawWord& law = law_word(material.law);
  if (table.has("law") && !text) return material;  // no known law, as the schema has said
  refuse_other_constants(table, law);
  if (!law.own.empty()) {
    read_own_constants(table, law, material);
  } else if (table.has("young")) {
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
  material.viscosity = read_viscosity(table);
  read_muscle(table, material);
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

std::vector<TableReader> read_choices(const TableReader& table, std::string_view key) {
  std::vector<TableReader> choices = table.tables(key);
  for (std::size_t i = 0; i + 1 < choices.size(); ++i)
    if (!choices[i].has("where"))
      choices[i].error("has no where, so that no later entry can match; must be the last one");
  return choices;
}

Body read_body(const TableReader& table, const Materials& materials, const std::vector<std::string>& bodies,
               const std::filesystem::path& folder, bool under_need) {
  Body body;
  body.place = table.place();
  body.name = table.name();
  body.under_need = under_need;
  body.domain_place = table.place("domain");
  body.domain = read_domain(table, bodies, folder);
  body.transform = read_transform(table.table("transform"));
  if (const auto* file = std::get_if<FileDomain>(&body.domain)) body.transform.scale *= file->unit;
  body.materials = read_material_uses(table, materials);
  body.mass = table.number("mass");
  body.density = table.number("density");
  const std::optional<BodyModel> model = read_model(table);
  body.frames_place = body.points_place = body.weights_place = body.place;
  body.cells_place = body.domain_place;
  body.model = model.value_or(BodyModel::meshless);
  if (model) {
    read_model_keys(table, bodies, folder, body);
    check_matter(table, body);
  }
  body.initial = read_initial(table.table("initial"));
  if (table.has("fluid")) body.fluid = read_fluid(table.table("fluid"));
  return body;
}

}  // namespace fascia::app
