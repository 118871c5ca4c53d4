#include "app/need/search.hpp"

#include "app/need/shape_cells.hpp"
#include "assembly/specification/readable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

constexpr int kMostLevel = 256;
/// A limit whose uncertainty is above this part of what is allowed cannot tell good trials from bad ones.
constexpr double kMostDoubt = 0.5;
/// A third level makes a family surer by about this, beside that it is finer.
constexpr double kMeasuring = 0.25;
/// Memory of the program itself, which does not grow with the scene [bytes].
constexpr double kProgramMemory = 40e6;

class Search {
 public:
  Search(Trials& trials, const NeedChoice& like, const SearchLimits& limits)
      : trials_(trials), like_(like), limits_(limits), accuracy_(trials, like) {
    for (const Wanted& w : trials.wanted()) has_error_ = has_error_ || w.allowed.has_value();
  }

  Found found() {
    begin();
    while (!trials_.stopped()) {
      if (levels() == 0) return {like_, false, "no trial gave a result: " + failure_};
      const std::optional<Resolution> next = has_error_ ? next_of_error() : next_of_limits();
      if (!next || made_ >= (has_error_ ? 1 : 2) * limits_.trials) break;
      run(*next);
    }
    tell_errors();
    return best();
  }

 private:
  void run(const Resolution& r) {
    NeedChoice choice = like_;
    choice.resolution = r;
    const bool before = trials_.find(choice) != nullptr;
    const Trial& trial = trials_.run(choice);
    if (!before) ++made_;
    accuracy_ = Accuracy(trials_, like_);
    if (!trial.good()) {
      failed_.push_back(r);
      failure_ = trial.message;
    }
    if (before) return;
    const std::optional<double> ratio = trial.good() ? accuracy_.ratio(trial) : std::nullopt;
    trials_.tell(fmt::format(
        "need: {}: {}{}", trials_.text(choice),
        trial.good() ? fmt::format("{:.0f} unknowns, {}", trial.dofs, time_text(trial.seconds))
                     : trial.status + ": " + trial.message,
        ratio && has_error_ ? fmt::format(", estimated error {:.2g} of what is allowed", *ratio / limits_.share) : ""));
  }

  std::size_t levels() const {
    std::size_t count = 0;
    for (int f = 0; f < trials_.open().families(); ++f) count += accuracy_.levels(f).size();
    return count;
  }

  /// The two coarsest levels of each family; coarser ones than are worth a try tell the order too. Where a coarse mesh
  /// is refused (a probe lies outside its facets), finer ones are not.
  void begin() {
    const OpenScene& open = trials_.open();
    constexpr int most = 4;  // times as fine
    for (int f = 0; f < open.families() && !trials_.stopped(); ++f) {
      const int least = open.least(f);
      int level = least;
      run({f, level});
      while (failed({f, level}) && 2 * level <= most * least && open.offers({f, 2 * level})) run({f, level *= 2});
      if (const Trial* t = tried({f, level}); t && (has_error_ || beyond({f, level}).empty()))
        shape_cells(trials_, t->choice);
      run({f, level});
      if (const Resolution second{f, 2 * level};
          has_error_ && !trials_.stopped() && open.takes(second) && beyond(second).empty())
        run(second);
    }
  }

  /// One level alone says nothing of its error: where no other was within the limits, one beyond them tells it.
  void tell_errors() {
    const OpenScene& open = trials_.open();
    for (int f = 0; f < open.families() && !has_error_ && !trials_.stopped(); ++f)
      if (const Resolution second{f, 2 * open.least(f)}; accuracy_.levels(f).size() == 1 && open.takes(second))
        run(second);
  }

  bool failed(const Resolution& r) const { return std::find(failed_.begin(), failed_.end(), r) != failed_.end(); }
  const Trial* tried(const Resolution& r) const {
    NeedChoice choice = like_;
    choice.resolution = r;
    const Trial* trial = trials_.find(choice);
    return trial && trial->good() ? trial : nullptr;
  }

  Prediction cost(const Resolution& r) const {
    if (const Trial* t = tried(r)) return {t->seconds, t->step, t->memory};
    return predicted_cost(trials_, accuracy_, r).value_or(Prediction{INFINITY, INFINITY, INFINITY});
  }
  /// Why a resolution is beyond the limits, a clause; empty where it is not.
  std::string beyond(const Resolution& r) const {
    const Prediction p = cost(r);
    if (p.memory > limits_.memory)
      return fmt::format("{} would take {:.2g} GB of memory", trials_.open().text(r), p.memory / 1e9);
    if (p.step * kStepSpread > limits_.step)
      return fmt::format("a step of {} takes {}", trials_.open().text(r), time_text(p.step));
    if (p.seconds > limits_.seconds)
      return fmt::format("{} would take {}", trials_.open().text(r), time_text(p.seconds));
    return "";
  }

  double ratio(const Resolution& r) const {
    const Trial* t = tried(r);
    return (t ? accuracy_.ratio(*t) : accuracy_.predicted(r)).value_or(INFINITY) / limits_.share;
  }

  /// The coarsest level of a family that is, or will probably be, good enough.
  std::optional<Resolution> enough(int family) const {
    for (int level = 1; level <= kMostLevel; ++level) {
      const Resolution r{family, level};
      if (trials_.open().offers(r) && !failed(r) && ratio(r) <= 1) return r;
    }
    return std::nullopt;
  }

  /// The next finer level of a family than those that were tried.
  std::optional<Resolution> finer(int family) const {
    int level = 1;
    for (const Trial* t : accuracy_.levels(family)) level = std::max(level, t->choice.resolution.level);
    const int by = std::max(1, level / 2);
    for (int next = level + by; next <= 4 * level; ++next) {
      const Resolution r{family, next};
      if (trials_.open().takes(r)) return failed(r) ? std::nullopt : std::optional(r);
    }
    return std::nullopt;
  }

  /// The finer level that will make the limits sure enough at the least cost; else the one that does most for its cost.
  std::optional<Resolution> clearer() {
    std::optional<Resolution> next;
    double least = INFINITY;
    for (int f = 0; f < trials_.open().families(); ++f) {
      const std::optional<Resolution> r = finer(f);
      if (!r) continue;
      if (const std::string why = beyond(*r); !why.empty()) {
        why_not_ = why;
        continue;
      }
      const std::size_t levels = accuracy_.levels(f).size();
      const int finest = accuracy_.levels(f).back()->choice.resolution.level;
      const double measured = levels == 2 ? kMeasuring : 1;
      const double left = measured * accuracy_.doubt(f) * std::pow(1.0 * finest / r->level, trials_.open().order(f));
      const double price =
          cost(*r).seconds * std::max(1.0, std::isfinite(left) ? left / (kMostDoubt * limits_.share) : 1e3);
      if (price < least) next = r, least = price;
    }
    return next;
  }

  std::optional<Resolution> next_of_error() {
    std::optional<Resolution> cheapest;
    why_not_.clear();
    for (int f = 0; f < trials_.open().families(); ++f) {
      const std::optional<Resolution> r = enough(f);
      if (!r) continue;
      if (const std::string why = beyond(*r); !why.empty()) {
        why_not_ = why;
        continue;
      }
      if (!cheapest || cost(*r).seconds < cost(*cheapest).seconds) cheapest = r;
    }
    const bool sure = accuracy_.doubt() <= kMostDoubt * limits_.share && accuracy_.confirmed();
    if (sure && cheapest) return tried(*cheapest) ? std::nullopt : cheapest;
    if (sure) return std::nullopt;
    const std::optional<Resolution> next = clearer();
    return next || !cheapest || tried(*cheapest) ? next : cheapest;
  }

  /// Without an allowed error: finer and finer until a level is beyond the limits, then between the last two.
  std::optional<Resolution> next_of_limits() const {
    std::optional<Resolution> next;
    double least = INFINITY;
    for (int f = 0; f < trials_.open().families(); ++f) {
      const std::optional<Resolution> r = finer_within(f);
      if (!r || cost(*r).seconds >= least) continue;
      next = r;
      least = cost(*r).seconds;
    }
    return next;
  }

  std::optional<Resolution> finer_within(int family) const {
    int within = 0, above = kMostLevel + 1;
    for (const Trial* t : accuracy_.levels(family)) {
      const int level = t->choice.resolution.level;
      if (beyond(t->choice.resolution).empty())
        within = std::max(within, level);
      else
        above = std::min(above, level);
    }
    for (const Resolution& r : failed_)
      if (r.family == family && r.level > within) above = std::min(above, r.level);
    if (within == 0) return std::nullopt;
    const int wanted = above > kMostLevel ? within + std::max(1, within / 2) : (within + above) / 2;
    for (int level = wanted; level > within && level < above; ++level) {
      const Resolution r{family, level};
      if (!trials_.open().offers(r)) continue;
      const Prediction p = cost(r);
      return p.memory <= limits_.memory && p.seconds <= limits_.seconds ? std::optional(r) : std::nullopt;
    }
    return std::nullopt;
  }

  double error_told(const Trial& t) const {
    double most = 0;
    for (std::size_t w = 0; w < trials_.wanted().size(); ++w)
      if (trials_.judges(w)) most = std::max(most, accuracy_.error(t, w).value_or(0));
    return most;
  }

  Found best() {
    const Trial* cheapest = nullptr;
    const Trial* nearest = nullptr;
    double least = INFINITY;
    for (int f = 0; f < trials_.open().families(); ++f)
      for (const Trial* t : accuracy_.levels(f)) {
        const Resolution& r = t->choice.resolution;
        if (!trials_.open().offers(r)) continue;
        const bool within = beyond(r).empty();
        const double value = has_error_ ? ratio(r) : error_told(*t);
        if (within && (has_error_ ? value <= 1 : value < least) &&
            (!has_error_ || !cheapest || t->seconds < cheapest->seconds))
          cheapest = t;
        const double far = within ? value : 1e3 * std::max({value, t->step / limits_.step, t->memory / limits_.memory});
        if (far < least) nearest = t, least = far;
      }
    const bool sure = !has_error_ || (accuracy_.doubt() <= limits_.share && accuracy_.confirmed());
    if (cheapest && sure) return {cheapest->choice, true, ""};
    if (cheapest) nearest = cheapest;
    if (!nearest) return {like_, false, "no trial gave a result: " + failure_};
    if (why_not_.empty())
      why_not_ = !failure_.empty()                             ? failure_
                 : !sure && cheapest                           ? "what the trials converge to is not sure enough"
                 : made_ >= limits_.trials                     ? fmt::format("{} trials did not find it", made_)
                 : !beyond(nearest->choice.resolution).empty() ? beyond(nearest->choice.resolution)
                                                               : "no resolution that the program takes is fine enough";
    return {nearest->choice, false, why_not_};
  }

  Trials& trials_;
  NeedChoice like_;
  SearchLimits limits_;
  Accuracy accuracy_;
  std::vector<Resolution> failed_;
  std::string failure_, why_not_;
  bool has_error_ = false;
  int made_ = 0;
};

}  // namespace

std::optional<Prediction> predicted_cost(const Trials& trials, const Accuracy& accuracy, const Resolution& r) {
  const std::vector<const Trial*>& levels = accuracy.levels(r.family);
  const Trial *nearest = nullptr, *other = nullptr;
  const auto far = [&](const Trial* t) { return std::abs(std::log(1.0 * t->choice.resolution.level / r.level)); };
  for (const Trial* t : levels)
    if (!nearest || far(t) < far(nearest))
      other = nearest, nearest = t;
    else if (!other || far(t) < far(other))
      other = t;
  if (!nearest) return std::nullopt;
  const int dimension = trials.open().dimension();
  // Bodies whose cells are said have as many unknowns at each level.
  const auto size = [&](const Resolution& of) { return std::pow(of.level, dimension); };
  const double own = size(nearest->choice.resolution);
  double fixed = 0;
  if (other) {
    const double level = (nearest->dofs - other->dofs) / (own - size(other->choice.resolution));
    fixed = std::clamp(nearest->dofs - level * own, 0.0, nearest->dofs);
  }
  const double more = (fixed + (nearest->dofs - fixed) * size(r) / own) / nearest->dofs;
  constexpr double apart = 1.5;  // unknowns, for an exponent
  const auto exponent = [&](double a, double b) -> std::optional<double> {
    if (!other || std::min(a, b) < kClearTime) return std::nullopt;
    const double ratio = nearest->dofs / other->dofs;
    if (std::max(ratio, 1 / ratio) < apart) return std::nullopt;
    return std::clamp(std::log(a / b) / std::log(ratio), 1.0, 2.3);
  };
  // By the trials, else by what is known of the machine, else as it usually is.
  const std::optional<double> seen = other ? exponent(nearest->seconds, other->seconds) : std::nullopt;
  const double usual = dimension == 3 ? 1.5 : dimension == 2 ? 1.2 : 1;
  const double growth =
      seen ? std::pow(more, *seen) : trials.tuned_growth(*nearest, more).value_or(std::pow(more, usual));
  constexpr double factor_memory = 1.33;  // of a solid's factor over its unknowns
  return Prediction{nearest->seconds * growth, nearest->step * growth,
                    kProgramMemory + std::max(0.0, nearest->memory - kProgramMemory) * std::pow(more, factor_memory)};
}

Found search_resolution(Trials& trials, const NeedChoice& like, const SearchLimits& limits) {
  return Search(trials, like, limits).found();
}

}  // namespace fascia::app
