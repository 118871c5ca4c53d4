#include "app/estimate/resolution.hpp"
#include "app/explain/variants.hpp"
#include "app/scene/laws.hpp"
#include "app/scene/toml_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace fascia::app {
namespace {

/// Frames or cells of a coarser twin along each direction.
constexpr double kCoarser = 0.75;

const char* domain_key(const Scene& scene, const std::string& path) {
  for (const char* key :
       {"box", "block", "cylinder", "ellipsoid", "sphere", "rectangle", "annulus", "line", "between", "file"})
    if (scene.says(path + ".domain." + key)) return key;
  return "";
}

/// Names that which needs the body to be there; empty where nothing does. All that acts on it or measures it goes with
/// it.
std::string needed_by(const Scene& scene, const Body& body) {
  for (const Body& other : scene.bodies) {
    if (const auto* between = std::get_if<BetweenDomain>(&other.domain))
      if (between->bodies[0] == body.name || between->bodies[1] == body.name)
        return fmt::format("`bodies.{}` fills the space beside it", other.name);
    for (const SharedNodes& share : other.shares.value_or(std::vector<SharedNodes>{}))
      if (share.body == body.name) return fmt::format("`bodies.{}` shares its nodes", other.name);
  }
  for (const Coupling& c : scene.couplings)
    if (c.to == body.name) return fmt::format("`couplings.{}` ties `bodies.{}` to it", c.name, c.body);
  const auto& controlled = scene.solver.controlled;
  return controlled && controlled->body == body.name ? "`solver.controlled` prescribes its motion" : "";
}

bool is_of_fluid(Quantity q) { return q == Quantity::fluid_volume || q == Quantity::fluid_pressure; }
bool is_of_strain(Quantity q) { return q == Quantity::strain || q == Quantity::stress; }

/// Makes the changes of one body.
class BodyVariants {
 public:
  BodyVariants(const Scene& scene, const Body& body, const RunFacts& facts)
      : scene_(scene), body_(body), facts_(facts), path_("bodies." + toml_key(body.name)) {}

  std::vector<Variant> all() {
    if (scene_.bodies.size() > 1) left_out();
    if (is_carrier(body_)) return std::move(found_);
    rigid();
    if (is_mesh_model(body_)) formulations();
    if (is_mesh_model(body_) && body_.order == 2)
      add(VariantKind::order, "as `order = 1`", {path_ + ".order=1"}).part += ".order";
    if (body_.affine)
      add(VariantKind::frame_kind, "as `frames.kind = \"rigid\"`", {path_ + ".frames.kind=\"rigid\""}).part +=
          ".frames.kind";
    if (body_.fluid) fluid();
    coarser();
    return std::move(found_);
  }

 private:
  Variant& add(VariantKind kind, std::string change, std::vector<std::string> overrides) {
    found_.push_back({kind, path_, std::move(change), body_.name, std::move(overrides), "", false, 1});
    return found_.back();
  }

  void left_out() {
    Variant& v = add(VariantKind::left_out, fmt::format("without `{}`", path_), {});
    v.refused = needed_by(scene_, body_);
    // From the last to the first: what is taken out of a list moves what stands behind it.
    for (std::size_t i = scene_.constraints.size(); i-- > 0;)
      if (scene_.constraints[i].body == body_.name) v.overrides.push_back(fmt::format("constraints[{}]=", i));
    for (std::size_t i = scene_.loads.size(); i-- > 0;)
      if (scene_.loads[i].body == body_.name) v.overrides.push_back(fmt::format("loads[{}]=", i));
    for (const Coupling& c : scene_.couplings)
      if (c.body == body_.name) v.overrides.push_back(fmt::format("couplings.{}=", toml_key(c.name)));
    remove_probes(v, [](Quantity) { return true; });
    v.overrides.push_back(path_ + "=");
  }

  template <class Chosen>
  void remove_probes(Variant& v, const Chosen& chosen) const {
    for (const Probe& p : scene_.probes)
      if (p.body == body_.name && chosen(p.quantity)) v.overrides.push_back("probes." + toml_key(p.name) + "=");
  }

  void rigid() {
    Variant& v = add(VariantKind::rigid, "as `model = \"rigid\"`", {});
    for (const char* key : {"material", "frames", "points", "weights", "thickness", "radius", "fluid", "formulation",
                            "order", "incompressibility", "locking"})
      if (scene_.says(path_ + "." + key)) v.overrides.push_back(path_ + "." + key + "=");
    v.overrides.push_back(path_ + ".model=\"rigid\"");
    skin(v);
    remove_probes(v, [](Quantity q) { return is_of_strain(q) || is_of_fluid(q); });
    keep_mass(v);
  }

  /// The triangles that a rigid body carries, about as fine as the body's own.
  void skin(Variant& v) const {
    const std::string key = domain_key(scene_, path_), domain = path_ + ".domain." + key;
    const bool round = key == "ellipsoid" || key == "sphere";
    if (scene_.says(domain + ".split")) v.overrides.push_back(domain + ".split=");
    if (body_.model == BodyModel::meshless) {
      const auto* grid = std::get_if<GridFrames>(&body_.frames);
      std::vector<int> cells{24};
      if (key == "cylinder") cells = {12, 24};
      if ((key == "box" || key == "rectangle") && grid != nullptr) {
        cells = grid->count;
        for (int& n : cells) --n;
      } else if (key == "box" || key == "rectangle") {
        cells.assign(key == "box" ? 3 : 2, 8);
      }
      if (key != "file") v.overrides.push_back(fmt::format("{}.cells=[{}]", domain, fmt::join(cells, ", ")));
    } else if (round && is_mesh_model(body_) && body_.cells) {
      v.overrides.push_back(fmt::format("{}.cells=[{}]", domain, body_.cells->count[0]));
    }
  }

  /// A density is that of the matter; of a rigid body it would be that of all that the facets of its surface enclose.
  void keep_mass(Variant& v) const {
    const auto mass = facts_.body_mass.find(body_.name);
    if (!body_.density || mass == facts_.body_mass.end()) return;
    v.overrides.push_back(path_ + ".density=");
    v.overrides.push_back(fmt::format("{}.mass={}", path_, mass->second));
  }

  static std::string viscosity_text(const Viscosity& viscosity) {
    std::vector<std::string> branches;
    for (const ViscousBranch& b : viscosity.branches)
      branches.push_back(fmt::format("{{ share = {}, time = {} }}", b.share, b.time));
    return fmt::format("viscosity = [{}], relax = \"{}\", statics = \"{}\"", fmt::join(branches, ", "),
                       viscosity.shear_only ? "shear" : "all",
                       viscosity.instantaneous_statics ? "instantaneous" : "long-term");
  }

  /// The law that one of large strain becomes where a formulation takes none; empty where that cannot be said in one
  /// line.
  std::vector<std::string> linear_law() const {
    const auto large = [](const MaterialUse& use) { return needs_large_strain(use.material.law); };
    if (std::none_of(body_.materials.begin(), body_.materials.end(), large) || body_.materials.size() != 1) return {};
    const Material& m = body_.materials[0].material;
    if (m.activation) return {};
    std::string text = fmt::format("{}.material={{ young = {}, poisson = {}", path_, m.young(), m.poisson());
    if (m.mass_damping > 0 || m.stiffness_damping > 0)
      text += fmt::format(", damping = {{ mass = {}, stiffness = {} }}", m.mass_damping, m.stiffness_damping);
    if (m.viscosity) text += ", " + viscosity_text(*m.viscosity);
    return {text + " }"};
  }

  void formulations() {
    const std::pair<Formulation, const char*> forms[] = {{Formulation::large_strain, "st-venant-kirchhoff"},
                                                         {Formulation::corotational, "corotational"},
                                                         {Formulation::linear, "linear"}};
    for (const auto& [formulation, name] : forms) {
      if (formulation == body_.formulation) continue;
      std::vector<std::string> overrides;
      if (formulation != Formulation::large_strain) {
        overrides = linear_law();
        if (body_.locking == Locking::f_bar) overrides.push_back(path_ + ".locking=");
      }
      overrides.push_back(fmt::format("{}.formulation=\"{}\"", path_, name));
      Variant& v = add(VariantKind::formulation, fmt::format("as `formulation = \"{}\"`", name), std::move(overrides));
      v.part += ".formulation";
      v.closer = formulation < body_.formulation;
    }
  }

  void fluid() {
    Variant& v = add(VariantKind::fluid, fmt::format("without `{}.fluid`", path_), {});
    v.part += ".fluid";
    remove_probes(v, is_of_fluid);
    v.overrides.push_back(path_ + ".fluid=");
  }

  void coarser() {
    const SceneTwin twin = resized(scene_, kCoarser, body_.name);
    Variant& v = add(VariantKind::coarser, "", twin.overrides);
    v.part += body_.model == BodyModel::meshless ? ".frames" : ".domain";
    if (twin.complete()) {
      v.growth = twin.nodes.at(body_.name);
      // The scene's words: "liver" has ..., where the part names the body already.
      const std::string quoted = "\"" + body_.name + "\" has ";
      const std::string& change = twin.changes.front();
      v.change = "with " + (change.starts_with(quoted) ? change.substr(quoted.size()) : change);
    } else {
      v.change = "coarser";
      v.refused = fmt::format("{}", fmt::join(twin.kept, "; "));
    }
  }

  const Scene& scene_;
  const Body& body_;
  const RunFacts& facts_;
  std::string path_;
  std::vector<Variant> found_;
};

}  // namespace

std::vector<Variant> body_variants(const Scene& scene, const Body& body, const RunFacts& facts) {
  return BodyVariants(scene, body, facts).all();
}

}  // namespace fascia::app
