#include "app/report/html_page.hpp"
#include "app/report/page_assets.hpp"
#include "app/report/svg_plot.hpp"
#include "tests/unit/app/report_xml.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <regex>
#include <stdexcept>

// Pages: tables that sort, maps of states, texts that are hostile, no requests.
namespace fascia::report_page_test {
namespace {

using namespace app;
using report_xml::elements_of;
using report_xml::of_class;

const std::string kHostile = "</script><img src=x onerror=\"alert('1')\">&amp;";
const std::string kPixel(  // a PNG of one pixel
    "\x89PNG\r\n\x1A\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\x08\0\0\0\0\x3A\x7E\x9B\x55\0\0\0\nIDATx\x9C\x63\xF8\x0F\0\x01\x01"
    "\x01\0"
    "\x1B\xB6\xEE\x56\0\0\0\0IEND\xAE\x42\x60\x82",
    67);

ReportTable numbers() {
  ReportTable table{"Runs", {{"name", "", false}, {"time", "ms", true}, {"state", "", false}}, {}};
  table.rows.push_back({"a", number_cell(1.0 / 3), state_cell(ResultState::right)});
  table.rows.push_back(
      {kHostile, number_cell(std::numeric_limits<double>::quiet_NaN()), state_cell(ResultState::refused)});
  table.rows.push_back({"c", ReportCell("2.5 s", 2500), state_cell(ResultState::wrong, "3 % off")});
  return table;
}

TEST(ReportTables, NumbersAreSortedByTheirExactValue) {
  const auto elements = elements_of(html_of(numbers()));
  ASSERT_FALSE(elements.empty());
  const auto cells = of_class(elements, "td", "number");
  ASSERT_EQ(cells.size(), 3u);
  EXPECT_EQ(cells[0].text, "0.3333");
  EXPECT_EQ(std::strtod(cells[0].attributes.at("data-value").c_str(), nullptr), 1.0 / 3);
  EXPECT_EQ(cells[1].text, "–");
  EXPECT_FALSE(cells[1].attributes.contains("data-value"));
  EXPECT_EQ(cells[2].text, "2.5 s");
  EXPECT_EQ(cells[2].attributes.at("data-value"), "2500");
}

TEST(ReportTables, HeadsSayThatTheySort) {
  std::size_t heads = 0;
  for (const auto& e : elements_of(html_of(numbers()))) {
    if (e.name != "th") continue;
    ++heads;
    EXPECT_EQ(e.attributes.at("aria-sort"), "none");
  }
  EXPECT_EQ(heads, 3u);
}

TEST(ReportTables, LongOnesFilter) {
  ReportTable table = numbers();
  EXPECT_EQ(html_of(table).find("type=\"search\""), std::string::npos);
  table.rows.resize(9, table.rows[0]);
  EXPECT_NE(html_of(table).find("type=\"search\""), std::string::npos);
}

TEST(ReportTables, ARowOfAnotherLengthIsAnError) {
  ReportTable table = numbers();
  table.rows[1].pop_back();
  EXPECT_THROW(html_of(table), std::invalid_argument);
}

HeatMap states() {
  HeatMap map{"Extremes", "Poisson's ratio", "length / thickness", {"0.3", kHostile}, {"1", "10", "1000"}, {}};
  map.cells.push_back({{ResultState::right, "", "error 0.2 %", "", ""},
                       {ResultState::stopped, "", kHostile, "fascia run 'a b.toml'", "part"},
                       {}});
  map.cells.push_back({{ResultState::wrong, "12%", "off", "", ""}, {ResultState::refused, "", "why", "", ""}, {}});
  return map;
}

TEST(ReportMaps, StatesHaveSignsAndDetails) {
  const auto elements = elements_of(html_of(states()));
  ASSERT_FALSE(elements.empty());
  std::vector<report_xml::Element> buttons;
  for (const auto& e : elements)
    if (e.name == "button") buttons.push_back(e);
  ASSERT_EQ(buttons.size(), 4u);  // nothing is told of cells that were not run
  EXPECT_EQ(buttons[0].text, "✓");
  EXPECT_EQ(buttons[0].attributes.at("title"), "0.3, 1: right error 0.2 %");  // XML reads the end of a line as a space
  EXPECT_EQ(buttons[1].text, "S");
  EXPECT_EQ(buttons[1].attributes.at("title"), "0.3, 10: stopped " + kHostile);
  EXPECT_EQ(buttons[1].attributes.at("data-command"), "fascia run 'a b.toml'");
  EXPECT_EQ(buttons[2].text, "12%");
  EXPECT_EQ(of_class(elements, "td", "none").size(), 2u);
  EXPECT_EQ(of_class(elements, "span", "state").size(), 5u);  // of the legend
}

TEST(ReportMaps, CellsThatDoNotFitTheNamesAreAnError) {
  HeatMap map = states();
  map.cells[1].pop_back();
  EXPECT_THROW(html_of(map), std::invalid_argument);
  map.cells.pop_back();
  EXPECT_THROW(html_of(map), std::invalid_argument);
}

/// A page with everything; of many rows and points where it is to be looked at.
std::string page_of(std::size_t count) {
  HtmlPage page("Study of the soft cantilever " + kHostile);
  const std::string first = page.heading("Error and time");
  page.notice("The machine was busy while this was measured: load 1.7 of 2. " + kHostile);
  page.paragraph("Each point is one run; its bar is the spread of the time of five repetitions.");
  Plot plot{
      "Error against time", "time of a step [ms]", "error of the tip's displacement [-]", true, true, {}, {}, "chosen"};
  plot.lines = {{4e-4, false, "uncertainty of the reference"}, {16, true, "60 a second"}};
  const char* names[] = {"rigid frames", "affine frames", "tetrahedra", "hexahedra, order 2"};
  ReportTable table{
      "All runs",
      {{"body", "", false}, {"unknowns", "", true}, {"step", "ms", true}, {"error", "%", true}, {"state", "", false}},
      {}};
  for (std::size_t s = 0; s < 4; ++s) {
    plot.series.push_back({names[s], {}, s > 1, s > 2, s > 1 ? "order 2.0" : ""});
    for (std::size_t i = 0; i < count / 4; ++i) {
      const double k = static_cast<double>(i), n = 300 * std::pow(30, k * 4 / static_cast<double>(count));
      const double time = 2e-3 * n * (1 + 0.5 * static_cast<double>(s)) * (1 + 0.3 * std::sin(17 * k));
      const double error = 30 * std::pow(n, -1.0 - 0.25 * static_cast<double>(s)) * (1 + 0.4 * std::sin(5 * k));
      plot.series[s].points.push_back({time, i == 5 && s == 1 ? 0.0 : error, 0.93 * time, 1.1 * time,
                                       fmt::format("{:.0f}", n), "5 repetitions", i == count / 10 && s == 2});
      table.rows.push_back(
          {names[s], number_cell(std::round(n)), number_cell(time), number_cell(100 * error),
           i % 9 == 4 ? state_cell(ResultState::stopped, "time limit") : state_cell(ResultState::right)});
    }
  }
  page.plot(svg_of(plot, 760, 480), "Error against the median time of a step.");
  page.heading("Runs");
  page.table(table);
  page.heading("Map of extremes");
  HeatMap map = states();
  map.cells[0][1].anchor = first;
  for (std::size_t r = 0; r < count / 20; ++r) {
    map.rows.push_back(fmt::format("0.4{}", std::string(r % 12, '9')));
    map.cells.push_back(map.cells[r % 2]);
  }
  page.map(map);
  page.heading("How to repeat it");
  page.list({"Machine: two cores.", "Version: 0.9 " + kHostile});
  page.command("fascia study study.toml --output results \\\n  --repeat 5 " + kHostile);
  page.details("Pictures", [&] {
    page.heading("The fastest", 3);
    page.picture(kPixel, "a bent bar " + kHostile, "One pixel.");
  });
  page.footer("fascia 0.9, 24 November 2026");
  return page.text();
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(ReportPages, HoldAllThatTheyShow) {
  const std::string page = page_of(40);
  EXPECT_TRUE(page.starts_with("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">"));
  const std::regex address(R"re((src|href|action|data)="([^"]*)")re");
  for (std::sregex_iterator i(page.begin(), page.end(), address), end; i != end; ++i)
    EXPECT_TRUE((*i)[2].str().starts_with("#") || (*i)[2].str().starts_with("data:")) << (*i)[0];
  for (const char* part : {"url(", "@import", "fetch(", "XMLHttpRequest", "WebSocket"})
    EXPECT_EQ(page.find(part), std::string::npos) << part;
  EXPECT_EQ(count_of(page, "://"), 1u);  // the name of SVG
  EXPECT_NE(page.find("<footer>fascia 0.9, 24 November 2026</footer>"), std::string::npos);
}

TEST(ReportPages, HostileTextsStayTexts) {
  const std::string page = page_of(40);
  EXPECT_EQ(count_of(page, "<script"), 1u);
  EXPECT_EQ(count_of(page, "</script"), 1u);
  EXPECT_EQ(count_of(page, "<img"), 1u);
  EXPECT_EQ(page.find("<img src=x"), std::string::npos);
}

TEST(ReportPages, AnchorsAreTheirOwn) {
  HtmlPage page("Verification");
  EXPECT_EQ(page.heading("Body: Liver (2)"), "body-liver-2");
  EXPECT_EQ(page.heading("body liver"), "body-liver");
  EXPECT_EQ(page.heading("body, liver"), "body-liver-3");
  EXPECT_EQ(page.heading("µ", 3), "part");
  EXPECT_NE(page.text().find("<nav"), std::string::npos);
  EXPECT_NE(page.text().find("<h3 id=\"part\">"), std::string::npos);
}

TEST(ReportPages, APictureIsAPng) {
  HtmlPage page("Pictures");
  EXPECT_THROW(page.picture("", "nothing"), std::invalid_argument);
  EXPECT_THROW(page.picture("GIF89a", "a picture of another kind"), std::invalid_argument);
}

TEST(ReportPages, AreTheSameEachTime) { EXPECT_EQ(page_of(40), page_of(40)); }

/// Into a file, for a look at it with a browser, where FASCIA_REPORT_PAGE names one.
TEST(ReportPages, OfManyPointsAreSmall) {
  const std::string page = page_of(300);
  EXPECT_LT(page.size(), 600'000u);
  if (const char* file = std::getenv("FASCIA_REPORT_PAGE")) std::ofstream(file, std::ios::binary) << page;
}

}  // namespace
}  // namespace fascia::report_page_test
