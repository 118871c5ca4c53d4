#include "app/compare/figures.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace fascia::app {
namespace {

using Json = nlohmann::ordered_json;

/// A value of a summary by its path: "/seconds/setup".
const Json* find(const Json& summary, const std::string& path) {
  const Json::json_pointer pointer(path);
  return summary.contains(pointer) ? &summary.at(pointer) : nullptr;
}

/// A number, or the length of a vector.
std::optional<double> number_at(const Json& summary, const std::string& path) {
  const Json* value = find(summary, path);
  if (value == nullptr) return {};
  if (value->is_number()) return value->get<double>();
  if (!value->is_array()) return {};
  double squares = 0;
  for (const Json& part : *value) {
    if (!part.is_number()) return {};
    squares += part.get<double>() * part.get<double>();
  }
  return std::sqrt(squares);
}

void add(std::vector<Figure>& figures, const Json& a, const Json& b, const std::string& path, std::string name,
         std::string unit) {
  const auto x = number_at(a, path), y = number_at(b, path);
  if (x && y) figures.push_back({std::move(name), std::move(unit), *x, *y});
}

std::string text_at(const Json& summary, const std::string& path) {
  const Json* value = find(summary, path);
  if (value == nullptr) return "";
  return value->is_string() ? value->get<std::string>() : value->dump();
}

/// Names of the members that an object of both summaries has.
std::vector<std::string> common_names(const Json& a, const Json& b, const std::string& path) {
  std::vector<std::string> names;
  const Json *x = find(a, path), *y = find(b, path);
  if (x == nullptr || y == nullptr || !x->is_object() || !y->is_object()) return names;
  for (const auto& [name, value] : x->items())
    if (y->contains(name)) names.push_back(name);
  return names;
}

}  // namespace

std::vector<Figure> energy_figures(const Json& a, const Json& b) {
  std::vector<Figure> figures;
  add(figures, a, b, "/stabilization_energy", "stabilization energy", "J");
  for (const std::string& name : common_names(a, b, "/couplings")) {
    const std::string path = "/couplings/" + name, words = "coupling " + name + ": ";
    add(figures, a, b, path + "/energy", words + "energy", "J");
    add(figures, a, b, path + "/force", words + "force", "N");
    add(figures, a, b, path + "/gap", words + "gap", "m");
  }
  for (const std::string& name : common_names(a, b, "/bodies")) {
    add(figures, a, b, "/bodies/" + name + "/volume", name + ": volume of the matter", "m3");
    add(figures, a, b, "/bodies/" + name + "/mass", name + ": mass", "kg");
    add(figures, a, b, "/bodies/" + name + "/fluid/pressure", name + ": pressure of the fluid", "Pa");
    add(figures, a, b, "/bodies/" + name + "/fluid/volume", name + ": volume of the fluid", "m3");
  }
  return figures;
}

std::vector<Figure> cost_figures(const Json& a, const Json& b) {
  std::vector<Figure> figures;
  add(figures, a, b, "/seconds/setup", "set-up", "s");
  add(figures, a, b, "/seconds/solve", "solve", "s");
  add(figures, a, b, "/seconds/step_median", "step, median", "s");
  add(figures, a, b, "/seconds/step_p99", "step, 99 of 100", "s");
  add(figures, a, b, "/peak_memory_bytes", "peak memory", "bytes");
  add(figures, a, b, "/dofs", "unknowns", "");
  add(figures, a, b, "/steps", "steps", "");
  add(figures, a, b, "/newton_iterations", "Newton iterations", "");
  add(figures, a, b, "/linear_iterations", "linear iterations", "");
  return figures;
}

std::vector<Difference> program_differences(const Json& a, const Json& b) {
  constexpr std::array<std::pair<const char*, const char*>, 12> kFacts{{
      {"version", "/fascia"},
      {"commit", "/provenance/program/commit"},
      {"compiler", "/provenance/program/compiler"},
      {"flags", "/provenance/program/flags"},
      {"build", "/provenance/program/build"},
      {"library", "/library"},
      {"backend", "/backend"},
      {"GPUs", "/gpus"},
      {"precision", "/precision"},
      {"threads", "/threads"},
      {"processor", "/provenance/machine/cpu"},
      {"GPU", "/provenance/machine/gpu"},
  }};
  std::vector<Difference> differences;
  for (const auto& [name, path] : kFacts) {
    std::string x = text_at(a, path), y = text_at(b, path);
    if (x != y) differences.push_back({name, std::move(x), std::move(y)});
  }
  return differences;
}

}  // namespace fascia::app
