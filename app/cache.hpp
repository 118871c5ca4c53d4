#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

/// Files that a user's cache keeps between runs: none of them is needed.
namespace fascia::app {

/// $XDG_CACHE_HOME/fascia, or ~/.cache/fascia; empty where there is neither.
std::filesystem::path cache_folder();

/// Path, size and time of the libraries that this process has mapped and whose names begin so: another build is another
/// program. With an empty name of all that is the program's, its modules beside it included. Empty where a part was
/// replaced meanwhile: then nothing may be kept.
std::string stamp_of_program(std::string_view prefix);

/// Writes a file as a whole, whoever else writes the same; then the oldest of its folder go where together they have
/// more than `most` bytes. @throws std::runtime_error  it cannot be written
void keep_in_cache(const std::filesystem::path& file, std::string_view bytes, std::uintmax_t most);

}  // namespace fascia::app
