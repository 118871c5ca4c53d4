#include "tests/random/twins.hpp"

#include "app/extremes/other_units.hpp"
#include "tests/random/scene_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

namespace fascia::random_scenes {
namespace {

/// A reflection turns these about: vectors along an axis of rotation.
bool is_axial(const std::string& key) {
  static const std::set<std::string> keys{"total_torque", "torque", "angular_velocity", "rotations",
                                          "rotation",     "moment", "angular_momentum"};
  return keys.contains(key);
}

std::size_t target(const Frame& frame, std::size_t axis) { return frame.turned ? (axis + 1) % 3 : axis; }

template <class T>
std::vector<T> permuted(const Frame& frame, const std::vector<T>& old) {
  std::vector<T> result = old;
  for (std::size_t i = 0; i < 3; ++i) result[target(frame, i)] = old[i];
  return result;
}

std::vector<double> vector_in(const Frame& frame, const std::vector<double>& old, bool axial) {
  std::vector<double> result = permuted(frame, old);
  if (!frame.mirrored) return result;
  for (std::size_t i = 0; i < 3; ++i)
    if ((static_cast<int>(i) == *frame.mirrored) != axial) result[i] = -result[i];
  return result;
}

/// "x" or "rx" along the axes of the new frame.
std::string axis_in(const Frame& frame, const std::string& name) {
  const std::size_t at = std::string("xyz").find(name.back());
  return name.substr(0, name.size() - 1) + "xyz"[target(frame, at)];
}

class Rewriter {
 public:
  explicit Rewriter(const Frame& frame) : frame_(frame) {}

  bool look(const Place& at) const {
    Json& value = *at.value;
    if (is_vector(*at.shape)) {
      const std::string& unit = at.shape->items[0].unit;
      std::vector<double> old = value.get<std::vector<double>>();
      if (at.key() == "radii")
        old = permuted(frame_, old);
      else
        old = vector_in(frame_, old, is_axial(at.key()) || is_axis_of_rotation(at));
      for (double& v : old) v *= frame_.factor(unit);
      value = old;
      return false;
    }
    if (at.shape->type == app::Type::number) {
      const double factor = frame_.factor(at.shape->unit);
      if (factor != 1) value = value.get<double>() * factor;
    } else if (at.shape->type == app::Type::choice && is_axis_name(value)) {
      if (!at.above.at(2)->contains("axes")) value = axis_in(frame_, value);
    } else if (value.is_array() && value.size() == 3 && value[0].is_number_integer() && goes_by_axes(at)) {
      value = permuted(frame_, value.get<std::vector<int>>());
      return false;
    }
    return true;
  }

 private:
  static bool is_axis_of_rotation(const Place& at) {
    return at.key() == "axis" && at.path.size() > 1 && at.path[at.path.size() - 2] == "rotate";
  }
  static bool is_axis_name(const Json& value) {
    static const std::set<std::string> names{"x", "y", "z", "rx", "ry", "rz"};
    return names.contains(value.get<std::string>());
  }
  static bool goes_by_axes(const Place& at) {
    const std::string& holder = at.path[at.path.size() - 2];
    return at.key() == "grid" || at.key() == "per_cell" || (at.key() == "cells" && holder == "box");
  }

  const Frame& frame_;
};

/// A reflection changes more than components: corners of boxes, the order of a block's, the normals of open sheets.
void mend_reflection(Json& scene, const Frame& frame) {
  visit(scene, [&](const Place& at) {
    Json& value = *at.value;
    if (value.is_object() && value.contains("min") && value.contains("max"))
      for (std::size_t i = 0; i < 3; ++i)
        if (value["min"][i].get<double>() > value["max"][i].get<double>()) std::swap(value["min"][i], value["max"][i]);
    if (at.path.size() > 1 && at.key() == "corners" && frame.mirrored)
      value = {value[1], value[0], value[3], value[2], value[5], value[4], value[7], value[6]};
    return true;
  });
  if (!frame.mirrored || !scene.contains("loads")) return;
  for (Json& load : scene["loads"])
    if (load.contains("pressure") && scene["bodies"][load["body"].get<std::string>()]["domain"].contains("rectangle"))
      load["pressure"] = -load["pressure"].get<double>();
}

/// False where modes or a path are looked for, or an imperfection of either sign would do.
bool has_step_solver(const Json& scene) {
  const Json& solver = scene["solver"];
  return solver.value("kind", "static") != "modes" && solver.value("control", "load") == "load" &&
         !solver.contains("imperfection");
}

void use_solver(Json& scene, bool cg) {
  Json& linear = scene["solver"]["linear"];
  linear = Json::object({{"kind", cg ? "cg" : "cholesky"}});
  if (cg) linear["max_iterations"] = 20000;
}

}  // namespace

double Frame::factor(const std::string& unit) const { return app::UnitFactors{mass, length, time}.of(unit); }

std::vector<double> Frame::values(const std::vector<double>& old, const std::string& quantity,
                                  const std::string& unit) const {
  std::vector<double> result = old;
  if (old.size() == 3) result = vector_in(*this, old, is_axial(quantity));
  if (old.size() == 9)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t a = target(*this, i), b = target(*this, k);
        const bool flipped = mirrored && (static_cast<int>(a) == *mirrored) != (static_cast<int>(b) == *mirrored);
        result[3 * a + b] = flipped ? -old[3 * i + k] : old[3 * i + k];
      }
  for (double& v : result) v *= factor(unit);
  return result;
}

Json in_frame(const Json& scene, const Frame& frame) {
  Json twin = scene;
  const Rewriter rewriter(frame);
  visit(twin, [&](const Place& at) { return rewriter.look(at); });
  mend_reflection(twin, frame);
  return twin;
}

std::string no_twin(const Json& scene, const Frame& frame) {
  if (scene["solver"].contains("imperfection")) return "either sign of an imperfection's mode will do";
  for (const auto& [name, body] : scene["bodies"].items())
    if (body["model"] == "tetrahedra" && body["domain"].contains("refine"))
      return "of two shortest diagonals of a tetrahedron rounding chooses the one along which it is refined";
  if (!frame.turned && !frame.mirrored) return "";
  if (scene.contains("couplings"))
    for (const auto& [name, c] : scene["couplings"].items())
      if (c["kind"] == "weld" && scene["bodies"][c["to"].get<std::string>()]["model"] != "rigid")
        return "a welded node may be as near to another frame";
  if (frame.mirrored && scene.contains("loads"))
    for (const Json& load : scene["loads"]) {
      if (load.contains("total_torque")) return "a torque is spread over triangles, which are cut along one diagonal";
      const bool turns = load.contains("pressure") || load.value("follower", false);
      const std::string body = load.value("body", "");
      if (turns && scene["bodies"].contains(body) && scene["bodies"][body]["model"] == "meshless")
        return "a load that turns with faces is spread over triangles, which are cut along one diagonal";
    }
  for (const auto& [name, body] : scene["bodies"].items()) {
    const Json& domain = body["domain"];
    if (body.contains("frames") && !body["frames"].contains("grid")) return "scattered frames are drawn along the axes";
    if (!frame.mirrored) continue;
    if (body.contains("weights") && body["weights"].value("kind", "") == "linear")
      return "the tetrahedra between frames lie about one diagonal";
    if (domain.contains("file")) continue;  // its cells are mirrored
    if (body["model"] == "tetrahedra") return "tetrahedra are cut along one diagonal";
    if (!domain.contains("box") && !domain.contains("rectangle") && !domain.contains("line") &&
        !(domain.contains("block") && body["model"] == "hexahedra"))
      return "the mesh begins at an axis";
    if ((body["model"] == "rigid" || body["model"] == "surface") && domain.contains("box"))
      return "the skin of a box is cut along one diagonal";
  }
  return "";
}

Json with_texts(const Json& scene) {
  struct Unit {
    const char* name;
    double per_si;
  };
  static const std::map<std::string, Unit> units{{"m", {"mm", 1e3}},
                                                 {"s", {"ms", 1e3}},
                                                 {"kg", {"g", 1e3}},
                                                 {"N", {"kN", 1e-3}},
                                                 {"Pa", {"kPa", 1e-3}},
                                                 {"rad", {"degree", 57.295779513082321}},
                                                 {"N m", {"kN m", 1e-3}},
                                                 {"N/m", {"N/mm", 1e-3}},
                                                 {"m/s", {"mm/s", 1e3}},
                                                 {"m/s2", {"cm/s2", 1e2}},
                                                 {"kg/m3", {"g/cm3", 1e-3}},
                                                 {"1/s", {"1/ms", 1e-3}},
                                                 {"rad/s", {"degree/s", 57.295779513082321}}};
  Json twin = scene;
  visit(twin, [](const Place& at) {
    if (at.shape->type != app::Type::number || !at.value->is_number()) return true;
    const auto found = units.find(at.shape->unit);
    if (found != units.end())
      *at.value = fmt::format("{:.17g} {}", at.value->get<double>() * found->second.per_si, found->second.name);
    return true;
  });
  return twin;
}

Json with_other_solver(const Json& scene) {
  if (scene["solver"].value("kind", "static") == "explicit" || !has_step_solver(scene)) return nullptr;
  const Json& linear = scene["solver"]["linear"];
  const bool direct = !linear.contains("kind") || linear["kind"] != "cg";
  Json twin = scene;
  use_solver(twin, direct);
  return twin;
}

Json with_other_backend(const Json& scene) {
  if (!has_step_solver(scene)) return nullptr;
  Json twin = scene;
  Json& solver = twin["solver"];
  solver["backend"] = "cuda";
  if (solver.value("kind", "static") == "explicit") return twin;
  if (solver["linear"].value("kind", "") != "cg") use_solver(twin, true);
  if (solver["linear"].value("preconditioner", "") == "cholesky") solver["linear"].erase("preconditioner");
  return twin;
}

}  // namespace fascia::random_scenes
