#include "tests/random/random_scene.hpp"
#include "tests/random/scene_tree.hpp"

#include <fmt/format.h>

#include <cmath>
#include <functional>

namespace fascia::random_scenes {
namespace {

/// A key of a section, "bodies.b0.mass", and the last key that leads to a place.
std::string section_of(const std::vector<std::string>& path) {
  const bool listed = path[0] == "constraints" || path[0] == "loads";
  const bool named = path[0] == "bodies" || path[0] == "couplings" || path[0] == "probes" || path[0] == "materials";
  std::string section = listed ? fmt::format("{}[{}]", path[0], path[1]) : path[0];
  if (named) section += "." + path[1];
  const std::size_t at = listed || named ? 2 : 1;
  return path.size() > at ? section + "." + path[at] : section;
}

std::string last_key(const std::vector<std::string>& path) {
  for (std::size_t i = path.size(); i > 0; --i)
    if (path[i - 1].find_first_not_of("0123456789") != std::string::npos) return path[i - 1];
  return path[0];
}

/// A way to make a value wrong.
struct Fault {
  const char* name;
  std::function<bool(const Place&)> fits;
  std::function<void(const Place&)> make;
};

std::vector<Fault> faults() {
  using app::Type;
  const auto is_number = [](const Place& p) { return p.shape->type == Type::number && !p.path.empty(); };
  return {
      {"a wrong unit", is_number,
       [](const Place& p) { *p.value = p.shape->unit == "kg" || p.shape->unit == "kg/m3" ? "3 K" : "3 mol"; }},
      {"out of range",
       [=](const Place& p) {
         return (is_number(p) || p.shape->type == Type::integer) && std::isfinite(p.shape->range.min);
       },
       [](const Place& p) {
         if (p.shape->type == Type::integer)
           *p.value = static_cast<int>(p.shape->range.min) - 1;
         else
           *p.value = p.shape->range.min - (p.shape->range.min_excluded ? 0.0 : 1.0);
       }},
      {"a wrong type", [](const Place& p) { return p.shape->type == Type::integer || p.shape->type == Type::choice; },
       [](const Place& p) { *p.value = true; }},
      {"an unknown word", [](const Place& p) { return p.shape->type == Type::choice; },
       [](const Place& p) { *p.value = "nonsense"; }},
      {"a list of the wrong length", [](const Place& p) { return is_vector(*p.shape); },
       [](const Place& p) { p.value->push_back(1.0); }},
      {"no number", is_number, [](const Place& p) { *p.value = "many"; }},
      {"a missing body",
       [](const Place& p) {
         return !p.path.empty() && (p.key() == "body" || p.key() == "to") && p.shape->type == Type::text;
       },
       [](const Place& p) { *p.value = "nobody"; }},
  };
}

/// Counts the places, or makes the fault at one of them.
int places(Json& scene, const Fault& fault, int at, RandomScene* spoilt) {
  int count = 0;
  visit(scene, [&](const Place& p) {
    if (!fault.fits(p) || count++ != at) return true;
    fault.make(p);
    spoilt->blamed = last_key(p.path);
    spoilt->section = section_of(p.path);
    return false;
  });
  return count;
}

/// A key with a letter too many, or without one that is needed.
void spoil_a_key(Draws& draws, RandomScene& scene) {
  std::vector<Place> tables;
  visit(scene.tree, [&](const Place& p) {
    if (p.shape->type == app::Type::table && p.path.size() > 1) tables.push_back(p);
    return true;
  });
  const Place& at = tables[static_cast<std::size_t>(draws.whole(0, static_cast<int>(tables.size()) - 1))];
  scene.section = section_of(at.path);
  scene.wrong = "an unknown key";
  scene.blamed = "colour";
  (*at.value)["colour"] = 1;
  const std::size_t own = at.path[0] == "solver" || at.path[0] == "world" || at.path[0] == "output" ? 1 : 2;
  if (at.path.size() == own) scene.section += ".colour";
  for (const app::Key& key : at.shape->keys)
    if (key.required && at.value->contains(key.name) && key.name != "model" && draws.chance(0.5)) {
      at.value->erase("colour"), at.value->erase(key.name);
      scene.wrong = "a missing key", scene.blamed = key.name, scene.section = section_of(at.path);
      return;
    }
}

}  // namespace

void spoil(Draws& draws, RandomScene& scene) {
  const std::vector<Fault> all = faults();
  const int kind = draws.whole(0, static_cast<int>(all.size()));
  const Fault* fault = kind < static_cast<int>(all.size()) ? &all[static_cast<std::size_t>(kind)] : nullptr;
  const int count = fault != nullptr ? places(scene.tree, *fault, -1, nullptr) : 0;
  if (count == 0) return spoil_a_key(draws, scene);
  scene.wrong = fault->name;
  places(scene.tree, *fault, draws.whole(0, count - 1), &scene);
}

}  // namespace fascia::random_scenes
