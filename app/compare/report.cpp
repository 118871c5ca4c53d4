#include "app/compare/report.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace fascia::app {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t kShown = 12;

std::string percent(double relative) {
  return std::isfinite(relative) ? fmt::format("{:.3g} %", 100 * relative) : "missing";
}

std::string with_unit(double value, const std::string& unit) {
  const std::string number = std::isfinite(value) ? fmt::format("{:.4g}", value) : "-";
  return unit.empty() || unit == "1" ? number : number + " " + unit;
}

std::string place_text(const Vec3d& x) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", x[0], x[1], x[2]); }

/// A number or a vector; of a tensor its norm.
std::string value_text(const std::vector<double>& v, const std::string& unit) {
  if (v.size() == 1) return with_unit(v[0], unit);
  const bool finite = std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); });
  if (!finite) return "-";
  if (v.size() == 3)
    return with_unit(v[0], "").append(fmt::format(", {:.4g}, {:.4g}", v[1], v[2])).insert(0, "(").append(")");
  double squares = 0;
  for (const double x : v) squares += x * x;
  return "|" + with_unit(std::sqrt(squares), unit) + "|";
}

/// Rows of columns, each as wide as its widest cell; the first is aligned to the left.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> head) { rows_.push_back(std::move(head)); }
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }

  std::string text() const {
    if (rows_.size() == 1) return "";
    std::vector<std::size_t> widths(rows_[0].size());
    const std::size_t shown = std::min(rows_.size(), kShown + 1);
    for (std::size_t r = 0; r < shown; ++r)
      for (std::size_t c = 0; c < widths.size(); ++c) widths[c] = std::max(widths[c], rows_[r][c].size());
    std::string out = "\n";
    for (std::size_t r = 0; r < shown; ++r) {
      std::string line = fmt::format("{:<{}}", rows_[r][0], widths[0]);
      for (std::size_t c = 1; c < widths.size(); ++c) line += fmt::format("  {:>{}}", rows_[r][c], widths[c]);
      out += line + "\n";
    }
    if (rows_.size() > shown) out += fmt::format("and {} more; --json has all\n", rows_.size() - shown);
    return out;
  }

 private:
  std::vector<std::vector<std::string>> rows_;
};

std::string ratio(const Figure& f) { return f.a > 0 ? fmt::format("{:.3g}", f.b / f.a) : "-"; }

std::string figures_text(const char* head, const std::vector<Figure>& figures) {
  TextTable table({head, "A", "B", "B / A"});
  for (const Figure& f : figures)
    if (f.a != 0 || f.b != 0) table.add({f.name, with_unit(f.a, f.unit), with_unit(f.b, f.unit), ratio(f)});
  return table.text();
}

std::string differences_text(const char* head, const std::vector<Difference>& differences) {
  if (differences.empty()) return "";
  constexpr std::size_t kMostText = 60;
  const auto shortened = [](const std::string& text) {
    return text.empty() ? "nothing" : text.size() > kMostText ? text.substr(0, kMostText) + " ..." : text;
  };
  std::string out = fmt::format("\n{}\n", head);
  for (std::size_t i = 0; i < std::min(kShown, differences.size()); ++i)
    out += fmt::format("  {}: {} in A, {} in B\n", differences[i].name, shortened(differences[i].a),
                       shortened(differences[i].b));
  if (differences.size() > kShown) out += fmt::format("  and {} more; --json has all\n", differences.size() - kShown);
  return out;
}

std::string fields_text(const std::vector<FieldDifference>& fields) {
  TextTable table({"field", "difference", "root mean square", "largest", "at (rest)", "time"});
  for (const FieldDifference& d : fields)
    table.add({d.name(), percent(d.relative), with_unit(d.root_mean, d.unit), with_unit(d.largest, d.unit),
               place_text(d.place), fmt::format("{:.4g}", d.time)});
  return table.text();
}

std::string probes_text(const std::vector<ProbeDifference>& probes) {
  TextTable table({"probe", "difference", "A", "B", "unit", "time"});
  for (const ProbeDifference& d : probes)
    table.add(
        {d.name, percent(d.relative), value_text(d.a, ""), value_text(d.b, ""), d.unit, fmt::format("{:.4g}", d.time)});
  return table.text();
}

std::string verdict_text(const Comparison& c, double tolerance) {
  const std::string counted = fmt::format("{} numbers of {} quantities", c.numbers, c.quantities.size());
  if (c.numbers == 0) return "the results hold no numbers that both have";
  if (c.exact && c.structure.empty()) return "equal in every digit: " + counted;
  const QuantityDifference* worst = c.quantities.empty() ? nullptr : &c.quantities.front();
  std::string text = fmt::format("{} the tolerance {:g}", c.largest() <= tolerance ? "within" : "above", tolerance);
  if (worst != nullptr && worst->relative > 0)
    text += fmt::format(": {} differs by {}", worst->name, percent(worst->relative));
  return text + fmt::format(" ({}, {})", counted, c.array_by_array ? "array by array" : "meshes or times differ");
}

std::string largest_text(const FieldDifference& d) {
  std::string text = fmt::format("{}: largest difference {} at {} at rest, time {:.4g}: {} in A, {} in B\n", d.name(),
                                 with_unit(d.largest, d.unit), place_text(d.place), d.time, value_text(d.a, d.unit),
                                 value_text(d.b, d.unit));
  if (d.relative > 0 && d.interpolation > 0.1 * d.relative)
    text += fmt::format("{}: interpolation between the points of a meshless body may add {}\n", d.name(),
                        percent(d.interpolation));
  return text;
}

/// A line for the field that differs most, and for the displacement that does; empty where none does.
std::string largest_text(const Comparison& c) {
  const FieldDifference *field = nullptr, *displacement = nullptr;
  for (const FieldDifference& d : c.fields.fields) {
    const bool counts = std::any_of(c.quantities.begin(), c.quantities.end(),
                                    [&](const QuantityDifference& q) { return q.name == d.name(); });
    if (!counts || d.largest == 0) continue;
    if (field == nullptr) field = &d;
    if (displacement == nullptr && d.field == "displacement") displacement = &d;
  }
  if (field == nullptr) return "";
  return largest_text(*field) + (displacement != nullptr && displacement != field ? largest_text(*displacement) : "");
}

Json number(double v) { return std::isfinite(v) ? Json(v) : Json("missing in one"); }

Json numbers(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double v : values) list.push_back(std::isfinite(v) ? Json(v) : Json());
  return values.size() == 1 ? list[0] : list;
}

Json json_of(const std::vector<Figure>& figures) {
  Json j = Json::object();
  for (const Figure& f : figures) {
    j[f.name] = {{"unit", f.unit}, {"a", f.a}, {"b", f.b}};
    if (f.a != 0) j[f.name]["ratio"] = f.b / f.a;
  }
  return j;
}

Json json_of(const std::vector<Difference>& differences) {
  Json list = Json::array();
  for (const Difference& d : differences) {
    Json& entry = list.emplace_back(Json{{"key", d.name}});
    entry["a"] = d.a.empty() ? Json() : Json(d.a);
    entry["b"] = d.b.empty() ? Json() : Json(d.b);
  }
  return list;
}

Json json_of(const FieldDifference& d) {
  return {{"unit", d.unit},
          {"relative", d.relative},
          {"root_mean_square", d.root_mean},
          {"root_mean_square_a", d.root_mean_a},
          {"root_mean_square_b", d.root_mean_b},
          {"worst_time", d.worst_time},
          {"interpolation", d.interpolation},
          {"largest",
           {{"difference", d.largest},
            {"relative", d.magnitude > 0 ? d.largest / d.magnitude : 0},
            {"rest_position", {d.place[0], d.place[1], d.place[2]}},
            {"time", d.time},
            {"a", numbers(d.a)},
            {"b", numbers(d.b)}}}};
}

Json json_of(const ComparedBody& b) {
  const char* measure[] = {"points", "length", "area", "volume"};
  return {{"same_mesh", b.pair.same_mesh},
          {"sampled", b.pair.sampled == 0 ? "a" : "b"},
          {"measure", measure[b.pair.dimension]},
          {"size", b.pair.measure},
          {"places", b.places},
          {"beside", b.pair.beside},
          {"farthest", b.pair.farthest},
          {"left_out", b.pair.left_out}};
}

Json json_of(const ProbeDifference& d) {
  return {{"unit", d.unit},
          {"relative", number(d.relative)},
          {"difference", number(d.largest)},
          {"time", d.time},
          {"a", numbers(d.a)},
          {"b", numbers(d.b)}};
}

}  // namespace

std::string words_of(const Comparison& c, double tolerance) {
  std::string out = verdict_text(c, tolerance) + "\n" + largest_text(c);
  for (const std::string& sentence : c.structure) out += "not comparable: " + sentence + "\n";
  out += fmt::format("A is {}, B is {}\n", c.a.string(), c.b.string());
  if (!c.exact)
    out += fields_text(c.fields.fields) + probes_text(c.probes.probes) +
           figures_text("energies, bodies, couplings", c.energies);
  out += figures_text("cost (no part of the tolerance)", c.costs);
  out += differences_text("settings that differ", c.settings);
  out += differences_text("files that differ", c.files);
  out += differences_text("programs and machines that differ", c.program);
  if (!c.notes.empty()) out += "\n";
  for (const std::string& note : c.notes) out += note + "\n";
  return out;
}

Json json_of(const Comparison& c, double tolerance) {
  Json j;
  j["a"] = c.a.string();
  j["b"] = c.b.string();
  j["tolerance"] = tolerance;
  j["within"] = c.within(tolerance);
  j["exact"] = c.exact && c.structure.empty();
  j["largest"] = number(c.largest());
  j["largest_of"] = c.quantities.empty() ? "" : c.quantities.front().name;
  j["numbers"] = c.numbers;
  j["structure"] = c.structure;
  j["notes"] = c.notes;
  j["method"] = c.array_by_array ? "array by array" : "interpolated";
  j["quantities"] = Json::object();
  for (const QuantityDifference& q : c.quantities)
    j["quantities"][q.name] = {
        {"relative", number(q.relative)}, {"absolute", number(q.absolute)}, {"at", q.at}, {"numbers", q.numbers}};
  j["bodies"] = Json::object();
  for (const ComparedBody& body : c.fields.bodies) j["bodies"][body.name] = json_of(body);
  j["fields"] = Json::object();
  for (const FieldDifference& d : c.fields.fields) j["fields"][d.name()] = json_of(d);
  j["probes"] = Json::object();
  for (const ProbeDifference& d : c.probes.probes) j["probes"][d.name] = json_of(d);
  j["energies"] = json_of(c.energies);
  j["cost"] = json_of(c.costs);
  j["settings"] = json_of(c.settings);
  j["files"] = json_of(c.files);
  j["program"] = json_of(c.program);
  return j;
}

}  // namespace fascia::app
