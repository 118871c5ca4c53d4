#include "assembly/actions/actions.hpp"
#include "tests/random/random_scene.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fascia::random_scenes {

void add_schedule(Draws& draws, const Json& scene, Json& entry) {
  if (!scene["solver"].contains("time_step") || draws.chance(0.5)) return;
  const double step = scene["solver"]["time_step"];
  const int kind = draws.whole(0, 3);
  if (kind == 0) entry["profile"] = Json{{0.0, 0.0}, {step, 0.5}, {3 * step, 1.0}};
  if (kind == 1) entry["profile"] = Json::object({{"sine", {{"period", 7 * step}}}});
  if (kind >= 2) entry["over"] = 3 * step;
  if (kind == 3) entry["profile"] = "smooth";
}

namespace {

Json motion(Draws& draws, const Scales& s, const RowBody& b) {
  Json move;
  const double size = draws.decades(-8, -0.8);
  if (draws.chance(0.6)) {
    move["translate"] = draws.directed(size * s.width);
  } else {
    const Vector axis = draws.directed(1);
    move["rotate"] = Json{{"axis", axis}, {"angle", 3 * size}, {"center", {b.to, 0.5 * s.width, 0.5 * s.width}}};
  }
  return move;
}

}  // namespace

void add_couplings(Draws& draws, const Scales& s, std::vector<RowBody>& row, Json& scene) {
  for (std::size_t i = 1; i < row.size(); ++i) {
    const RowBody &host = row[i - 1], &body = row[i];
    const std::string name = fmt::format("c{}", i);
    std::string kind = body.carried ? "embed" : draws.word("couplings.*.kind");
    const Json &of_host = scene["bodies"][host.name], &of_body = scene["bodies"][body.name];
    const bool fits = host.solid || (body.thin && of_host["domain"].begin().key() == of_body["domain"].begin().key());
    const bool hinged =
        body.thin && !of_host.contains("frames") && !host.stiff && !scene["solver"].contains("time_step");
    row[i].alone = !body.carried && (!fits || draws.chance(hinged ? 0.95 : 0.15));
    if (row[i].alone) continue;
    const bool shares = of_body.contains("frames") && draws.chance(0.4);
    const auto is_affine = [](const Json& b) { return b.contains("frames") && b["frames"]["kind"] == "affine"; };
    if (kind == "spring" || (!of_host.contains("frames") && !host.stiff && of_host["model"] != "shell")) kind = "embed";
    if (is_affine(of_host) || is_affine(of_body)) kind = "embed";
    if (shares) {
      scene["bodies"][body.name]["frames"]["share"] =
          Json::array({Json{{"body", host.name}, {"where", end_of(body, false, s)}}});
    } else if (body.stiff) {  // what touches it follows it
      scene["couplings"][name] =
          Json{{"kind", "weld"}, {"body", host.name}, {"where", end_of(host, true, s)}, {"to", body.name}};
    } else {
      if (host.stiff) kind = "weld";
      Json where = end_of(body, false, s);
      if (body.carried) {  // a skin in its host
        Json& box = scene["bodies"][body.name]["domain"]["box"];
        const double inside = 0.2 * s.width;
        box = Json{{"min", {host.from, inside, inside}}, {"max", {host.to, s.width - inside, s.width - inside}}};
        row[i].from = host.from, row[i].to = host.to;
        where = "all";
      }
      scene["couplings"][name] = Json{{"kind", kind}, {"body", body.name}, {"where", where}, {"to", host.name}};
    }
  }
  if (draws.chance(0.2)) {
    const RowBody& body = draws.pick(row);
    Json spring{{"kind", "spring"}, {"body", body.name}, {"where", end_of(body, true, s)}};
    spring["point"] = Json{body.to + s.length, 0.3 * s.width, 0.0};
    spring["stiffness"] = body.young * s.width * draws.decades(-4, 1);
    if (draws.chance(0.5)) spring["direction"] = draws.directed(1);
    if (!body.carried) scene["couplings"]["tie"] = spring;
  }
}

void add_constraints(Draws& draws, const Scales& s, const std::vector<RowBody>& row, Json& scene) {
  const bool statics = !scene["solver"].contains("time_step") && scene["solver"].value("kind", "static") == "static";
  Json& all = scene["constraints"];
  all = Json::array();
  for (const RowBody& b : row) {
    if (&b != &row[0] && !b.alone) continue;
    if (!draws.chance(statics ? 0.97 : 0.6)) continue;
    Json held{{"body", b.name}, {"where", end_of(b, false, s)}};
    if (draws.chance(statics ? 0.95 : 0.75)) {
      held["fix"] = "all";
    } else {
      held["fix"] = draws.word("constraints.*.fix");
      if (scene["bodies"][b.name]["model"] == "tetrahedra" || scene["bodies"][b.name]["model"] == "hexahedra")
        held["fix"] = draws.pick<std::string>({"position", "symmetry"});
      if (held["fix"] == "symmetry") held["normal"] = draws.directed(1);
      if (held["fix"] == "hinge") held["axis"] = draws.directed(1);
    }
    all.push_back(held);
  }
  const RowBody& last = row.back();
  if (!last.carried && draws.chance(0.25)) {
    Json held{{"body", last.name}, {"where", end_of(last, true, s)}};
    if (draws.chance(0.3)) {
      held["fix"] =
          draws.pick<std::vector<std::string>>({{"y"}, {"x", "z"}, {"y", "rx"}, {"x", "y", "z", "rx", "ry", "rz"}});
      if (draws.chance(0.3)) held["axes"] = Json{{0.6, 0.8, 0.0}, {-0.8, 0.6, 0.0}, {0.0, 0.0, 1.0}};
    } else {
      held["move"] = motion(draws, s, last);
      add_schedule(draws, scene, held);
    }
    all.push_back(held);
  }
  if (all.empty()) scene.erase("constraints");
}

namespace {

class LoadDrawing {
 public:
  LoadDrawing(Draws& draws, const Scales& scales, RandomScene& scene) : draws_(draws), s_(scales), scene_(scene) {}

  void add(const RowBody& b) {
    Json load = Json::object({{"body", b.name}});
    const double young = std::min(b.young, s_.young) / s_.young;
    const double part = draws_.chance(0.85) ? draws_.decades(-9, -1) : draws_.decades(-1, 1.5);
    const double force = young * s_.force() * part * (b.thin ? 1e-2 : 1), arm = s_.width;
    std::optional<Vector> resultant;
    const Vector along = draws_.directed(force);
    const bool follows = draws_.chance(0.15);
    const auto scaled = [&](double by) { return Vector{along[0] * by, along[1] * by, along[2] * by}; };
    const int kind = draws_.whole(0, 7);
    if (kind == 0 || kind == 3) {
      load["where"] = end_of(b, true, s_);
      load["total_force"] = along;
      if (!follows) resultant = along;
    } else if (kind == 1) {
      load["where"] = draws_.chance(0.5) ? end_of(b, true, s_) : Json("all");
      load["total_torque"] = scaled(arm);
      if (!follows) resultant = Vector{};  // else its forces turn each by another angle
    } else if (kind == 2) {
      load["at"] = place(b);
      load["force"] = along;
      if (!follows) resultant = along;
    } else if (kind == 4) {
      load["at"] = place(b);
      load["torque"] = scaled(arm);
      resultant = Vector{};
    } else if (kind == 5 && b.solid) {
      load["where"] = end_of(b, true, s_);
      load["traction"] = scaled(1 / (s_.width * s_.width));
      resultant = scaled(b.carried ? 0.36 : 1);  // a skin's end is smaller
    } else if (kind == 6 && b.has_boundary) {
      const bool everywhere = draws_.chance(0.5);
      load["where"] = everywhere ? Json::object({{"boundary", true}}) : end_of(b, true, s_);
      load["pressure"] = (draws_.chance(0.5) ? 1 : -1) * force / (s_.width * s_.width);
      if (everywhere) resultant = Vector{};
    } else if (kind == 7 && scene_.tree["bodies"][b.name]["domain"].contains("rectangle")) {
      load["where"] = end_of(b, true, s_);
      load["line_force"] = scaled(1 / s_.width);
    } else {
      load["where"] = end_of(b, true, s_);
      load["force_per_node"] = scaled(0.1);
    }
    if (follows && !load.contains("traction") && kind < 7) load["follower"] = true;
    scene_.load_size += 10 * force;  // ten nodes, or six faces
    add_schedule(draws_, scene_.tree, load);
    scene_.tree["loads"].push_back(load);
    scene_.resultants.push_back(resultant);
  }

 private:
  /// Within a face of a cell: between cells a torque acts on one of them.
  Json place(const RowBody& b) {
    return Json{b.to, (b.thin ? 0.5 : 0.44) * s_.width, b.lift + (b.thin ? 0.5 : 0.29) * s_.width};
  }

  Draws& draws_;
  const Scales& s_;
  RandomScene& scene_;
};

}  // namespace

void add_loads(Draws& draws, const Scales& s, const std::vector<RowBody>& row, RandomScene& scene) {
  LoadDrawing drawing(draws, s, scene);
  const int count = draws.pick<int>({0, 1, 1, 1, 2, 3});
  for (int i = 0; i < count; ++i) drawing.add(draws.pick(row));
  if (draws.chance(0.35)) add_gravity(draws, s, scene.tree);
}

void add_gravity(Draws& draws, const Scales& s, Json& scene) {
  const double part = draws.chance(0.9) ? draws.decades(-8, -1.5) : draws.decades(-1.5, 1);
  const double slender = s.width / s.length;
  scene["world"]["gravity"] = draws.directed(part * s.young * slender * slender / (s.density * s.length));
}

}  // namespace fascia::random_scenes
