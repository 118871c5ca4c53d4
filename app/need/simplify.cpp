#include "app/need/simplify.hpp"

#include "app/explain/variants.hpp"
#include "app/scene/diagnostics.hpp"
#include "app/scene/toml_text.hpp"
#include "assembly/specification/readable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

/// The part of the errors that are left which one simplification may take.
constexpr double kPart = 0.8;
/// Less saving than this is lost in what times spread.
constexpr double kSaving = 0.9;
/// Times of two runs differ by this where the machine does something else.
constexpr double kTimesSpread = 1.3;

/// So much of the allowed errors is kept for what may be left out: finer meshes that use less cost more than that
/// saves.
constexpr double kMostRoom = 0.25;
/// On finer meshes it may add this many times as much.
constexpr double kSpread = 1.5;

struct Simplification {
  std::string what;  ///< a clause
  std::vector<std::string> overrides;
  bool same_result = false;  ///< it may change how the result is found, but not the result
};

/// Adds all that may be left out of a body, as `fascia explain` leaves it out: what the scene says stays.
void of_body(const Scene& scene, const Body& body, const RunFacts& facts, std::vector<Simplification>& all) {
  const std::string formulation = "bodies." + toml_key(body.name) + ".formulation";
  const bool small = is_mesh_model(body) && !scene.says(formulation) &&
                     std::all_of(body.materials.begin(), body.materials.end(),
                                 [](const MaterialUse& m) { return m.material.law == Law::st_venant_kirchhoff; });
  const bool solid = body.model == BodyModel::meshless ? body.thickness.empty() && !body.radius : is_mesh_model(body);
  const bool held = scene.bodies.size() > 1 || !scene.couplings.empty();
  const bool whole = solid && held && !body.fluid && !std::holds_alternative<BetweenDomain>(body.domain);
  const std::string linear = formulation + "=\"linear\"";
  for (Variant& v : body_variants(scene, body, facts)) {
    if (!v.refused.empty()) continue;
    if (small && v.kind == VariantKind::formulation && v.overrides.back() == linear)
      all.push_back({in_quotes(body.name) + " is linear, as its displacements are small", std::move(v.overrides)});
    else if (whole && v.kind == VariantKind::rigid)
      all.push_back({in_quotes(body.name) + " is rigid, as it moves as a whole", std::move(v.overrides)});
  }
}

/// All candidates in the scene that a trial ran, in an order that is the same for all of them.
std::vector<Simplification> candidates(const Trials& trials, const Trial& trial) {
  const Scene scene = trials.scene_of(trial.choice);
  RunFacts facts;
  facts.body_mass = trial.body_mass;
  std::vector<Simplification> all;
  for (const Body& body : scene.bodies)
    if (!is_carrier(body)) of_body(scene, body, facts, all);
  if (scene.solver.kind != SolverKind::central_differences && !scene.says("solver.tangent"))
    all.push_back({"the geometric stiffness is left out, as no more iterations are needed without it",
                   {"solver.tangent=\"material\""},
                   true});
  return all;
}

/// Relative changes that a simpler trial makes, by quantity.
std::vector<double> added(const Trial& plain, const Trial& simpler) {
  std::vector<double> more;
  for (std::size_t w = 0; w < plain.values.size(); ++w)
    more.push_back(relative_distance(simpler.values[w], plain.values[w]).value_or(INFINITY));
  return more;
}

/// Errors may grow by this, relative, by quantity. A quantity that the need does not name: by the largest error that it
/// allows, so that nothing which the scene asks for loses its meaning.
std::vector<double> allowances(const Trials& trials) {
  double largest = 0;
  for (const Wanted& w : trials.wanted()) largest = std::max(largest, w.allowed.value_or(0));
  std::vector<double> all;
  for (const Wanted& w : trials.wanted()) all.push_back(w.allowed.value_or(largest));
  return all;
}

/// The largest of errors over what they may be.
double over(const std::vector<double>& errors, const std::vector<double>& most) {
  double ratio = 0;
  for (std::size_t w = 0; w < errors.size(); ++w)
    if (errors[w] > 0) ratio = std::max(ratio, errors[w] / std::max(0.0, most[w]));
  return ratio;
}

NeedChoice with(NeedChoice choice, const Simplification& s) {
  choice.more.insert(choice.more.end(), s.overrides.begin(), s.overrides.end());
  return choice;
}

/// Newton iterations times unknowns: unlike times, they are the same whatever else the machine does.
double work(const Trial& trial) { return std::max(1.0, trial.newton) * trial.dofs; }

/// It saves iterations or unknowns.
bool saves(const Simplification& s, const Trial& plain, const Trial& simpler) {
  return s.same_result ? simpler.newton <= plain.newton : simpler.newton < plain.newton || simpler.dofs < plain.dofs;
}

class Simplifier {
 public:
  Simplifier(Trials& trials, Found& found) : trials_(trials), found_(found) {}

  void run() {
    const Trial* own = trials_.find(found_.choice);
    if (!own || !own->good() || found_.choice.scheme == "explicit") return;
    const Accuracy accuracy(trials_, found_.choice);
    left_ = allowances(trials_);
    for (std::size_t w = 0; w < left_.size(); ++w) {
      if (!trials_.wanted()[w].allowed) continue;
      left_[w] -= accuracy.error(*own, w).value_or(INFINITY);
      if (!found_.time_error.empty()) left_[w] -= found_.time_error[w];
      if (!found_.said_error.empty()) left_[w] -= found_.said_error[w];
    }
    NeedChoice coarse = found_.choice;
    coarse.resolution.level = trials_.open().least(coarse.resolution.family);
    if (coarse.resolution.level > found_.choice.resolution.level) coarse = found_.choice;
    const Trial& plain = trials_.run(coarse);
    if (!plain.good()) return;
    std::vector<bool> promising;
    for (const Simplification& s : candidates(trials_, plain))
      promising.push_back(!trials_.stopped() && promises(s, plain));
    adopt(promising, *own);
  }

 private:
  /// On a coarse mesh it changes little, and saves iterations or unknowns. What is refused there, as facets leave out
  /// what another body holds on to, may do on a finer one.
  bool promises(const Simplification& s, const Trial& plain) {
    const Trial& trial = trials_.run(with(plain.choice, s));
    if (trial.status == "refused") return true;
    if (!trial.good() || over(added(plain, trial), left_) > kPart) return false;
    return saves(s, plain, trial);
  }

  /// One after the other, each where it saves time and what all of them add is still allowed.
  void adopt(const std::vector<bool>& promising, const Trial& own) {
    const Trial* simplest = &own;
    const std::vector<Simplification> all = candidates(trials_, own);
    for (std::size_t i = 0; i < promising.size() && !trials_.stopped(); ++i) {
      if (!promising[i]) continue;
      // A body that became rigid has no formulation: that is refused.
      const Trial& trial = trials_.run(with(simplest->choice, all[i]));
      if (!trial.good() || over(added(own, trial), left_) > 1 || !faster(trial, *simplest)) continue;
      tell(all[i].what, added(*simplest, trial));
      simplest = &trial;
    }
    coarsen(own, simplest);
    if (simplest == &own) return;
    found_.simpler.push_back(fmt::format(
        "without that: {:.0f} unknowns, {:.0f} Newton iterations, {}; with it: {:.0f}, {:.0f}, {}", own.dofs,
        own.newton, time_text(own.seconds), simplest->dofs, simplest->newton, time_text(simplest->seconds)));
    found_.simpler_error = added(own, *simplest);
    found_.judged = found_.choice;
    found_.choice = simplest->choice;
  }

  /// All bodies have one level, which one of them needs: others get fewer cells, as far as their errors leave room.
  void coarsen(const Trial& own, const Trial*& simplest) {
    const OpenScene& open = trials_.open();
    const Resolution& r = own.choice.resolution;
    for (std::size_t b = 0; b < open.bodies.size() && open.bodies.size() > 1; ++b)
      for (const double part : {0.25, 0.5, 0.75}) {
        const int level = static_cast<int>(part * r.level);
        const std::optional<std::string> fewer = level > 0 ? open.numbers({r.family, level}, b) : std::nullopt;
        if (!fewer || trials_.stopped()) continue;
        NeedChoice choice = simplest->choice;
        choice.more.push_back(*fewer);
        const Trial& trial = trials_.run(choice);
        if (!trial.good() || over(added(own, trial), left_) > 1 || work(trial) > kSaving * work(*simplest)) continue;
        tell(fmt::format("`{}`, as the error of {} leaves room", *fewer, in_quotes(open.bodies[b].name)),
             added(*simplest, trial));
        simplest = &trial;
        break;
      }
  }

  static bool faster(const Trial& trial, const Trial& than) {
    if (work(trial) <= kSaving * work(than)) return trial.seconds <= kTimesSpread * std::max(kClearTime, than.seconds);
    return trial.seconds <= kSaving * than.seconds;
  }

  void tell(const std::string& what, const std::vector<double>& more) {
    std::size_t most = 0;
    for (std::size_t w = 0; w < more.size() && trials_.wanted()[w].allowed; ++w)
      if (more[w] > more[most]) most = w;
    found_.simpler.push_back(
        fmt::format("{}: adds {:.2g} % to the error of {}", what, 100 * more[most], trials_.wanted()[most].name));
  }

  Trials& trials_;
  Found& found_;
  std::vector<double> left_;  ///< what errors may still grow by, by quantity
};

}  // namespace

double room_for_simpler(Trials& trials, const NeedChoice& coarse) {
  if (!trials.wanted().front().allowed) return 0;
  const Trial& plain = trials.run(coarse);
  double room = 0;
  if (!plain.good()) return 0;
  for (const Simplification& s : candidates(trials, plain)) {
    if (trials.stopped()) break;
    if (s.same_result) continue;
    const Trial& simpler = trials.run(with(coarse, s));
    if (!simpler.good() || !saves(s, plain, simpler)) continue;
    const double part = kSpread * over(added(plain, simpler), allowances(trials));
    if (room + part <= kMostRoom) room += part;
  }
  return room;
}

void simplify(Trials& trials, Found& found) {
  if (found.met && trials.wanted().front().allowed && !trials.stopped()) Simplifier(trials, found).run();
}

}  // namespace fascia::app
