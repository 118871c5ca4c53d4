#include "app/need/accuracy.hpp"

#include "app/study/richardson.hpp"

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

constexpr double kMeasuredSafety = 0.25, kAssumedSafety = 1, kSwingSafety = 1.5;
constexpr double kLeastOrder = 0.5;

Level flat(double h, const Series& series) {
  Level level{h, {}};
  for (const std::vector<double>& v : series.values) level.value.insert(level.value.end(), v.begin(), v.end());
  return level;
}

}  // namespace

std::optional<Convergence> convergence_of(const std::vector<double>& h, const std::vector<const Series*>& values,
                                          double assumed) {
  const std::size_t n = h.size();
  if (n < 2) return std::nullopt;
  const Series &last = *values[n - 1], &before = *values[n - 2];
  const std::optional<double> apart = distance(before, last, SeriesNorm::euclidean);
  if (!apart || !(last.largest() > 0)) return std::nullopt;
  Convergence c;
  c.levels = static_cast<int>(n);
  c.order = assumed;
  if (n > 2) {
    const Level first = flat(h[n - 3], *values[n - 3]), second = flat(h[n - 2], before), third = flat(h[n - 1], last);
    std::optional<double> order;
    if (first.value.size() == third.value.size() && second.value.size() == third.value.size())
      order = observed_order(first, second, third);
    if (!order) {
      c.limit = last;
      c.uncertainty = kSwingSafety * *apart / last.largest();
      return c;
    }
    // An order beyond what the elements have is a chance of coarse levels.
    c.measured = *order >= kLeastOrder && *order <= assumed + 1;
    c.order = std::clamp(*order, kLeastOrder, assumed + 1);
  }
  const double factor = 1 / (std::pow(h[n - 2] / h[n - 1], c.order) - 1);
  c.limit = mixed(before, last, 1 + factor);
  c.uncertainty = (c.measured ? kMeasuredSafety : kAssumedSafety) * factor * *apart / c.limit.largest();
  return c;
}

Accuracy::Accuracy(const Trials& trials, const NeedChoice& like) : trials_(&trials) {
  const int families = trials.open().families();
  levels_.resize(static_cast<std::size_t>(families));
  for (const Trial& t : trials.all())
    if (t.good() && t.choice.steps == like.steps && t.choice.scheme == like.scheme && t.choice.more == like.more)
      levels_[static_cast<std::size_t>(t.choice.resolution.family)].push_back(&t);
  best_.resize(trials.wanted().size());
  for (int f = 0; f < families; ++f) {
    std::vector<const Trial*>& levels = levels_[static_cast<std::size_t>(f)];
    std::sort(levels.begin(), levels.end(),
              [](const Trial* a, const Trial* b) { return a->choice.resolution.level < b->choice.resolution.level; });
    std::vector<double> h;
    h.reserve(levels.size());
    for (const Trial* t : levels) h.push_back(1.0 / t->choice.resolution.level);
    std::vector<std::optional<Convergence>>& of = of_.emplace_back();
    for (std::size_t w = 0; w < best_.size(); ++w) {
      std::vector<const Series*> values;
      values.reserve(levels.size());
      for (const Trial* t : levels) values.push_back(&t->values[w]);
      of.push_back(convergence_of(h, values, trials.open().order(f)));
    }
  }
  for (std::size_t w = 0; w < best_.size(); ++w) compare(w);
}

void Accuracy::compare(std::size_t wanted) {
  Best& best = best_[wanted];
  for (std::size_t f = 0; f < of_.size(); ++f) {
    const std::optional<Convergence>& c = of_[f][wanted];
    if (!c || (best.convergence && c->uncertainty >= best.uncertainty)) continue;
    best = {&*c, static_cast<int>(f), c->uncertainty, c->levels > 2};
  }
  if (!best.convergence) return;
  const double own = best.uncertainty, allowed = trials_->wanted()[wanted].allowed.value_or(1);
  for (std::size_t f = 0; f < of_.size(); ++f) {
    const std::optional<Convergence>& c = of_[f][wanted];
    if (!c || static_cast<int>(f) == best.family) continue;
    const double apart = relative_distance(c->limit, best.convergence->limit).value_or(0);
    // Two levels far from the limit say little of it.
    if (c->measured) best.uncertainty = std::max(best.uncertainty, apart - c->uncertainty);
    best.confirmed = best.confirmed || apart + own <= allowed;
  }
}

std::optional<double> Accuracy::error(const Trial& trial, std::size_t wanted) const {
  const Best& best = best_[wanted];
  if (!best.convergence || !trial.good()) return std::nullopt;
  const std::optional<double> apart = relative_distance(trial.values[wanted], best.convergence->limit);
  return apart ? std::optional(*apart + best.uncertainty) : std::nullopt;
}

std::optional<double> Accuracy::ratio(const Trial& trial) const {
  double most = 0;
  for (std::size_t w = 0; w < best_.size(); ++w) {
    const std::optional<double>& allowed = trials_->wanted()[w].allowed;
    if (!allowed) continue;
    const std::optional<double> e = error(trial, w);
    if (!e) return std::nullopt;
    most = std::max(most, *e / *allowed);
  }
  return most;
}

std::optional<double> Accuracy::predicted(const Resolution& r) const {
  const Trial* nearest = nullptr;
  const auto far = [&](const Trial* t) { return std::abs(std::log(1.0 * t->choice.resolution.level / r.level)); };
  for (const Trial* t : levels(r.family))
    if (!nearest || far(t) < far(nearest)) nearest = t;
  if (!nearest) return std::nullopt;
  const double shrinking = 1.0 * nearest->choice.resolution.level / r.level;
  double most = 0;
  for (std::size_t w = 0; w < best_.size(); ++w) {
    const std::optional<double>& allowed = trials_->wanted()[w].allowed;
    if (!allowed) continue;
    const std::optional<double> e = error(*nearest, w);
    if (!e) return std::nullopt;
    const std::optional<Convergence>& own = convergence(r.family, w);
    const double order = own ? own->order : trials_->open().order(r.family), doubt = best_[w].uncertainty;
    most = std::max(most, ((*e - doubt) * std::pow(shrinking, order) + doubt) / *allowed);
  }
  return most;
}

double Accuracy::doubt() const {
  double most = 0;
  for (std::size_t w = 0; w < best_.size(); ++w)
    if (const std::optional<double>& allowed = trials_->wanted()[w].allowed)
      most = std::max(most, best_[w].convergence ? best_[w].uncertainty / *allowed : INFINITY);
  return most;
}

double Accuracy::doubt(int family) const {
  double most = 0;
  for (std::size_t w = 0; w < best_.size(); ++w)
    if (const std::optional<double>& allowed = trials_->wanted()[w].allowed) {
      const std::optional<Convergence>& own = convergence(family, w);
      most = std::max(most, own ? own->uncertainty / *allowed : INFINITY);
    }
  return most;
}

bool Accuracy::confirmed() const {
  for (std::size_t w = 0; w < best_.size(); ++w)
    if (trials_->wanted()[w].allowed && !best_[w].confirmed) return false;
  return true;
}

}  // namespace fascia::app
