#include "tests/random/random_scene.hpp"

#include <fmt/format.h>

namespace fascia::random_scenes {
namespace {

bool is_grid(const std::string& weights) { return weights == "trilinear" || weights == "linear"; }

class BodyDrawing {
 public:
  BodyDrawing(Draws& draws, const Scales& scales, Json& scene) : draws_(draws), s_(scales), scene_(scene) {}

  RowBody add(int index, double from, bool on_solid) {
    const double length = s_.length * (index == 0 ? 1 : draws_.uniform(0.3, 1.2));
    RowBody row{fmt::format("b{}", index), from, from + length, false, false, false, false, false, false, s_.young};
    if (index > 0) row.young *= draws_.chance(0.5) ? 1 : draws_.decades(-4, 4);
    std::string model = draws_.word("bodies.*.model");
    while ((index == 0 && model == "rigid") || (!on_solid && model == "surface")) model = draws_.word("bodies.*.model");
    Json body = Json::object({{"model", model}});
    row.stiff = model == "rigid", row.carried = model == "surface";
    if (model == "meshless")
      meshless(body, row);
    else if (model == "shell")
      shell(body, row);
    else
      solid(body, row);
    if (!row.carried) body[draws_.chance(0.9) ? "density" : "mass"] = s_.density;
    if (body.contains("mass")) body["mass"] = s_.density * length * s_.width * s_.width;
    if (!row.carried && !row.stiff) body["material"] = material(body, row);
    const bool dynamic = scene_["solver"].contains("time_step");
    if (dynamic && !row.carried && draws_.chance(0.5)) body["initial"] = initial(row);
    scene_["bodies"][row.name] = std::move(body);
    return row;
  }

 private:
  Json box(const RowBody& row) const {
    return Json{{"min", {row.from, 0.0, 0.0}}, {"max", {row.to, s_.width, s_.width}}};
  }
  Json cells(int most) { return Json{draws_.whole(1, most + 1), draws_.whole(1, most), draws_.whole(1, most)}; }

  /// In the middle of the row's section.
  Json rectangle(const RowBody& row) const {
    return Json{{"origin", {row.from, 0.0, 0.5 * s_.width}},
                {"edge_u", {row.to - row.from, 0.0, 0.0}},
                {"edge_v", {0.0, s_.width, 0.0}}};
  }

  void meshless(Json& body, RowBody& row) {
    const std::string weights = draws_.word("bodies.*.weights.kind");
    const int shape = weights == "linear" ? 0 : draws_.whole(0, 3);
    row.thin = shape >= 2, row.solid = row.has_boundary = shape < 2;
    Json grid = Json::array({draws_.whole(2, 4), draws_.whole(2, 3), draws_.whole(2, 3)});
    if (shape < 2) {
      body["domain"]["box"] = box(row);
    } else if (shape == 2) {
      body["domain"]["rectangle"] = rectangle(row);
      body["thickness"] = s_.width * draws_.decades(-3, -0.7);
      grid = Json::array({draws_.whole(3, 5), draws_.whole(2, 4)});
    } else {
      body["domain"]["line"] =
          Json{{"from", {row.from, 0.5 * s_.width, 0.5 * s_.width}}, {"to", {row.to, 0.5 * s_.width, 0.5 * s_.width}}};
      body["radius"] = s_.width * draws_.decades(-2, -0.5);
      grid = Json::array({draws_.whole(3, 8)});
    }
    if (is_grid(weights)) {
      body["frames"]["grid"] = grid;
    } else {
      const int count = draws_.whole(shape < 2 ? 12 : 6, shape < 2 ? 24 : 12);
      body["frames"]["count"] = count;
      if (draws_.chance(0.9)) body["points"]["count"] = count * draws_.whole(5, 8);
      body["frames"]["seed"] = draws_.whole(1, 1000);
    }
    body["frames"]["kind"] = draws_.word("bodies.*.frames.kind");
    body["weights"]["kind"] = weights;
    if (draws_.chance(0.15) && shape < 2 && weights == "trilinear")
      body["points"]["integration"] = draws_.word("bodies.*.points.integration");
    if (draws_.chance(0.15)) body["weights"]["drilling"] = draws_.decades(-4, 0);
    if (draws_.chance(0.1))
      body["weights"]["blend"] = weights == "mls" ? draws_.word("bodies.*.weights.blend") : "auto";
  }

  void shell(Json& body, RowBody& row) {
    row.thin = true;
    if (draws_.chance(0.75)) {
      body["domain"]["rectangle"] = rectangle(row);
      body["domain"]["rectangle"]["cells"] = Json{draws_.whole(2, 4), draws_.whole(1, 3)};
      body["domain"]["rectangle"]["diagonal"] = draws_.word("bodies.*.domain.rectangle.diagonal");
    } else {
      body["domain"]["cylinder"] = Json{{"from", {row.from, 0.5 * s_.width, 0.5 * s_.width}},
                                        {"to", {row.to, 0.5 * s_.width, 0.5 * s_.width}},
                                        {"radius", 0.5 * s_.width},
                                        {"cells", {draws_.whole(1, 3), 4 * draws_.whole(1, 2)}}};
    }
    body["thickness"] = s_.width * draws_.decades(-3, -0.7);
  }

  void solid(Json& body, RowBody& row) {
    const std::string model = body["model"];
    row.solid = row.has_boundary = true;
    if (model == "hexahedra" && draws_.chance(0.15)) {
      const double w = s_.width, taper = draws_.uniform(0.5, 1) * w;
      body["domain"]["block"]["corners"] =
          Json{{row.from, 0.0, 0.0}, {row.to, 0.0, 0.0}, {row.to, taper, 0.0}, {row.from, w, 0.0},
               {row.from, 0.0, w},   {row.to, 0.0, w},   {row.to, taper, w},   {row.from, w, w}};
      body["domain"]["block"]["cells"] = cells(2);
      row.solid = false;
    } else {
      body["domain"]["box"] = box(row);
      if (!row.stiff) body["domain"]["box"]["cells"] = cells(model == "hexahedra" ? 2 : 1);
    }
    if (row.stiff || row.carried) return;
    body["order"] = draws_.whole(1, 2);
    body["formulation"] = draws_.word("bodies.*.formulation");
    if (model == "tetrahedra" && draws_.chance(0.3) && body["domain"].contains("box"))
      body["domain"]["box"]["split"] = draws_.whole(5, 6);
    if (model == "tetrahedra" && draws_.chance(0.2) && body["order"] == 1 &&
        body["formulation"] == "st-venant-kirchhoff")
      body["locking"] = draws_.word("bodies.*.locking");
    if (model == "tetrahedra" && draws_.chance(0.1)) body["incompressibility"] = row.young * draws_.decades(-2, 1);
  }

  Json material(const Json& body, const RowBody& row) {
    Json material;
    const std::string law = draws_.word("materials.*.law");
    const bool large = body.value("formulation", "st-venant-kirchhoff") == "st-venant-kirchhoff";
    if (law == "st-venant-kirchhoff" || (large && !row.thin)) material["law"] = law;
    material["young"] = row.young;
    const int kind = draws_.whole(0, 5);
    material["poisson"] = kind == 0   ? 0.0
                          : kind == 1 ? 0.5 - draws_.decades(-4, -1)
                          : kind == 2 ? -draws_.uniform(0, 0.5)
                                      : draws_.uniform(0, 0.45);
    if (draws_.chance(0.1)) {
      const double nu = material["poisson"], mu = row.young / (2 * (1 + nu));
      material.erase("young"), material.erase("poisson");
      material["lame"] = Json{{"lambda", 2 * mu * nu / (1 - 2 * nu)}, {"mu", mu}};
    }
    if (draws_.chance(0.2)) material["damping"]["mass"] = draws_.decades(-3, 0) / s_.time();
    if (draws_.chance(0.2)) material["damping"]["stiffness"] = draws_.decades(-4, -1) * s_.time();
    take_own_constants(material);
    return material;
  }

  Json initial(const RowBody& row) {
    const double speed = draws_.decades(-6, -0.5) * s_.length / s_.time();
    Json motion = Json::object({{"velocity", draws_.directed(speed)}});
    if (draws_.chance(0.5)) {
      motion["angular_velocity"] = draws_.directed(speed / s_.length);
      if (draws_.chance(0.3)) motion["about"] = Json{row.from, 0.0, s_.width};
    }
    return motion;
  }

  Draws& draws_;
  const Scales& s_;
  Json& scene_;
};

}  // namespace

RowBody add_body(Draws& draws, const Scales& scales, int index, double from, bool on_solid, Json& scene) {
  return BodyDrawing(draws, scales, scene).add(index, from, on_solid);
}

std::vector<RowBody> add_bodies(Draws& draws, const Scales& scales, Json& scene) {
  std::vector<RowBody> row;
  const int count = draws.chance(0.5) ? 1 : draws.whole(2, 3);
  for (int i = 0; i < count; ++i)
    row.push_back(add_body(draws, scales, i, row.empty() ? 0.0 : row.back().to,
                           !row.empty() && row.back().solid && !row.back().stiff, scene));
  return row;
}

/// Without draws: what else a seed makes does not depend on the law.
void take_own_constants(Json& material) {
  if (material.value("law", "") != "mooney-rivlin") return;
  double mu = 0, lambda = 0;
  if (material.contains("lame")) {
    mu = material["lame"]["mu"], lambda = material["lame"]["lambda"];
  } else {
    const double young = material["young"], nu = material["poisson"];
    mu = young / (2 * (1 + nu)), lambda = 2 * mu * nu / (1 - 2 * nu);
  }
  for (const char* key : {"young", "poisson", "lame"}) material.erase(key);
  material["c10"] = 0.3 * mu;
  material["c01"] = 0.2 * mu;
  material["c20"] = 0.1 * mu;
  material["c02"] = 0.05 * mu;
  material["bulk"] = lambda + 2 * mu / 3;
}

void take_moduli(Json& material) {
  if (material.contains("c10")) {
    const double mu = 2 * (material["c10"].get<double>() + material["c01"].get<double>()), bulk = material["bulk"];
    for (const char* key : {"c10", "c01", "c20", "c02", "bulk"}) material.erase(key);
    material["young"] = 9 * bulk * mu / (3 * bulk + mu);
    material["poisson"] = (3 * bulk - 2 * mu) / (2 * (3 * bulk + mu));
  }
  material.erase("law");
}

}  // namespace fascia::random_scenes
