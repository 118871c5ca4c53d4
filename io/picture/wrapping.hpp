#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace fascia::io {

/// Width of a text [pixels].
using TextWidth = std::function<double(const std::string&)>;

/// A text in lines of at most this width [pixels], broken between words; what is too long for `most` lines ends with
/// dots.
std::vector<std::string> wrapped(const std::string& text, const TextWidth& width_of, double width, std::size_t most);

/// The same with a unit at the end, or on a line of its own; it is never shortened, since numbers mean nothing without
/// it. @param unit  may be empty; @pre most > 1
std::vector<std::string> wrapped_with_unit(const std::string& words, const std::string& unit, const TextWidth& width_of,
                                           double width, std::size_t most);

}  // namespace fascia::io
