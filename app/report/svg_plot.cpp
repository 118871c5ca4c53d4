#include "app/report/svg_plot.hpp"

#include "app/report/axis.hpp"
#include "app/report/markup.hpp"
#include "app/report/plot_labels.hpp"
#include "app/report/plot_legend.hpp"
#include "app/report/plot_marks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace fascia::app {
namespace {

constexpr double kText = 12;            // size of all texts but the title [px]
constexpr double kArrow = 10;           // from the end of an axis to a point beyond it [px]
constexpr std::size_t kLabelText = 32;  // characters of a label
constexpr std::size_t kLabelledPoints = 60;

double radius(const PlotPoint& p) { return p.marked ? 9 : 5; }

bool has_numbers(const PlotPoint& p) { return !std::isnan(p.x) && !std::isnan(p.y); }

std::vector<double> values_of(const Plot& plot, bool along_x) {
  std::vector<double> values;
  for (const PlotSeries& series : plot.series) {
    for (const PlotPoint& p : series.points) {
      if (!has_numbers(p)) continue;
      values.push_back(along_x ? p.x : p.y);
      if (along_x && p.x_low < p.x_high) values.insert(values.end(), {p.x_low, p.x_high});
    }
  }
  for (const PlotLine& line : plot.lines)
    if (line.vertical == along_x) values.push_back(line.value);
  return values;
}

std::string joint_element(const SeriesStyle& style, const std::string& path) {
  return fmt::format(R"(<path class="line {}" d="{}" fill="none" stroke="{}" stroke-width="1.5"{}/>)", style.name, path,
                     style.colour, style.dash.empty() ? "" : fmt::format(R"( stroke-dasharray="{}")", style.dash));
}

std::string ring_element(double x, double y) {
  const auto circle = [&](const char* name, const char* stroke) {
    return fmt::format(R"(<circle class="{}" cx="{}" cy="{}" r="8.5" fill="none" stroke={}/>)", name, coordinate(x),
                       coordinate(y), stroke);
  };
  return circle("halo", R"("#ffffff" stroke-width="5")") + circle("ring", R"("#222222" stroke-width="2")");
}

double widest_text(const Axis& axis) {
  double width = 0;
  for (const AxisTick& tick : axis.ticks()) width = std::max(width, text_width(tick.text, kText));
  return width;
}

class Drawing {
 public:
  Drawing(const Plot& plot, double width, double height);
  std::string text();

 private:
  struct Pixel {
    double x, y;
  };
  double x_of(double value) const { return frame_.left + x_axis_.position(value) * (frame_.right - frame_.left); }
  double y_of(double value) const { return frame_.bottom - y_axis_.position(value) * (frame_.bottom - frame_.top); }
  Pixel pixel_of(const PlotPoint& p) const;
  bool within(const PlotPoint& p) const {
    return has_numbers(p) && x_axis_.beyond(p.x) == Beyond::no && y_axis_.beyond(p.y) == Beyond::no;
  }

  bool is_drawn(const PlotLine& l) const {
    return !std::isnan(l.value) && (l.vertical ? x_axis_ : y_axis_).beyond(l.value) == Beyond::no;
  }

  template <class... Values>
  void add(fmt::format_string<Values...> form, Values&&... values) {
    svg_ += fmt::format(form, std::forward<Values>(values)...);
  }
  void line(const char* name, double x1, double y1, double x2, double y2, const std::string& stroke);
  /// @param anchor  "start", "middle" or "end"
  void words(double x, double y, const char* anchor, const std::string& text, const std::string& more = "");
  void add_titles();
  void add_ticks();
  void add_lines();
  void add_error_bars(const PlotSeries& series, const SeriesStyle& style);
  void add_joints(const PlotSeries& series, const SeriesStyle& style);
  void add_points(bool marked);
  void add_arrows(const PlotPoint& p, const Pixel& at);
  void add_labels();
  void add_label(const std::string& text, const PlotLabels::Place& place);
  void add_label(const std::string& text, const PlotPoint& p);
  void add_legend();
  std::string tooltip(const PlotSeries& series, const PlotPoint& p) const;

  const Plot& plot_;
  double width_, height_;
  Axis y_axis_, x_axis_;
  PlotBox frame_;
  PlotLabels labels_;
  std::string svg_;
};

PlotBox frame_of(const Plot& plot, double width, double height, const Axis& y_axis) {
  return {20 + widest_text(y_axis) + (plot.y_title.empty() ? 0 : 20), plot.title.empty() ? 14.0 : 38.0, width - 22,
          height - 26 - (plot.x_title.empty() ? 0 : 20)};
}

Drawing::Drawing(const Plot& plot, double width, double height)
    : plot_(plot),
      width_(width),
      height_(height),
      y_axis_(values_of(plot, false), plot.log_y, static_cast<int>((height - 90) / 45)),
      x_axis_(values_of(plot, true), plot.log_x, static_cast<int>((width - 100) / 75)),
      frame_(frame_of(plot, width, height, y_axis_)),
      labels_(frame_) {}

Drawing::Pixel Drawing::pixel_of(const PlotPoint& p) const {
  const Beyond x = x_axis_.beyond(p.x), y = y_axis_.beyond(p.y);
  return {x_of(p.x) + (x == Beyond::low    ? kArrow
                       : x == Beyond::high ? -kArrow
                                           : 0),
          y_of(p.y) + (y == Beyond::low    ? -kArrow
                       : y == Beyond::high ? kArrow
                                           : 0)};
}

void Drawing::line(const char* name, double x1, double y1, double x2, double y2, const std::string& stroke) {
  add("<path class=\"{}\" d=\"M{} {}L{} {}\" fill=\"none\" {}/>\n", name, coordinate(x1), coordinate(y1),
      coordinate(x2), coordinate(y2), stroke);
}

void Drawing::words(double x, double y, const char* anchor, const std::string& text, const std::string& more) {
  add("<text x=\"{}\" y=\"{}\" text-anchor=\"{}\" fill=\"#222222\"{}>{}</text>\n", coordinate(x), coordinate(y), anchor,
      more, escaped(text));
}

void Drawing::add_titles() {
  const auto fitting = [](const std::string& text, double room, double size) {
    return shortened(text, static_cast<std::size_t>(room / text_width("x", size)));
  };
  if (!plot_.title.empty())
    words(14, 24, "start", fitting(plot_.title, width_ - 28, 15), " font-size=\"15\" font-weight=\"600\"");
  const double middle = (frame_.top + frame_.bottom) / 2;
  words((frame_.left + frame_.right) / 2, height_ - 8, "middle", fitting(plot_.x_title, width_ - 28, kText));
  words(18, middle, "middle", fitting(plot_.y_title, height_ - 20, kText),
        fmt::format(" transform=\"rotate(-90 18 {})\"", coordinate(middle)));
}

void Drawing::add_ticks() {
  const auto stroke = [](const AxisTick& t) {
    return fmt::format("stroke=\"{}\" stroke-width=\"1\"", t.text.empty() ? "#eeeeee" : "#d4d4d4");
  };
  for (const AxisTick& t : x_axis_.ticks()) {
    const double x = x_of(t.value);
    line(t.text.empty() ? "small grid" : "grid", x, frame_.top, x, frame_.bottom, stroke(t));
    if (!t.text.empty()) words(x, frame_.bottom + 17, "middle", t.text);
  }
  for (const AxisTick& t : y_axis_.ticks()) {
    const double y = y_of(t.value);
    line(t.text.empty() ? "small grid" : "grid", frame_.left, y, frame_.right, y, stroke(t));
    if (!t.text.empty()) words(frame_.left - 7, y + 4, "end", t.text);
  }
  add("<rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#777777\"/>\n",
      coordinate(frame_.left), coordinate(frame_.top), coordinate(frame_.right - frame_.left),
      coordinate(frame_.bottom - frame_.top));
}

void Drawing::add_lines() {
  const std::string stroke = "stroke=\"#555555\" stroke-width=\"1.5\" stroke-dasharray=\"10 4\"";
  for (const PlotLine& l : plot_.lines) {
    if (!is_drawn(l)) continue;
    const double x = x_of(l.value), y = y_of(l.value);
    if (l.vertical)
      line("across", x, frame_.top, x, frame_.bottom, stroke);
    else
      line("across", frame_.left, y, frame_.right, y, stroke);
  }
}

void Drawing::add_error_bars(const PlotSeries& series, const SeriesStyle& style) {
  for (const PlotPoint& p : series.points) {
    if (!within(p) || !(p.x_low < p.x_high)) continue;
    const double low = x_of(p.x_low), high = x_of(p.x_high), y = y_of(p.y);
    labels_.take({low, y - 3, high, y + 3});
    add("<path class=\"line {0}\" d=\"M{1} {3}v6M{2} {3}v6M{1} {4}H{2}\" fill=\"none\" stroke=\"{5}\"/>\n", style.name,
        coordinate(low), coordinate(high), coordinate(y - 3), coordinate(y), style.colour);
  }
}

void Drawing::add_joints(const PlotSeries& series, const SeriesStyle& style) {
  std::string path;
  bool begun = false;
  for (const PlotPoint& p : series.points) {
    if (within(p)) path += fmt::format("{}{} {}", begun ? "L" : "M", coordinate(x_of(p.x)), coordinate(y_of(p.y)));
    begun = within(p);
  }
  if (!path.empty()) svg_ += joint_element(style, path) + "\n";
}

void Drawing::add_arrows(const PlotPoint& p, const Pixel& at) {
  const auto arrow = [&](const char* form, double x, double y) {
    add("<path class=\"arrow\" d=\"M{} {}{}\" fill=\"#222222\"/>\n", coordinate(x), coordinate(y), form);
  };
  const Beyond x = x_axis_.beyond(p.x), y = y_axis_.beyond(p.y);
  if (x == Beyond::low) arrow("l5 -4v8Z", frame_.left - 2, at.y);
  if (x == Beyond::high) arrow("l-5 -4v8Z", frame_.right + 2, at.y);
  if (y == Beyond::low) arrow("l-4 -5h8Z", at.x, frame_.bottom + 2);
  if (y == Beyond::high) arrow("l-4 5h8Z", at.x, frame_.top - 2);
}

void Drawing::add_points(bool marked) {
  for (std::size_t i = 0; i < plot_.series.size(); ++i) {
    const PlotSeries& series = plot_.series[i];
    const SeriesStyle style = series_style(i, series.dashed);
    for (const PlotPoint& p : series.points) {
      if (!has_numbers(p) || p.marked != marked) continue;
      const Pixel at = pixel_of(p);
      if (marked) svg_ += ring_element(at.x, at.y) + "\n";
      svg_ += shape_element(style, at.x, at.y) + "><title>" + escaped(tooltip(series, p)) + "</title></path>\n";
      add_arrows(p, at);
      const double r = radius(p);
      labels_.take({at.x - r, at.y - r, at.x + r, at.y + r});
    }
  }
}

std::string Drawing::tooltip(const PlotSeries& series, const PlotPoint& p) const {
  std::string text = series.name;
  if (!p.label.empty()) text += (text.empty() ? "" : ": ") + p.label;
  if (!text.empty()) text += "\n";
  text += fmt::format("{}: {}", plot_.x_title.empty() ? "x" : plot_.x_title, number_text(p.x));
  if (p.x_low < p.x_high) text += fmt::format(" ({} … {})", number_text(p.x_low), number_text(p.x_high));
  text += fmt::format("\n{}: {}", plot_.y_title.empty() ? "y" : plot_.y_title, number_text(p.y));
  return p.detail.empty() ? text : text + "\n" + p.detail;
}

void Drawing::add_label(const std::string& text, const PlotLabels::Place& place) {
  constexpr const char* halo = R"( class="halo" stroke="#ffffff" stroke-width="3" paint-order="stroke")";
  words(place.x, place.y, "start", text, halo);
}

void Drawing::add_label(const std::string& text, const PlotPoint& p) {
  if (text.empty() || !has_numbers(p)) return;
  const std::string label = shortened(text, kLabelText);
  const Pixel at = pixel_of(p);
  if (const auto place = labels_.beside_point(label, kText, at.x, at.y, radius(p), p.marked)) add_label(label, *place);
}

void Drawing::add_labels() {
  for (const PlotLine& l : plot_.lines) {
    if (l.text.empty() || !is_drawn(l)) continue;
    const std::string label = shortened(l.text, kLabelText);
    add_label(label, l.vertical ? labels_.beside_line(label, kText, x_of(l.value))
                                : labels_.above_line(label, kText, y_of(l.value)));
  }
  std::size_t points = 0;
  for (const PlotSeries& series : plot_.series) {
    points += static_cast<std::size_t>(std::count_if(series.points.begin(), series.points.end(), has_numbers));
    if (!series.points.empty()) add_label(series.note, series.points[series.points.size() / 2]);
  }
  for (const bool marked : {true, false})
    for (const PlotSeries& series : plot_.series)
      for (const PlotPoint& p : series.points)
        if (p.marked == marked && (marked || points <= kLabelledPoints)) add_label(p.label, p);
  if (points == 0) words((frame_.left + frame_.right) / 2, (frame_.top + frame_.bottom) / 2, "middle", "No points.");
}

void Drawing::add_legend() {
  std::vector<LegendItem> items;
  std::size_t beyond = 0, left_out = 0;
  bool ring = false;
  for (std::size_t i = 0; i < plot_.series.size(); ++i) {
    const PlotSeries& series = plot_.series[i];
    const SeriesStyle style = series_style(i, series.dashed);
    const std::string joint = series.joined ? joint_element(style, "M0 0H28") : "";
    const std::string note = series.note.empty() ? "" : fmt::format(" ({})", series.note);
    if (!series.name.empty()) items.push_back({joint + shape_element(style, 14, 0) + "/>", series.name + note});
    for (const PlotPoint& p : series.points) {
      left_out += has_numbers(p) ? 0 : 1;
      beyond += has_numbers(p) && !within(p) ? 1 : 0;
      ring = ring || p.marked;
    }
  }
  if (ring && !plot_.ring_name.empty()) items.push_back({ring_element(14, 0), plot_.ring_name});
  if (beyond > 0) items.push_back({"", "Arrows: the axis does not reach these values (zero, negative or infinite)."});
  if (left_out > 0) items.push_back({"", fmt::format("Not drawn: {} without a number.", left_out)});
  const Legend legend = legend_of(items, width_, height_, kText);
  svg_ += legend.svg;
  height_ += legend.height;
}

std::string Drawing::text() {
  add_titles();
  add_ticks();
  add_lines();
  for (std::size_t i = 0; i < plot_.series.size(); ++i) {
    const SeriesStyle style = series_style(i, plot_.series[i].dashed);
    add_error_bars(plot_.series[i], style);
    if (plot_.series[i].joined) add_joints(plot_.series[i], style);
  }
  add_points(false);
  add_points(true);  // on top
  add_labels();
  add_legend();
  const std::string size = fmt::format("width=\"{0}\" height=\"{1}\"", coordinate(width_), coordinate(height_));
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" {} viewBox=\"0 0 {} {}\" role=\"img\" "
             "aria-label=\"{}\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"{}\">\n"
             "<rect class=\"ground\" {} fill=\"#ffffff\"/>\n",
             size, coordinate(width_), coordinate(height_),
             escaped(fmt::format("{}: {} against {}", plot_.title, plot_.y_title, plot_.x_title)), kText, size) +
         svg_ + "</svg>\n";
}

}  // namespace

std::string svg_of(const Plot& plot, int width, int height) {
  return Drawing(plot, std::max(width, 240), std::max(height, 180)).text();
}

}  // namespace fascia::app
