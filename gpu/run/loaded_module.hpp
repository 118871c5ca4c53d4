#pragma once

#include <filesystem>
#include <string>

namespace fascia {

/// The file of the library or program that holds a function, without links.
std::filesystem::path file_of(const void* function);

/// A part of the program that is a library of its own, and stays loaded.
struct LoadedModule {
  void* entry = nullptr;  ///< a function of it; null where it could not be had
  std::string reason;     ///< then: why
};

/// @param entry  name of the function, which is extern "C"
LoadedModule load_module(const std::filesystem::path& file, const char* entry);

}  // namespace fascia
