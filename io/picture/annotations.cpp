#include "io/picture/annotations.hpp"

#include "io/picture/legend.hpp"
#include "io/quantity.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fascia::io {
namespace {

Pixel along(Pixel a, double dx, double dy) { return {a.x + dx, a.y + dy}; }

void draw_disk(Canvas& canvas, Pixel center, double radius, const Color& color) {
  constexpr int corners = 24;
  for (int i = 0; i < corners; ++i) {
    const double a = 2 * std::numbers::pi * i / corners, b = 2 * std::numbers::pi * (i + 1) / corners;
    canvas.triangle(center, along(center, radius * std::cos(a), radius * std::sin(a)),
                    along(center, radius * std::cos(b), radius * std::sin(b)), color);
  }
}

void draw_arrow(Canvas& canvas, Pixel from, Pixel to, double width, const Color& color) {
  const double length = std::hypot(to.x - from.x, to.y - from.y);
  if (length < 0.5 * width) return draw_disk(canvas, from, 1.3 * width, color);  // points towards the eye or away
  const double head = std::min(4.5 * width, length), x = (to.x - from.x) / length, y = (to.y - from.y) / length;
  const Pixel neck = along(to, -head * x, -head * y);
  const double side = 0.42 * head;
  canvas.stroke(from, neck, width, color);
  canvas.triangle(to, along(neck, -side * y, side * x), along(neck, side * y, -side * x), color);
}

const char* name_of(Sign sign) {
  switch (sign) {
    case Sign::rest:
      return "shape at rest";
    case Sign::support:
      return "support";
    case Sign::partial_support:
      return "partial support";
    case Sign::spring:
      return "spring";
    default:
      return "frame";
  }
}

/// @param middle  of the sign, which is two fonts wide
void draw_sign(Canvas& canvas, Sign sign, Pixel middle, double font) {
  const double half = 0.32 * font;
  const double line = std::max(1.0, font / 9);
  if (sign == Sign::rest || sign == Sign::spring)
    canvas.stroke(along(middle, -0.8 * font, 0), along(middle, 0.8 * font, 0), line,
                  sign == Sign::rest ? rest_color : spring_color);
  if (sign == Sign::support) canvas.rectangle(along(middle, -half, -half), along(middle, half, half), mark_color);
  if (sign == Sign::partial_support) draw_disk(canvas, middle, half, mark_color);
  if (sign == Sign::frame) draw_disk(canvas, middle, half, frame_color);
}

}  // namespace

void draw_axes(Canvas& canvas, Pixel center, double radius, int font, const View& view) {
  struct Axis {
    Vec3d along;
    const char* name;
    Color color;
  };
  std::vector<Axis> axes{{view.of({{1, 0, 0}}), "x", {0.78, 0.16, 0.14}},
                         {view.of({{0, 1, 0}}), "y", {0.16, 0.55, 0.20}},
                         {view.of({{0, 0, 1}}), "z", {0.15, 0.30, 0.75}}};
  std::sort(axes.begin(), axes.end(), [](const Axis& a, const Axis& b) { return a.along[2] < b.along[2]; });
  const double shaft = radius - 0.75 * font;
  for (const Axis& axis : axes) {
    const Pixel tip = along(center, shaft * axis.along[0], shaft * axis.along[1]);
    draw_arrow(canvas, center, tip, std::max(1.2, font / 10.0), axis.color);
    const double flat = std::hypot(axis.along[0], axis.along[1]), beyond = 0.6 * font;
    const bool towards = flat < 0.12;  // its name stands where the other two axes are not
    const double x = towards ? -axes[0].along[0] - axes[1].along[0] - axes[2].along[0] : axis.along[0];
    const double y = towards ? -axes[0].along[1] - axes[1].along[1] - axes[2].along[1] : axis.along[1];
    const double length = std::hypot(x, y);
    canvas.text(along(towards ? center : tip, beyond * x / length, beyond * y / length), axis.name,
                {font, true, Anchor::center}, axis.color);
  }
}

ScaleBar scale_bar(double metre, double widest) {
  ScaleBar bar;
  bar.length = round_below(widest / metre);
  bar.width = bar.length * metre;
  bar.text = length_text(bar.length);
  return bar;
}

void draw_scale_bar(Canvas& canvas, Pixel left, int font, const ScaleBar& bar) {
  const double line = std::max(1.5, font / 7.0), end = 0.28 * font;
  const Pixel right = along(left, bar.width, 0);
  canvas.stroke(left, right, line, ink);
  for (const Pixel& p : {left, right})
    canvas.stroke(along(p, 0, -end), along(p, 0, end), std::max(1.0, 0.7 * line), ink);
  canvas.text(along(left, 0.5 * bar.width, 0.85 * font), bar.text, {font, false, Anchor::center}, ink);
}

void draw_key(Canvas& canvas, Pixel low, double width, int font, const std::vector<Sign>& signs) {
  const double sign_width = 2.1 * font, row = 1.4 * font, space = 1.3 * font;
  double x = low.x, y = low.y;
  for (const Sign sign : signs) {
    const double needed = sign_width + measure(name_of(sign), {font}).x;
    if (x > low.x && x + needed > low.x + width) {
      x = low.x;
      y += row;
    }
    if (needed > width || y > low.y + 1.5 * row) continue;
    draw_sign(canvas, sign, {x + 0.8 * font, y}, font);
    canvas.text({x + sign_width, y}, name_of(sign), {font}, ink);
    x += needed + space;
  }
}

}  // namespace fascia::io
