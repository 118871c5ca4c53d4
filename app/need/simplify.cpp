#include "app/need/simplify.hpp"

#include "app/readable.hpp"
#include "app/scene/diagnostics.hpp"
#include "app/scene/toml_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

/// The part of the errors that are left which one simplification may take.
constexpr double kPart = 0.5;
/// Less saving than this is lost in what times spread.
constexpr double kSaving = 0.9;

struct Simplification {
  std::string what;  ///< a clause
  std::vector<std::string> overrides;
  bool same_result = false;  ///< it may change how the result is found, but not the result
};

/// Keys of a body that a rigid one does not take.
std::vector<std::string> made_rigid(const Scene& scene, const Body& body, const OpenBody* open) {
  const std::string path = "bodies." + toml_key(body.name);
  std::vector<std::string> changes{path + ".model=\"rigid\""};
  const auto chosen = [&](const std::string& key) {  // by the overrides of an open body
    if (!open) return false;
    const bool frames = open->key.starts_with(path + "." + key);
    const bool family = std::any_of(open->families.begin(), open->families.end(), [&](const Family& f) {
      return std::any_of(f.overrides.begin(), f.overrides.end(),
                         [&](const std::string& o) { return o.starts_with(path + "." + key); });
    });
    return frames || family;
  };
  for (const char* key :
       {"material", "frames", "points", "weights", "formulation", "order", "incompressibility", "locking"})
    if (scene.says(path + "." + key) || chosen(key)) changes.push_back(path + "." + key + "=");
  return changes;
}

std::vector<Simplification> candidates(const Scene& scene, const OpenScene& open) {
  std::vector<Simplification> all;
  const auto deformable =
      std::count_if(scene.bodies.begin(), scene.bodies.end(), [](const Body& b) { return !is_carrier(b); });
  for (const Body& body : scene.bodies) {
    const std::string path = "bodies." + toml_key(body.name);
    if (is_mesh_model(body) && !scene.says(path + ".formulation") &&
        std::all_of(body.materials.begin(), body.materials.end(),
                    [](const MaterialUse& m) { return m.material.law == MaterialLaw::st_venant_kirchhoff; }))
      all.push_back(
          {in_quotes(body.name) + " is linear, as its displacements are small", {path + ".formulation=\"linear\""}});
    const bool takes_rigid =
        body.model == BodyModel::meshless ? body.thickness.empty() && !body.radius : is_mesh_model(body);
    if (deformable < 2 || !takes_rigid || body.fluid || std::holds_alternative<BetweenDomain>(body.domain)) continue;
    const auto part =
        std::find_if(open.bodies.begin(), open.bodies.end(), [&](const OpenBody& b) { return b.name == body.name; });
    all.push_back({in_quotes(body.name) + " is rigid, as it moves as a whole",
                   made_rigid(scene, body, part == open.bodies.end() ? nullptr : &*part)});
  }
  if (scene.solver.kind != SolverKind::central_differences && !scene.says("solver.tangent"))
    all.push_back({"the geometric stiffness is left out, as no more iterations are needed without it",
                   {"solver.tangent=\"material\""},
                   true});
  return all;
}

class Simplifier {
 public:
  Simplifier(Trials& trials, Found& found) : trials_(trials), found_(found) {}

  void run() {
    const Trial* own = trials_.find(found_.choice);
    if (!own || !own->good() || found_.choice.scheme == "explicit") return;
    const std::optional<double> used = Accuracy(trials_, found_.choice).ratio(*own);
    if (!used) return;
    left_ = 1 - *used - time_used();
    NeedChoice coarse = found_.choice;
    coarse.resolution.level = trials_.open().least(coarse.resolution.family);
    if (coarse.resolution.level > found_.choice.resolution.level) coarse = found_.choice;
    const Trial& plain = trials_.run(coarse);
    if (!plain.good() || !(left_ > 0)) return;
    std::vector<Simplification> kept;
    for (const Simplification& s : candidates(trials_.scene(), trials_.open()))
      if (!trials_.stopped() && promises(s, plain)) kept.push_back(s);
    if (!kept.empty() && !trials_.stopped()) adopt(kept, *own);
  }

 private:
  double time_used() const {
    double most = 0;
    for (std::size_t w = 0; w < found_.time_error.size(); ++w)
      if (const auto& allowed = trials_.wanted()[w].allowed) most = std::max(most, found_.time_error[w] / *allowed);
    return most;
  }

  std::vector<double> added(const Trial& plain, const Trial& simpler) const {
    std::vector<double> more;
    for (std::size_t w = 0; w < plain.values.size(); ++w)
      more.push_back(relative_distance(simpler.values[w], plain.values[w]).value_or(0));
    return more;
  }
  double over_allowed(const std::vector<double>& more) const {
    double most = 0;
    for (std::size_t w = 0; w < more.size(); ++w)
      if (const auto& allowed = trials_.wanted()[w].allowed) most = std::max(most, more[w] / *allowed);
    return most;
  }

  static NeedChoice with(NeedChoice choice, const Simplification& s) {
    choice.more.insert(choice.more.end(), s.overrides.begin(), s.overrides.end());
    return choice;
  }

  /// On a coarse mesh it changes little, and saves iterations or unknowns.
  bool promises(const Simplification& s, const Trial& plain) {
    const Trial& trial = trials_.run(with(plain.choice, s));
    if (!trial.good() || over_allowed(added(plain, trial)) > kPart * left_) return false;
    return s.same_result ? trial.newton <= plain.newton : trial.newton < plain.newton || trial.dofs < plain.dofs;
  }

  void adopt(const std::vector<Simplification>& kept, const Trial& own) {
    NeedChoice choice = own.choice;
    for (const Simplification& s : kept) choice = with(choice, s);
    const Trial& trial = trials_.run(choice);
    if (!trial.good()) return;
    const std::vector<double> more = added(own, trial);
    if (over_allowed(more) > left_ || trial.seconds > kSaving * own.seconds) return;
    for (const Simplification& s : kept) {
      const Trial* alone = trials_.find(with(own.choice, s));
      if (!alone) alone = &trials_.run(with(own.choice, s));
      const std::vector<double> single = alone->good() ? added(own, *alone) : more;
      std::size_t most = 0;
      for (std::size_t w = 0; w < single.size() && trials_.wanted()[w].allowed; ++w)
        if (single[w] > single[most]) most = w;
      found_.simpler.push_back(
          fmt::format("{}: adds {:.2g} % to the error of {}", s.what, 100 * single[most], trials_.wanted()[most].name));
    }
    found_.simpler.push_back(
        fmt::format("that saves {} of {}", time_text(own.seconds - trial.seconds), time_text(own.seconds)));
    found_.simpler_error = more;
    found_.judged = found_.choice;
    found_.choice = choice;
  }

  Trials& trials_;
  Found& found_;
  double left_ = 0;  ///< of what is allowed
};

}  // namespace

void simplify(Trials& trials, Found& found) {
  if (found.met && trials.wanted().front().allowed && !trials.stopped()) Simplifier(trials, found).run();
}

}  // namespace fascia::app
