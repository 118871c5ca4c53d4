#pragma once

namespace fascia::app {

/// Style and script of every page that HtmlPage writes. Without the script a page shows all of its content, unsorted.
extern const char* const page_style;
extern const char* const page_script;

}  // namespace fascia::app
