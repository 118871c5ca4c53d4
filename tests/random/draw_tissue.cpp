#include "assembly/actions/actions.hpp"
#include "tests/random/random_scene.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fascia::random_scenes {
namespace {

/// The height along z at which a body's section ends: its middle surface or its upper side.
double top_of(const RowBody& b, const Scales& s) { return (b.thin ? 0.5 : 1) * s.width; }

/// So much longer than wide, or wider than long, that a sheet can begin along it.
bool is_strip(const RowBody& b, const Scales& s) {
  const double length = b.to - b.from;
  return std::max(length, s.width) > 1.25 * std::min(length, s.width);
}

/// The weights of scattered frames.
std::string scattered_weights(Draws& draws) {
  std::string kind = "linear";
  while (kind == "trilinear" || kind == "linear") kind = draws.word("bodies.*.weights.kind");
  return kind;
}

/// Makes the body that fills the space, without its domain.
Json matter(Draws& draws, const Scales& s, const std::string& as, double gap, double young) {
  Json body = Json::object({{"model", "meshless"}});
  if (as == "sheet") body["thickness"] = gap * draws.decades(-1.5, -0.5);
  if (as == "strands") body["radius"] = s.width * draws.decades(-2, -1);
  const int count = draws.whole(8, 20);
  body["frames"] = Json{{"count", count}, {"seed", draws.whole(1, 1000)}};
  if (draws.chance(0.3)) body["frames"]["kind"] = draws.word("bodies.*.frames.kind");
  body["points"]["count"] = count * draws.whole(5, 10);
  if (draws.chance(0.5)) body["weights"]["kind"] = scattered_weights(draws);
  body["density"] = s.density;
  body["material"] = Json{{"young", young}, {"poisson", draws.uniform(0, 0.45)}};
  if (as == "volume") body["material"]["law"] = draws.word("materials.*.law");
  take_own_constants(body["material"]);
  return body;
}

/// A solid or a sheet that lies above a body of the row.
RowBody body_above(Draws& draws, const Scales& s, const RowBody& host, double gap, int index, Json& scene) {
  const auto has_upper_side = [&](const RowBody& b) { return b.solid || is_rectangle(scene["bodies"][b.name]); };
  RowBody above = add_body(draws, s, index, host.from, false, scene);
  while (!has_upper_side(above)) above = add_body(draws, s, index, host.from, false, scene);
  above.lift = top_of(host, s) + gap - (above.thin ? 0.5 * s.width : 0);
  scene["bodies"][above.name]["transform"]["translate"] = Json{0.0, 0.0, above.lift};
  return above;
}

}  // namespace

void add_tissue(Draws& draws, const Scales& s, bool flies, std::vector<RowBody>& row, RandomScene& scene) {
  std::vector<RowBody> hosts;
  for (const RowBody& b : row)
    if (!b.carried && (b.solid || is_rectangle(scene.tree["bodies"][b.name]))) hosts.push_back(b);
  if (hosts.empty()) return;
  const RowBody host = draws.pick(hosts);
  const double gap = s.width * draws.decades(-1.2, 0);
  const RowBody above = body_above(draws, s, host, gap, static_cast<int>(row.size()), scene.tree);
  std::string as = draws.word("bodies.*.domain.as");
  if (as == "sheet" && !(is_strip(host, s) && is_strip(above, s))) as = "volume";

  RowBody tissue{"tissue", host.from, std::min(host.to, above.to), true, false, false, false, false, false, 0};
  tissue.young = std::min(host.young, above.young) * draws.decades(-3, 0);
  tissue.lift = top_of(host, s) + 0.5 * gap - 0.5 * s.width;
  Json body = matter(draws, s, as, gap, tissue.young);
  const bool host_is_longer = host.to > above.to;
  Json& domain = body["domain"];
  domain["between"] = host_is_longer ? Json{above.name, host.name} : Json{host.name, above.name};
  const double far = 1e3 * s.length, low = top_of(host, s) - sliver(s), high = low + gap + 2 * sliver(s);
  domain["where"]["box"] = Json{{"min", {-far, -far, low}}, {"max", {far, far, high}}};
  if (as != "volume" || draws.chance(0.5)) domain["as"] = as;
  scene.tree["bodies"][tissue.name] = std::move(body);
  scene.features.push_back("tissue as " + as);

  scene.scales.stiffest = std::max(scene.scales.stiffest, above.young);
  if (!flies) {
    if (draws.chance(as == "volume" ? 0.3 : 0.8))
      scene.tree["constraints"].push_back(
          Json{{"body", above.name}, {"where", end_of(above, draws.chance(0.5), s)}, {"fix", "all"}});
    add_loads(draws, s, {above}, scene);
  }
  row.push_back(above);
  row.push_back(tissue);
}

}  // namespace fascia::random_scenes
