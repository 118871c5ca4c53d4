#include "io/picture_description.hpp"

#include "core/base/errors.hpp"
#include "io/files.hpp"
#include "io/quantity.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace fascia::io {
namespace {

Vec3d vector_of(const nlohmann::json& list) {
  return {{list.at(0).get<double>(), list.at(1).get<double>(), list.at(2).get<double>()}};
}

constexpr std::array<const char*, 3> kinds{"time", "load factor", "frequency"};  // in the order of StateKind

StateKind kind_of(const std::string& word) {
  const auto found = std::find(kinds.begin(), kinds.end(), word);
  return found == kinds.end() ? StateKind::time : static_cast<StateKind>(found - kinds.begin());
}

/// How far a state is from the nearer of those before and after it that differ; 0 where none does.
double apart_from_neighbours(const std::vector<double>& states, std::size_t state) {
  double least = 0;
  const std::size_t first = state > 0 ? state - 1 : 0, last = std::min(state + 1, states.size() - 1);
  for (std::size_t other = first; other <= last; ++other) {
    const double apart = std::abs(states[other] - states[state]);
    if (apart > 0 && (apart < least || !(least > 0))) least = apart;
  }
  return least;
}

nlohmann::json to_json(const Vec3d& v) { return {v[0], v[1], v[2]}; }

/// Returns the direction that points up in the scene of a result, where its summary says so.
std::optional<Vec3d> up_of_summary(const std::filesystem::path& directory) {
  const std::filesystem::path file = directory / "summary.json";
  if (!std::filesystem::exists(file)) return {};
  const nlohmann::json summary = nlohmann::json::parse(read_file(file), nullptr, false);
  if (!summary.is_object() || !summary.contains("up")) return {};
  const nlohmann::json& up = summary["up"];
  const bool is_vector = up.is_array() && up.size() == 3 &&
                         std::all_of(up.begin(), up.end(), [](const nlohmann::json& x) { return x.is_number(); });
  return is_vector ? std::optional(vector_of(up)) : std::nullopt;
}

PictureDescription from_json(const nlohmann::json& json) {
  PictureDescription description;
  description.title = json.at("title");
  if (json.contains("up")) description.up = vector_of(json["up"]);
  description.kind = kind_of(json.at("kind"));
  description.states = json.at("states").get<std::vector<double>>();
  description.end = json.at("end");
  for (const auto& item : json.at("supports"))
    description.supports.push_back({item.at("body"), vector_of(item.at("at")), item.at("whole")});
  for (const auto& item : json.at("springs"))
    description.springs.push_back({item.at("body"), vector_of(item.at("at")), vector_of(item.at("point"))});
  return description;
}

}  // namespace

void write_description(const std::filesystem::path& directory, const PictureDescription& description) {
  nlohmann::ordered_json json{{"title", description.title}};
  if (description.up) json["up"] = to_json(*description.up);
  json["kind"] = kinds[static_cast<std::size_t>(description.kind)];
  json["states"] = description.states;
  json["end"] = description.end;
  json["supports"] = json["springs"] = nlohmann::ordered_json::array();
  for (const PictureSupport& s : description.supports)
    json["supports"].push_back({{"body", s.body}, {"at", to_json(s.X)}, {"whole", s.whole}});
  for (const PictureSpring& s : description.springs)
    json["springs"].push_back({{"body", s.body}, {"at", to_json(s.X)}, {"point", to_json(s.point)}});
  replace_file(directory / kDescriptionFile, json.dump() + "\n");
}

PictureDescription read_description(const std::filesystem::path& directory) {
  const std::filesystem::path file = directory / kDescriptionFile;
  if (!std::filesystem::exists(file)) {
    PictureDescription description;
    description.up = up_of_summary(directory);
    return description;
  }
  try {
    return from_json(nlohmann::json::parse(read_file(file)));
  } catch (const nlohmann::json::exception& e) {
    throw InputError(
        fmt::format("{}: is no description of pictures that fascia wrote ({}); remove it", file.string(), e.what()));
  }
}

std::string state_label(const PictureDescription& description, int state) {
  if (state < 0 || static_cast<std::size_t>(state) >= description.states.size()) return "";
  const double value = description.states[static_cast<std::size_t>(state)];
  const double apart = apart_from_neighbours(description.states, static_cast<std::size_t>(state));
  std::string label;
  switch (description.kind) {
    case StateKind::time:
      label = "t = " + quantity_text(value, "s", apart);
      break;
    case StateKind::load_factor:
      label = "load factor " + distinct_text(value, apart);
      break;
    case StateKind::frequency:
      label = fmt::format("mode {}: {}", state + 1, quantity_text(value, "Hz"));
      break;
  }
  const bool last = static_cast<std::size_t>(state) + 1 == description.states.size();
  return last && !description.end.empty() ? label + ", " + description.end : label;
}

}  // namespace fascia::io
