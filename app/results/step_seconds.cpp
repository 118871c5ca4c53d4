#include "app/results/step_seconds.hpp"

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

constexpr double kLeast = 1e-9, kMost = 1e8;  // [s]
constexpr double kWidth = 0.01;               // of a class, in the logarithm of time

std::size_t class_of(double seconds) {
  return static_cast<std::size_t>(std::log(std::clamp(seconds, kLeast, kMost) / kLeast) / kWidth);
}

double middle_of(std::size_t index) { return kLeast * std::exp((static_cast<double>(index) + 0.5) * kWidth); }

}  // namespace

void StepSeconds::add(double seconds) {
  if (count_.empty()) count_.resize(class_of(kMost) + 1);
  ++count_[class_of(seconds)];
  shortest_ = steps_ == 0 ? seconds : std::min(shortest_, seconds);
  longest_ = steps_ == 0 ? seconds : std::max(longest_, seconds);
  ++steps_;
}

double StepSeconds::percentile(double part) const {
  if (steps_ == 0) return 0;
  const auto rank = static_cast<std::uint64_t>(std::ceil(part * static_cast<double>(steps_ - 1)));
  if (rank == 0) return shortest_;
  if (rank + 1 >= steps_) return longest_;
  std::uint64_t below = 0;
  for (std::size_t k = 0; k < count_.size(); ++k) {
    below += count_[k];
    if (below > rank) return std::clamp(middle_of(k), shortest_, longest_);
  }
  return longest_;
}

}  // namespace fascia::app
