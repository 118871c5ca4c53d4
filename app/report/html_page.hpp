#pragma once

#include "app/report/heat_map.hpp"
#include "app/report/report_table.hpp"

#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fascia::app {

/// A page in one file: style, script and pictures are within it, and its own policy keeps a browser from asking for
/// anything else or running another script. Texts are plain; they are escaped here. Content stands in the order of the
/// calls.
class HtmlPage {
 public:
  explicit HtmlPage(std::string title) : title_(std::move(title)) {}

  /// Returns its anchor: "body-liver" of "Body: liver", with a number where it is taken. Three headings of level 2 give
  /// a list of contents. @param level  2 or 3
  std::string heading(const std::string& text, int level = 2);
  void paragraph(const std::string& text);
  /// A paragraph that must not be overlooked.
  void notice(const std::string& text);
  void list(const std::vector<std::string>& items);
  /// Lines for a shell, or for a file, with a button that copies them.
  void command(const std::string& text);
  /// @param svg  of `svg_of`, taken as it is
  void plot(const std::string& svg, const std::string& caption = "");
  /// @param png  the bytes of the file @param alternative  says what is seen
  /// @throws std::invalid_argument  they are no PNG
  void picture(std::string_view png, const std::string& alternative, const std::string& caption = "");
  void table(const ReportTable& table);
  void map(const HeatMap& map);
  /// Content that is shown once its summary is clicked: all that is added to this page by `content`.
  void details(const std::string& summary, const std::function<void()>& content);
  /// Last line: version, date.
  void footer(const std::string& text) { footer_ = text; }

  /// The whole page, UTF-8.
  std::string text() const;

 private:
  std::string title_, body_, footer_;
  std::set<std::string> anchors_;
  std::vector<std::pair<std::string, std::string>> contents_;  ///< anchor, text
};

}  // namespace fascia::app
