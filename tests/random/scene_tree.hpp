#pragma once

#include "app/schema/schema.hpp"
#include "tests/random/draws.hpp"

#include <functional>
#include <map>
#include <string>
#include <vector>

/// A scene as a tree of values, with which alternative of the schema each of them is.
namespace fascia::random_scenes {

/// A value of a scene beside what the schema says of it.
struct Place {
  Json* value = nullptr;
  const app::Shape* shape = nullptr;  ///< with references and alternatives resolved
  std::vector<std::string> path;      ///< keys, names and indices that lead to it
  std::vector<Json*> above;           ///< the values that hold it, the scene first
  const std::string& key() const { return path.back(); }
};

/// Shows every value that the schema knows, tables and lists before what they hold; false: not what it holds.
void visit(Json& scene, const std::function<bool(const Place&)>& look);

/// The shape at a path such as "bodies.*.material.law". @throws std::out_of_range  there is none
const app::Shape& shape_at(std::string_view path);

/// True for a list of three numbers of one unit.
bool is_vector(const app::Shape& shape);

/// A scene as TOML, a key a line, and the line where each key of a section begins ("bodies.b0.mass").
struct SceneText {
  std::string text;
  std::map<std::string, int> lines;
};
SceneText text_of(const Json& scene);

}  // namespace fascia::random_scenes
