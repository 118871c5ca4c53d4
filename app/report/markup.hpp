#pragma once

#include <string>
#include <string_view>

/// Texts and numbers within HTML and SVG.
namespace fascia::app {

/// Any text as the content of an element or of a quoted attribute, in HTML and XML: & < > " ' become references. What
/// XML cannot hold (control characters other than tab and line end, bytes that are not UTF-8) becomes U+FFFD.
std::string escaped(std::string_view text);

/// Bytes as base64 with padding, RFC 4648, section 4.
std::string base64(std::string_view bytes);

/// `text` in at most `most` characters, the last of them "…" where it is longer. A UTF-8 character is never cut.
std::string shortened(std::string_view text, std::size_t most);

/// Number of characters of a UTF-8 text.
std::size_t characters(std::string_view text);

/// A number for reading: at most `digits` significant ones, without zeros at the end, and with a power of ten as in
/// "2.5·10⁻⁷" where it is below 0.001 or from 100,000 on. "–" where it is no number, "∞" and "−∞".
std::string number_text(double value, int digits = 4);

/// "10⁻³": a power of ten.
std::string power_of_ten(int exponent);

/// A number for machines: the shortest that gives the same double; empty where it is not finite.
std::string exact_text(double value);

}  // namespace fascia::app
