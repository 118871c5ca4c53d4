#pragma once

#include <string>
#include <string_view>
#include <vector>

/// Tables with commas, RFC 4180.
namespace fascia::app {

/// A cell of a table: in quotes where it holds a comma, a quote or an end of line.
std::string csv_cell(const std::string& text);

/// A row, with its end of line.
std::string csv_row(const std::vector<std::string>& cells);

/// The rows of a table; ends of lines may be LF or CRLF.
/// @throws InputError  a quote that does not end; says in which line it began
std::vector<std::vector<std::string>> read_csv(std::string_view text);

}  // namespace fascia::app
