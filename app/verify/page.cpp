#include "app/verify/report.hpp"

#include <fmt/format.h>

namespace fascia::app {

std::string html_of(const Verification& v, const VerifyDirectory&) {
  return fmt::format("<!doctype html>\n<meta charset=\"utf-8\">\n<title>fascia verify</title>\n<pre>{}</pre>\n",
                     text_of(v));
}

}  // namespace fascia::app
