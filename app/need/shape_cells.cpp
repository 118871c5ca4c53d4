#include "app/need/shape_cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

/// Part of what is allowed that cells along a thin direction may still change.
constexpr double kSettled = 0.03;
/// Directions that change this many times as much as the thin ones get more cells, up to this many times.
constexpr double kMostOfError = 4;
constexpr int kMostStretch = 4;
/// Where no error is stated, cells are shaped for this one.
constexpr double kShapedFor = 0.01;

class Shape {
 public:
  Shape(Trials& trials, NeedChoice coarsest, std::size_t body)
      : trials_(trials), choice_(std::move(coarsest)), body_(body), thin_(trials.open().thin_directions(body)) {
    for (std::size_t i = 0; i < trials.open().bodies[body].pattern.size(); ++i)
      if (const int d = static_cast<int>(i); std::find(thin_.begin(), thin_.end(), d) == thin_.end())
        other_.push_back(d);
  }

  void run() {
    if (thin_.empty()) return;
    double through = change(thin_);
    for (int stretch = 1; stretch < kMostStretch && !trials_.stopped(); stretch *= 2) {
      const double along = change(other_);
      if (!(along > 1) || along < kMostOfError * through) break;
      trials_.stretch(body_, choice_.resolution.family);
      if (!trials_.run(choice_).good()) return;
      through = change(thin_);
    }
    for (const int direction : thin_)
      if (!trials_.stopped() && change({direction}) <= kSettled)
        trials_.settle(body_, choice_.resolution.family, direction);
  }

 private:
  /// What twice the cells along some directions change, over what is allowed; infinite where nothing is known of it.
  double change(const std::vector<int>& directions) {
    const Trial& own = trials_.run(choice_);
    NeedChoice doubled = choice_;
    doubled.more.push_back(trials_.open().doubled(choice_.resolution, body_, directions));
    const Trial& twice = trials_.run(doubled);
    if (!own.good() || !twice.good()) return INFINITY;
    double most = 0;
    for (std::size_t w = 0; w < own.values.size(); ++w)
      if (trials_.judges(w))
        most = std::max(most, relative_distance(own.values[w], twice.values[w]).value_or(INFINITY) /
                                  trials_.wanted()[w].allowed.value_or(kShapedFor));
    return most;
  }

  Trials& trials_;
  NeedChoice choice_;
  std::size_t body_;
  std::vector<int> thin_, other_;
};

}  // namespace

void shape_cells(Trials& trials, const NeedChoice& coarsest) {
  for (std::size_t b = 0; b < trials.open().bodies.size(); ++b) Shape(trials, coarsest, b).run();
}

}  // namespace fascia::app
