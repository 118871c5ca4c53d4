#include "app/report/axis.hpp"

#include "app/report/markup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

constexpr double kLargest = 1e300;      // differences of two such values are still numbers
constexpr double kSpan = 1e-10;         // parts of a value that are too few to be told apart by ticks
constexpr double kLogSpan = 1e-6;       // decades, likewise
constexpr double kMargin = 0.04;        // of a logarithmic axis, on both sides
constexpr double kToNextDecade = 0.15;  // part of the axis by which it is made longer to end with a decade

int exponent_of(double value) { return static_cast<int>(std::floor(std::log10(value) + 1e-12)); }

/// 1, 2 or 5 times a power of ten: about `span` / `ticks`.
double round_step(double span, int ticks) {
  const double rough = span / std::max(ticks, 2);
  const double power = std::pow(10.0, exponent_of(rough));
  const double digit = rough / power;
  return power * (digit < M_SQRT2 ? 1 : digit < 3.16 ? 2 : digit < 7.07 ? 5 : 10);
}

/// A multiple of `step` with the digits that the step has; with powers of ten where values of this size need them.
std::string tick_text(double value, double step, double largest) {
  const int exponent = exponent_of(step);
  if (std::abs(value) < 0.5 * step) return "0";
  const int size = exponent_of(largest);
  if (size >= -3 && size <= 5) {
    const std::string digits = fmt::format("{:.{}f}", std::abs(value), std::max(0, -exponent));
    return (value < 0 ? "−" : "") + digits;
  }
  return number_text(value, std::max(1, exponent_of(std::abs(value)) - exponent + 1));
}

double multiple(double count, double step) {
  const int exponent = exponent_of(step);
  if (exponent >= 0 || exponent < -22) return count * step;
  return count * std::round(step * std::pow(10.0, -exponent)) / std::pow(10.0, -exponent);  // 3 · 0.1 as 0.3
}

}  // namespace

Axis::Axis(const std::vector<double>& values, bool logarithmic, int ticks) : logarithmic_(logarithmic) {
  std::vector<double> shown;
  for (const double value : values)
    if (!std::isnan(value) && beyond(value) == Beyond::no) shown.push_back(scaled(value));
  if (shown.empty()) shown = logarithmic ? std::vector<double>{0} : std::vector<double>{0, 1};
  const auto [least, most] = std::minmax_element(shown.begin(), shown.end());
  low_ = *least;
  high_ = *most;
  if (logarithmic)
    set_logarithmic(std::max(ticks, 2));
  else
    set_linear(std::max(ticks, 2));
}

double Axis::scaled(double value) const { return logarithmic_ ? std::log10(value) : value; }

Beyond Axis::beyond(double value) const {
  if (value > kLargest) return Beyond::high;
  if (value < -kLargest || (logarithmic_ && value <= 1 / kLargest)) return Beyond::low;
  return Beyond::no;
}

double Axis::position(double value) const {
  if (std::isnan(value) || beyond(value) == Beyond::low) return 0;
  if (beyond(value) == Beyond::high) return 1;
  return std::clamp((scaled(value) - low_) / (high_ - low_), 0.0, 1.0);
}

void Axis::set_linear(int ticks) {
  const double largest = std::max(std::abs(low_), std::abs(high_));
  if (high_ - low_ <= std::max(kSpan * largest, 1 / kLargest)) {
    const double around = largest > 1 / kLargest ? 0.1 * largest : 1;
    low_ -= around;
    high_ += around;
  }
  const double step = round_step(high_ - low_, ticks);
  low_ = multiple(std::floor(low_ / step + 1e-9), step);
  high_ = multiple(std::ceil(high_ / step - 1e-9), step);
  add_round_ticks(low_, high_, step);
}

void Axis::set_logarithmic(int ticks) {
  if (high_ - low_ < kLogSpan) {
    low_ -= 0.3;
    high_ += 0.3;
  }
  const double margin = kMargin * (high_ - low_), nearly = kToNextDecade * (high_ - low_);
  const double down = low_ - std::floor(low_), up = std::ceil(high_) - high_;
  low_ -= down > margin / 2 && down < nearly ? down : margin;
  high_ += up > margin / 2 && up < nearly ? up : margin;
  if (high_ - low_ < 0.7) {
    const double from = std::pow(10.0, low_), to = std::pow(10.0, high_);
    add_round_ticks(from, to, round_step(to - from, std::max(ticks, 4)));
  } else {
    add_decades(ticks);
  }
}

void Axis::add_decades(int ticks) {
  const int first = static_cast<int>(std::floor(low_)), last = static_cast<int>(std::floor(high_));
  const int within = last - static_cast<int>(std::ceil(low_)) + 1;
  const int stride = std::max(1, (within + ticks - 1) / ticks);
  const bool between = within < 2 || 3 * within <= ticks + 2;  // texts at 2 and 5
  const bool plain = first >= -3 && last <= 4;
  for (int decade = first; decade <= last; ++decade) {
    for (int digit = 1; digit <= (stride == 1 ? 9 : 1); ++digit) {
      const double value = digit * std::pow(10.0, decade);
      if (beyond(value) != Beyond::no || std::log10(value) < low_ - 1e-9 || std::log10(value) > high_ + 1e-9) continue;
      std::string text;
      if (digit == 1 ? decade % stride == 0 : between && (digit == 2 || digit == 5))
        text = plain ? number_text(value, 1) : (digit == 1 ? "" : fmt::format("{}·", digit)) + power_of_ten(decade);
      ticks_.push_back({value, text});
    }
  }
}

void Axis::add_round_ticks(double low, double high, double step) {
  const double largest = std::max(std::abs(low), std::abs(high));
  for (double count = std::ceil(low / step - 1e-6); count <= high / step + 1e-6; ++count) {
    const double value = multiple(count, step);
    if (beyond(value) != Beyond::no) continue;
    ticks_.push_back({value, tick_text(value, step, largest)});
  }
}

}  // namespace fascia::app
