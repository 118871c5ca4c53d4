#include "meshless/scattered/kept_weights.hpp"

#include "core/base/index.hpp"
#include "core/base/throwing_loops.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace fascia {

namespace {

constexpr int kGrain = 512;  // places

/// Weights of consecutive places, as one thread finds them.
struct Stretch {
  std::vector<std::size_t> count;  ///< of each place
  std::vector<int> frame;
  std::vector<double> w;
  std::vector<Vec3d> gradient;

  void add(const ScatteredWeights& r) {
    count.push_back(r.frame.size());
    frame.insert(frame.end(), r.frame.begin(), r.frame.end());
    w.insert(w.end(), r.w.begin(), r.w.end());
    gradient.insert(gradient.end(), r.gradient.begin(), r.gradient.end());
  }
};

template <class T>
void put(const std::vector<T>& part, std::size_t first, std::vector<T>& whole) {
  std::copy(part.begin(), part.end(), whole.begin() + static_cast<std::ptrdiff_t>(first));
}

}  // namespace

KeptWeights::KeptWeights(std::size_t count, const std::function<ScatteredWeights(std::size_t)>& weights,
                         ThreadPool& pool)
    : begin_(count + 1), consistent_(count), lowered_(count), spread_(count) {
  std::vector<Stretch> stretch((count + kGrain - 1) / kGrain);
  for_throwing_ranges(pool, static_cast<int>(count), kGrain, [&](int begin, int end) {
    Stretch& own = stretch[at(begin / kGrain)];
    for (std::size_t p = at(begin); p < at(end); ++p) {
      const ScatteredWeights r = weights(p);
      own.add(r);
      consistent_[p] = r.consistent;
      lowered_[p] = r.lowered ? 1 : 0;
      spread_[p] = r.spread;
    }
  });
  std::size_t place = 0;
  for (const Stretch& s : stretch)
    for (const std::size_t n : s.count) {
      begin_[place + 1] = begin_[place] + n;
      ++place;
    }
  frame_.resize(begin_.back());
  w_.resize(begin_.back());
  gradient_.resize(begin_.back());
  pool.for_chunks(static_cast<int>(stretch.size()), [&](int c) {
    const Stretch s = std::move(stretch[at(c)]);  // goes once it is put
    const std::size_t first = begin_[at(c) * kGrain];
    put(s.frame, first, frame_);
    put(s.w, first, w_);
    put(s.gradient, first, gradient_);
  });
  const auto differs = [&](const Mat3d& m) { return m != consistent_.front(); };
  if (std::none_of(consistent_.begin(), consistent_.end(), differs) && count > 1) {
    consistent_.resize(1);
    consistent_.shrink_to_fit();
  }
}

WeightsView KeptWeights::operator[](std::size_t place) const {
  const std::size_t first = begin_[place], count = begin_[place + 1] - first;
  return {std::span(frame_).subspan(first, count),
          std::span(w_).subspan(first, count),
          std::span(gradient_).subspan(first, count),
          consistent_[consistent_.size() == 1 ? 0 : place],
          lowered_[place] != 0,
          spread_[place]};
}

Consistency consistency(const KeptWeights& weights, std::span<const Vec3d> frame_positions,
                        std::span<const ScatteredPlace> places, double spacing) {
  assert(weights.size() == places.size());
  Consistency r;
  int count = 0;
  for (std::size_t n = 0; n < weights.size(); ++n) {
    const WeightsView at_place = weights[n];
    const ScatteredPlace& place = places[n];
    if (at_place.frame.empty()) continue;
    ++count;
    Vec3d position;
    Mat3d slope;
    for (std::size_t i = 0; i < at_place.w.size(); ++i) {
      const Vec3d d = frame_positions[at(at_place.frame[i])] - place.X;
      position += d * at_place.w[i];
      slope += outer(d, at_place.gradient[i]);
    }
    for (int a = 0; a < place.dimension; ++a) slope -= outer(place.axes.column(a), place.axes.column(a));
    r.position += squared_norm(position) / (spacing * spacing);
    r.gradient += contract(slope, slope) / place.dimension;
  }
  if (count == 0) return r;
  return {std::sqrt(r.position / count), std::sqrt(r.gradient / count)};
}

}  // namespace fascia
