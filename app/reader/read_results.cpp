#include "app/reader/readers.hpp"

#include "app/scene/units.hpp"
#include "app/schema/schema.hpp"
#include "io/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fascia::app {
namespace {

struct QuantityName {
  const char* name;
  Quantity quantity;
};

constexpr std::array<QuantityName, 20> quantity_names{{
    {"displacement", Quantity::displacement},
    {"position", Quantity::position},
    {"rotation", Quantity::rotation},
    {"velocity", Quantity::velocity},
    {"strain", Quantity::strain},
    {"stress", Quantity::stress},
    {"force", Quantity::force},
    {"moment", Quantity::moment},
    {"volume", Quantity::volume},
    {"mass", Quantity::mass},
    {"energy", Quantity::energy},
    {"kinetic_energy", Quantity::kinetic_energy},
    {"total_energy", Quantity::total_energy},
    {"momentum", Quantity::momentum},
    {"angular_momentum", Quantity::angular_momentum},
    {"max_displacement", Quantity::max_displacement},
    {"mean_displacement", Quantity::mean_displacement},
    {"frequency", Quantity::frequency},
    {"fluid_volume", Quantity::fluid_volume},
    {"fluid_pressure", Quantity::fluid_pressure},
}};

bool is_at_points(Quantity q) { return q <= Quantity::stress; }
bool is_of_fluid(Quantity q) { return q == Quantity::fluid_volume || q == Quantity::fluid_pressure; }
bool is_on_nodes(Quantity q) { return q == Quantity::force || q == Quantity::moment; }

void need(const TableReader& probe, const char* key, const std::string& quantity, const char* what) {
  if (!probe.has(key)) probe.error(key, fmt::format("is missing for quantity \"{}\"; must be {}", quantity, what));
}

/// The keys that the quantity needs, and those it has no use for.
void check_quantity(const TableReader& probe, Quantity quantity, const std::string& name,
                    std::optional<SolverKind> kind) {
  const std::string unused = fmt::format("is not used by quantity \"{}\"", name);
  const bool about = quantity == Quantity::moment || quantity == Quantity::angular_momentum;
  if (!about) probe.refuse({"about"}, unused);
  if (is_at_points(quantity)) {
    need(probe, "at", name, "a point of the body, or a list of points");
    probe.refuse({"where"}, unused);
  } else {
    probe.refuse({"at"}, unused);
  }
  if (is_of_fluid(quantity)) probe.refuse({"where"}, unused);
  if (is_on_nodes(quantity)) need(probe, "where", name, "a region");
  if (is_at_points(quantity) || is_on_nodes(quantity)) need(probe, "body", name, "the name of a body");
  if (quantity == Quantity::frequency) {
    probe.refuse({"where", "body"}, unused);
    if (kind && kind != SolverKind::modes)
      probe.error("quantity", "\"frequency\" is known only of modes; needs solver.kind = \"modes\"");
  } else if (!is_at_points(quantity) && !is_on_nodes(quantity) && probe.has("where")) {
    need(probe, "body", name, "the body that where selects from");
  }
}

void read_points(const TableReader& table, Probe& probe) {
  const Value* at = table.value("at");
  if (!at) return;
  const Array& items = *at->as_array();
  probe.at_is_list = items.front().as_array() != nullptr;
  if (!probe.at_is_list) probe.at = {to_vector(*at)};
  if (probe.at_is_list)
    for (const Value& point : items) probe.at.push_back(to_vector(point));
}

/// A field that no body of the scene would have is no wish to pass over in silence.
void check_shell_field(const TableReader& table, const char* key, const std::string& field, bool shells) {
  for (const Choice& own : shell_field_choices())
    if (!shells && own.value == field)
      table.error(key, fmt::format("\"{}\" is a field of shells, and no body is one; remove it", field));
}

std::vector<std::string> read_fields(const TableReader& output, bool shells) {
  std::vector<std::string> fields;
  if (const Value* list = output.value("fields")) {
    for (const Value& item : *list->as_array())
      if (std::find(fields.begin(), fields.end(), *item.as_string()) == fields.end())
        fields.push_back(*item.as_string());
    for (const std::string& field : fields) check_shell_field(output, "fields", field, shells);
  } else {
    for (const Choice& field : field_choices()) fields.push_back(field.value);
    for (const Choice& field : shell_field_choices())
      if (shells) fields.push_back(field.value);
  }
  return fields;
}

/// A number in SI, or a text with a unit of the field; reports what is wrong.
std::optional<double> read_end(const TableReader& table, const Value& end, const std::string& unit) {
  const std::string* quantity = end.as_string();
  if (!quantity) return std::get<double>(end.data);
  const auto result = parse_quantity(*quantity, unit);
  if (const auto* error = std::get_if<UnitError>(&result)) table.error("range", error->message);
  return std::holds_alternative<double>(result) ? std::optional(std::get<double>(result)) : std::nullopt;
}

std::optional<std::array<double, 2>> read_range(const TableReader& table, const std::string& field,
                                                std::optional<SolverKind> kind) {
  if (kind == SolverKind::modes) table.refuse({"range"}, "does not go with modes, which have no amplitude");
  const Value* ends = table.value("range");
  if (!ends) return std::nullopt;
  const std::string unit = io::name_of_field(field).unit;
  const auto low = read_end(table, ends->as_array()->front(), unit);
  const auto high = read_end(table, ends->as_array()->back(), unit);
  if (!low || !high) return std::nullopt;
  if (!(*low < *high))
    table.error("range", fmt::format("{:g} is not below {:g}; must be the lower value, then the higher", *low, *high));
  return std::array{*low, *high};
}

Picture read_picture(const TableReader& table, bool shells, std::optional<SolverKind> kind) {
  Picture picture;
  picture.view = table.direction("view").value_or(picture.view);
  if (const auto size = table.integers("size")) picture.size = {(*size)[0], (*size)[1]};
  picture.field = table.text("field").value_or(kind == SolverKind::modes ? "displacement" : picture.field);
  check_shell_field(table, "field", picture.field, shells);
  picture.range = read_range(table, picture.field, kind);
  return picture;
}

/// The key `estimate`.
std::optional<EstimateBy> read_estimate(const TableReader& output) {
  const Value* estimate = output.value("estimate");
  if (!estimate) return std::nullopt;
  const std::string* by = estimate->as_string();
  if (!by) return std::get<bool>(estimate->data) ? std::optional(EstimateBy::automatic) : std::nullopt;
  return *by == "finer" ? EstimateBy::finer : EstimateBy::coarser;
}

}  // namespace

Probe read_probe(const TableReader& table, const std::vector<std::string>& bodies, std::optional<SolverKind> kind) {
  Probe probe;
  probe.place = table.place();
  probe.name = table.name();
  for (const char* column : {"time", "time_step"})
    if (probe.name == column)
      table.diagnostics().add(probe.place, fmt::format("\"{}\" is the name of a column of probes.csv; give the probe "
                                                       "another one",
                                                       column));
  if (table.value("body")) probe.body = read_body_name(table, bodies);
  if (const auto name = table.text("quantity")) {
    const auto found = std::find_if(quantity_names.begin(), quantity_names.end(),
                                    [&](const QuantityName& q) { return *name == q.name; });
    probe.quantity = found->quantity;
    check_quantity(table, probe.quantity, *name, kind);
  }
  read_points(table, probe);
  probe.at_place = table.place("at");
  if (table.has("where")) probe.where = read_region(table, "where");
  probe.about = table.vector("about");
  return probe;
}

Output read_output(const TableReader& scene, const std::string& scene_name, std::optional<SolverKind> kind,
                   bool shells) {
  const TableReader table = scene.table("output");
  Output output;
  output.place = table.place();
  output.directory = table.text("directory").value_or("results/" + scene_name);
  if (output.directory.empty()) table.error("directory", "is empty; must be a path");
  if (kind && !is_dynamic(*kind)) table.refuse({"every"}, "counts simulated time, which only dynamic kinds have");
  output.every = table.number("every").value_or(0);
  output.every_steps = table.integer("every_steps").value_or(0);
  output.fields = read_fields(table, shells);
  output.estimate = read_estimate(table);
  if (const Value* cache = table.value("cache")) {
    if (const bool* kept = std::get_if<bool>(&cache->data)) output.keeps_samples = *kept;
    if (const std::string* folder = cache->as_string()) {
      output.cache = *folder;
      if (folder->empty()) table.error("cache", "is empty; must be the path of a directory, true or false");
    }
  }
  if (table.value("picture")) output.picture = read_picture(table.table("picture"), shells, kind);
  return output;
}

}  // namespace fascia::app
