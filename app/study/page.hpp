#pragma once

#include "app/study/evaluation.hpp"

#include <filesystem>

namespace fascia::app {

/// Writes study.html: plots of error against time and against unknowns, tables, pictures; one page that asks for
/// nothing else. @throws FileError
void write_page(const StudyResult& result, const std::filesystem::path& directory);

/// Writes each plot of the page as a file, .svg or, with rsvg-convert, .png.
/// @throws FileError  @throws InputError  there is no rsvg-convert, with the package that has it
void write_plots(const StudyResult& result, const std::filesystem::path& directory, bool png);

}  // namespace fascia::app
