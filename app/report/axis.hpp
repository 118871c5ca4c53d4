#pragma once

#include <string>
#include <vector>

namespace fascia::app {

/// A mark on an axis; the large ones have a text.
struct AxisTick {
  double value = 0;
  std::string text;  ///< empty: a small one
};

/// The side of an axis on which a value stands that the axis does not reach.
enum class Beyond { no, low, high };

/// What an axis of a plot reaches, and its ticks: multiples of 1, 2 or 5 times a power of ten; decades with 2 to 9
/// between them where it is logarithmic.
class Axis {
 public:
  /// The least axis with round ticks around all values that it can show; others are `beyond`. One value alone, or none,
  /// gives an axis around it, or around 1.
  /// @param ticks  about how many texts there is room for, at least 2
  Axis(const std::vector<double>& values, bool logarithmic, int ticks);

  /// 0 at the low end, 1 at the high one; 0 or 1 for what is beyond; 0 for what is no number.
  double position(double value) const;
  /// An infinite value, one past ±10³⁰⁰ and, where the axis is logarithmic, one of at most 10⁻³⁰⁰ are beyond it.
  Beyond beyond(double value) const;
  const std::vector<AxisTick>& ticks() const { return ticks_; }

 private:
  void set_linear(int ticks);
  void set_logarithmic(int ticks);
  void add_decades(int ticks);
  void add_round_ticks(double low, double high, double step);
  double scaled(double value) const;

  bool logarithmic_;
  double low_ = 0, high_ = 1;  ///< their decimal logarithms where it is logarithmic
  std::vector<AxisTick> ticks_;
};

}  // namespace fascia::app
