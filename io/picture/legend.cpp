#include "io/picture/legend.hpp"

#include "io/picture/wrapping.hpp"
#include "io/quantity.hpp"

#include <algorithm>
#include <cmath>

namespace fascia::io {
namespace {

constexpr double line_height = 1.35, bar_width = 1.3, gap = 0.45;  // times the font

}  // namespace

Legend::Legend(const ColorScale& scale, int font, double height, double width)
    : scale_(scale), font_(font), height_(height) {
  const ReadableUnit unit = readable_unit(std::max(std::abs(scale.low), std::abs(scale.high)), scale.unit);
  const auto width_of = [font](const std::string& text) { return measure(text, {font, true}).x; };
  title_ = wrapped_with_unit(scale.words, unit.unit.empty() ? "" : "[" + unit.unit + "]", width_of, width, 3);
  const double low = scale.low * unit.factor, high = scale.high * unit.factor;
  const double title_height = line_height * font * static_cast<double>(title_.size()) + 0.6 * font;
  bar_ = std::max(height - title_height - 0.6 * font, 2.0 * font);
  if (!(low < high)) {
    ticks_ = {{0.5, short_number_text(low, std::max(1e-3 * std::abs(low), 1e-9))}};
  } else {
    const auto most = static_cast<int>(std::clamp(bar_ / (2.4 * font), 1.0, 7.0));
    const Ticks round = round_ticks(low, high, most);
    ticks_ = {{0, (scale.below ? "≤ " : "") + short_number_text(low, 0.1 * round.step)},
              {1, (scale.above ? "≥ " : "") + short_number_text(high, 0.1 * round.step)}};
    const double room = 1.4 * font / bar_;
    for (const double value : round.values) {
      const double part = (value - low) / (high - low);
      if (part > room && part < 1 - room) ticks_.push_back({part, number_text(value, round.step)});
    }
  }
  for (const std::string& line : title_) width_ = std::max(width_, width_of(line));
  for (const Tick& tick : ticks_)
    width_ = std::max(width_, (bar_width + 2 * gap) * font + measure(tick.text, {font}).x);
}

void Legend::draw(Canvas& canvas, Pixel low, vtkLookupTable& colors) const {
  double y = low.y + height_ - 0.5 * line_height * font_;
  for (const std::string& line : title_) {
    canvas.text({low.x, y}, line, {font_, true}, ink);
    y -= line_height * font_;
  }
  const double left = low.x, right = left + bar_width * font_, bottom = low.y + 0.6 * font_;
  const auto color = [&](double part) {
    double value[3];
    colors.GetColor(scale_.low + part * (scale_.high - scale_.low), value);
    return Color{value[0], value[1], value[2]};
  };
  constexpr int bands = 256;
  for (int i = 0; i < bands; ++i) {
    const double from = static_cast<double>(i) / bands, to = static_cast<double>(i + 1) / bands;
    canvas.rectangle({left, bottom + from * bar_}, {right, bottom + to * bar_}, color(0.5 * (from + to)));
  }
  const double line = std::max(1.0, font_ / 16.0);
  for (const Tick& tick : ticks_) {
    const double at = bottom + tick.part * bar_;
    canvas.stroke({right, at}, {right + 0.3 * font_, at}, line, ink);
    canvas.text({right + 2 * gap * font_, at}, tick.text, {font_}, ink);
  }
}

}  // namespace fascia::io
