#include "app/report/html_page.hpp"

#include "app/report/markup.hpp"
#include "app/report/page_assets.hpp"
#include "io/digest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace fascia::app {
namespace {

/// Lower-case letters and digits of a heading, with "-" between them.
std::string slug(const std::string& text) {
  std::string result;
  for (const char c : text) {
    const bool upper = c >= 'A' && c <= 'Z';
    if (upper || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'))
      result += upper ? static_cast<char>(c - 'A' + 'a') : c;
    else if (!result.empty() && result.back() != '-')
      result += '-';
  }
  while (!result.empty() && result.back() == '-') result.pop_back();
  return result.empty() ? "part" : result;
}

/// Allows the page's own script alone, by its hash, and pictures that are within the page.
std::string policy() {
  const std::string digits = io::sha256(page_script);
  std::string bytes;
  for (std::size_t i = 0; i < digits.size(); i += 2)
    bytes += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  return fmt::format("default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'sha256-{}'",
                     base64(bytes));
}

std::string caption_of(const std::string& text) {
  return text.empty() ? "" : fmt::format("<figcaption>{}</figcaption>", escaped(text));
}

}  // namespace

std::string HtmlPage::heading(const std::string& text, int level) {
  const std::string wanted = slug(text);
  std::string anchor = wanted;
  for (int number = 2; !anchors_.insert(anchor).second; ++number) anchor = fmt::format("{}-{}", wanted, number);
  const int depth = std::clamp(level, 2, 3);
  if (depth == 2) contents_.emplace_back(anchor, text);
  body_ += fmt::format("<h{0} id=\"{1}\"><a href=\"#{1}\">{2}</a></h{0}>\n", depth, anchor, escaped(text));
  return anchor;
}

void HtmlPage::paragraph(const std::string& text) { body_ += fmt::format("<p>{}</p>\n", escaped(text)); }

void HtmlPage::notice(const std::string& text) {
  body_ += fmt::format("<p class=\"notice\" role=\"note\">{}</p>\n", escaped(text));
}

void HtmlPage::list(const std::vector<std::string>& items) {
  body_ += "<ul>\n";
  for (const std::string& item : items) body_ += fmt::format("<li>{}</li>\n", escaped(item));
  body_ += "</ul>\n";
}

void HtmlPage::command(const std::string& text) {
  body_ += fmt::format("<div class=\"command\"><pre>{}</pre><button type=\"button\" hidden>Copy</button></div>\n",
                       escaped(text));
}

void HtmlPage::plot(const std::string& svg, const std::string& caption) {
  body_ += fmt::format("<figure><div class=\"scroll\" tabindex=\"0\">{}</div>{}</figure>\n", svg, caption_of(caption));
}

void HtmlPage::picture(std::string_view png, const std::string& alternative, const std::string& caption) {
  if (!png.starts_with("\x89PNG\r\n\x1A\n")) throw std::invalid_argument("these bytes are no PNG");
  body_ += fmt::format("<figure><img alt=\"{}\" src=\"data:image/png;base64,{}\">{}</figure>\n", escaped(alternative),
                       base64(png), caption_of(caption));
}

void HtmlPage::table(const ReportTable& table) { body_ += html_of(table); }

void HtmlPage::map(const HeatMap& map) { body_ += html_of(map); }

void HtmlPage::details(const std::string& summary, const std::function<void()>& content) {
  body_ += fmt::format("<details><summary>{}</summary>\n", escaped(summary));
  content();
  body_ += "</details>\n";
}

std::string HtmlPage::text() const {
  const std::string title = escaped(title_);
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n"
      "<link rel=\"icon\" href=\"data:,\">\n<style>{}</style>\n</head>\n<body>\n<h1>{}</h1>\n",
      policy(), title, page_style, title);
  if (contents_.size() > 2) {
    page += "<nav class=\"contents\" aria-label=\"Contents\"><ul>\n";
    for (const auto& [anchor, text] : contents_)
      page += fmt::format("<li><a href=\"#{}\">{}</a></li>\n", anchor, escaped(text));
    page += "</ul></nav>\n";
  }
  page += "<main>\n" + body_ + "</main>\n";
  if (!footer_.empty()) page += fmt::format("<footer>{}</footer>\n", escaped(footer_));
  return page + fmt::format("<script>{}</script>\n</body>\n</html>\n", page_script);
}

}  // namespace fascia::app
