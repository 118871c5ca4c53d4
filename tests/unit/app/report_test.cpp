#include "app/report/axis.hpp"
#include "app/report/markup.hpp"
#include "app/report/plot_marks.hpp"
#include "app/report/svg_plot.hpp"
#include "tests/unit/app/report_xml.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

// Plots: ticks, what an axis cannot show, texts that are hostile, XML.
namespace fascia::report_test {
namespace {

using namespace app;
using report_xml::Element;
using report_xml::elements_of;
using report_xml::of_class;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string> texts_of(const Axis& axis) {
  std::vector<std::string> texts;
  for (const AxisTick& tick : axis.ticks())
    if (!tick.text.empty()) texts.push_back(tick.text);
  return texts;
}

using Texts = std::vector<std::string>;

TEST(ReportMarkup, EscapesWhatEndsATextOrAnAttribute) {
  EXPECT_EQ(escaped("</script><a href='x' id=\"y\">&amp;"),
            "&lt;/script&gt;&lt;a href=&#39;x&#39; id=&quot;y&quot;&gt;&amp;amp;");
  EXPECT_EQ(escaped("Ω ≤ 3 µm\n"), "Ω ≤ 3 µm\n");
}

TEST(ReportMarkup, ReplacesWhatXmlCannotHold) {
  const std::string instead = "\xEF\xBF\xBD";
  EXPECT_EQ(escaped(std::string("a\0b\x1B", 4)), "a" + instead + "b" + instead);
  EXPECT_EQ(escaped("\xC3"), instead);                              // the end of a character is missing
  EXPECT_EQ(escaped("\xC0\xAF"), instead + instead);                // a slash in two bytes
  EXPECT_EQ(escaped("\xED\xA0\x80"), instead + instead + instead);  // half of a pair
  EXPECT_EQ(escaped("\xEF\xBF\xBF"), instead + instead + instead);  // U+FFFF
  EXPECT_EQ(escaped("\xF0\x9F\x9A\x80"), "\xF0\x9F\x9A\x80");       // U+1F680
}

TEST(ReportMarkup, Base64IsThatOfTheStandard) {
  for (const auto& [bytes, text] : std::initializer_list<std::pair<const char*, const char*>>{
           {"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}, {"foobar", "Zm9vYmFy"}})
    EXPECT_EQ(base64(bytes), text);  // RFC 4648, section 10
  EXPECT_EQ(base64(std::string("\xFF\xFE\x00\xFB", 4)), "//4A+w==");
}

TEST(ReportMarkup, NumbersHaveTheDigitsThatAreAskedFor) {
  EXPECT_EQ(number_text(0.0123456), "0.01235");
  EXPECT_EQ(number_text(1.5), "1.5");
  EXPECT_EQ(number_text(3000), "3000");
  EXPECT_EQ(number_text(-99999.9), "−1·10⁵");
  EXPECT_EQ(number_text(2.5e-7, 2), "2.5·10⁻⁷");
  EXPECT_EQ(number_text(1.7e308, 2), "1.7·10³⁰⁸");
  EXPECT_EQ(number_text(-0.0), "0");
  EXPECT_EQ(number_text(kNone), "–");
  EXPECT_EQ(number_text(-kInfinity), "−∞");
  EXPECT_EQ(exact_text(0.1), "0.1");
  EXPECT_EQ(exact_text(kInfinity), "");
}

TEST(ReportMarkup, ShortensBetweenCharacters) {
  EXPECT_EQ(shortened("µµµµ", 4), "µµµµ");
  EXPECT_EQ(shortened("µµµµ", 3), "µµ…");
}

TEST(ReportAxis, TicksOfALinearAxisAreRound) {
  EXPECT_EQ(texts_of(Axis({0.03, 0.97}, false, 5)), (Texts{"0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
  EXPECT_EQ(texts_of(Axis({-7, 12}, false, 4)), (Texts{"−10", "−5", "0", "5", "10", "15"}));
  EXPECT_EQ(texts_of(Axis({2e7, 6e7}, false, 4)), (Texts{"2·10⁷", "3·10⁷", "4·10⁷", "5·10⁷", "6·10⁷"}));
}

TEST(ReportAxis, TicksOfALogarithmicAxisAreDecades) {
  const Axis decades({0.012, 90}, true, 5);
  EXPECT_EQ(texts_of(decades), (Texts{"0.01", "0.1", "1", "10", "100"}));
  EXPECT_EQ(decades.ticks().size(), 37u);  // with 2 to 9 of four decades
  EXPECT_EQ(texts_of(Axis({1e-9, 2e-6}, true, 4)), (Texts{"10⁻⁹", "10⁻⁸", "10⁻⁷", "10⁻⁶"}));
  EXPECT_EQ(texts_of(Axis({1.1, 9}, true, 5)), (Texts{"1", "2", "5", "10"}));
  EXPECT_EQ(texts_of(Axis({3.1, 3.9}, true, 4)), (Texts{"3.2", "3.4", "3.6", "3.8"}));
}

TEST(ReportAxis, AnyValuesGiveASoundAxis) {
  const std::vector<std::vector<double>> all = {{},
                                                {0},
                                                {7},
                                                {-7, -7, -7},
                                                {1e-300, 1e300},
                                                {5e-324, 1.7e308},
                                                {-1e300, 1e300},
                                                {kNone},
                                                {kInfinity},
                                                {-kInfinity, 3},
                                                {1, 1 + 1e-15},
                                                {1e15, 1e15 + 1},
                                                {1e-12, 2e-12},
                                                {3, 3.0001},
                                                {0, 1e-310},
                                                {1, 1e12},
                                                {99999, 100001},
                                                {0.999, 1.001},
                                                {-5, 0, 1e-9},
                                                {12, 95},
                                                {4, 41}};
  for (const auto& values : all) {
    for (const bool logarithmic : {false, true}) {
      for (const int ticks : {2, 5, 12}) {
        const Axis axis(values, logarithmic, ticks);
        const Texts texts = texts_of(axis);
        std::string place = fmt::format("logarithmic {}, {} ticks:", logarithmic, ticks);
        for (const double value : values) place += fmt::format(" {}", value);
        EXPECT_GE(texts.size(), 2u) << place;
        EXPECT_LE(texts.size(), 2u * static_cast<unsigned>(ticks) + 3) << place;
        EXPECT_EQ(std::set<std::string>(texts.begin(), texts.end()).size(), texts.size()) << place;
        double before = -1;
        for (const AxisTick& tick : axis.ticks()) {
          EXPECT_EQ(axis.beyond(tick.value), Beyond::no) << place;
          EXPECT_GT(axis.position(tick.value), before) << place;
          before = axis.position(tick.value);
        }
        for (const double value : values) {
          const double position = axis.position(value);
          EXPECT_TRUE(position >= 0 && position <= 1) << place;
        }
      }
    }
  }
}

TEST(ReportAxis, KnowsWhatItDoesNotReach) {
  const Axis logarithmic({1, 10}, true, 5), linear({1, 10}, false, 5);
  for (const double value : {0.0, -3.0, -kInfinity, 1e-310}) EXPECT_EQ(logarithmic.beyond(value), Beyond::low) << value;
  EXPECT_EQ(linear.beyond(0), Beyond::no);
  for (const Axis& axis : {logarithmic, linear}) {
    EXPECT_EQ(axis.beyond(kInfinity), Beyond::high);
    EXPECT_EQ(axis.position(kInfinity), 1);
    EXPECT_EQ(axis.position(-kInfinity), 0);
  }
}

/// Error against time of three ways, with all that a plot can have.
Plot sample() {
  Plot plot{"Soft cantilever", "time of a step [ms]", "error [-]", true, true, {}, {}, "chosen"};
  plot.series.push_back({"frames", {}, false, false, ""});
  plot.series.push_back({"tetrahedra", {}, true, true, "order 1.98"});
  plot.series.push_back({"reference", {{1, 0.5, 0, 0, "", "", false}}, false, false, ""});
  for (int i = 1; i <= 5; ++i) {
    const double time = 0.3 * std::pow(4, i);
    plot.series[0].points.push_back(
        {time, 0.1 / i, 0.9 * time, 1.2 * time, fmt::format("{} frames", 10 * i), "", i == 3});
    plot.series[1].points.push_back({2 * time, std::pow(0.3, i), 0, 0, "", "", false});
  }
  plot.lines.push_back({0.02, false, "uncertainty of the reference"});
  plot.lines.push_back({16, true, "60 a second"});
  return plot;
}

void expect_sound(const std::string& svg, const std::string& place) {
  const auto elements = elements_of(svg);
  ASSERT_FALSE(elements.empty()) << place << " is not well-formed:\n" << svg;
  EXPECT_EQ(elements[0].name, "svg");
  for (const Element& e : elements)
    for (const auto& [key, value] : e.attributes)
      for (const char* bad : {"nan", "inf", "e+", "∞"}) EXPECT_EQ(value.find(bad), std::string::npos) << place << key;
}

TEST(ReportPlot, HasWhatItWasGiven) {
  const std::string svg = svg_of(sample(), 640, 420);
  expect_sound(svg, "the sample");
  const auto elements = elements_of(svg);
  EXPECT_EQ(of_class(elements, "path", "full").size(), 5u + 5 + 1 + 3);  // points, and three signs of the legend
  EXPECT_EQ(of_class(elements, "circle", "ring").size(), 2u);            // likewise
  EXPECT_EQ(of_class(elements, "path", "across").size(), 2u);
  EXPECT_EQ(of_class(elements, "path", "line").size(), 5u + 1 + 1);  // spreads, the line, its sign in the legend
  std::set<std::string> texts;
  for (const Element& e : elements) texts.insert(e.text);
  for (const char* text : {"Soft cantilever", "time of a step [ms]", "error [-]", "frames", "tetrahedra (order 1.98)",
                           "chosen", "30 frames", "60 a second", "uncertainty of the reference", "order 1.98",
                           "frames: 30 frames\ntime of a step [ms]: 19.2 (17.28 … 23.04)\nerror [-]: 0.03333"})
    EXPECT_TRUE(texts.contains(text)) << text;
}

TEST(ReportPlot, WithoutPointsSaysSo) {
  EXPECT_NE(svg_of({}, 640, 420).find("No points."), std::string::npos);
  EXPECT_EQ(svg_of(sample(), 640, 420).find("No points."), std::string::npos);
}

TEST(ReportPlot, IsTheSameEachTime) { EXPECT_EQ(svg_of(sample(), 640, 420), svg_of(sample(), 640, 420)); }

TEST(ReportPlot, PutsAnArrowWhereAnAxisDoesNotReach) {
  Plot plot = sample();
  plot.series[0].points = {{0, 1e-3, 0, 0, "", "", false},
                           {1, 0, 0, 0, "", "", false},
                           {-1, -1, 0, 0, "", "", false},
                           {2, kInfinity, 0, 0, "", "", false},
                           {kNone, 1, 0, 0, "", "", false}};
  const std::string svg = svg_of(plot, 640, 420);
  expect_sound(svg, "beyond");
  const auto elements = elements_of(svg);
  EXPECT_EQ(of_class(elements, "path", "arrow").size(), 1u + 1 + 2 + 1);
  EXPECT_EQ(of_class(elements, "path", "s0").size(), 4u + 1);  // the fifth has no number
  EXPECT_NE(svg.find("Arrows: "), std::string::npos);
  EXPECT_NE(svg.find("Not drawn: 1 without a number."), std::string::npos);
}

TEST(ReportPlot, ALineIsInterruptedWhereAPointIsMissing) {
  Plot plot;
  plot.log_y = true;
  plot.series.push_back({"", {}, true, false, ""});
  for (const double y : {1.0, 2.0, 0.0, 3.0, kNone, 5.0, 6.0})
    plot.series[0].points.push_back({y, y, 0, 0, "", "", false});
  const auto lines = of_class(elements_of(svg_of(plot, 400, 300)), "path", "line");
  ASSERT_EQ(lines.size(), 1u);
  const std::string path = lines[0].attributes.at("d");
  EXPECT_EQ(std::count(path.begin(), path.end(), 'M'), 3);
  EXPECT_EQ(std::count(path.begin(), path.end(), 'L'), 2);
}

TEST(ReportPlot, AnyPointsGiveASoundPlot) {
  std::vector<Plot> plots(7);
  plots[1].series.resize(3);
  plots[2].series.push_back({"one", {{3, 4, 0, 0, "a", "", false}}, true, false, "note"});
  plots[3].series.push_back({"equal", std::vector<PlotPoint>(9, {2, 2, 2, 2, "b", "", true}), true, true, ""});
  plots[4].series.push_back(
      {"far", {{1e-308, -1e308, -1, 1e308, "", "", false}, {1e308, 1e308, 0, 0, "", "", false}}, true, false, ""});
  plots[5].series.push_back({"none", {{kNone, kNone, kNone, kNone, "", "", true}}, true, false, "note"});
  plots[5].lines = {{kNone, true, "x"}, {kInfinity, false, "y"}, {0, true, "z"}};
  for (int i = 0; i < 300; ++i)
    plots[6].series.push_back({std::string(static_cast<std::size_t>(i), 'n'),
                               {{1.0 * i, 1.0 * i * i, 0, 0, "label", "", false}},
                               false,
                               false,
                               ""});
  for (std::size_t i = 0; i < plots.size(); ++i) {
    for (const bool logarithmic : {false, true}) {
      plots[i].log_x = plots[i].log_y = logarithmic;
      for (const auto& [width, height] : {std::pair(0, 0), std::pair(640, 420)})
        expect_sound(svg_of(plots[i], width, height), fmt::format("plot {}, logarithmic {}: ", i, logarithmic));
    }
  }
}

TEST(ReportPlot, HostileTextsStayTexts) {
  const std::string hostile = "</text><script>alert('1')</script>&\"\xFF\x01]]>";
  Plot plot = sample();
  plot.title = plot.x_title = plot.y_title = plot.ring_name = hostile;
  plot.lines[0].text = hostile;
  for (PlotSeries& series : plot.series) {
    series.name = series.note = hostile;
    for (PlotPoint& p : series.points) p.label = p.detail = hostile;
  }
  const std::string svg = svg_of(plot, 900, 420);
  expect_sound(svg, "hostile");
  for (const Element& e : elements_of(svg)) EXPECT_NE(e.name, "script");
}

TEST(ReportPlot, SeriesDifferWithoutColour) {
  std::set<std::string> shapes, styles;
  for (std::size_t i = 0; i < 42; ++i) {
    SeriesStyle style = series_style(i, false);
    styles.insert(style.colour + " " + shape_element(style, 0, 0));
    style.colour = style.name = "";
    if (i < 14) shapes.insert(shape_element(style, 0, 0));
  }
  EXPECT_EQ(shapes.size(), 14u);
  EXPECT_EQ(styles.size(), 42u);
}

}  // namespace
}  // namespace fascia::report_test
