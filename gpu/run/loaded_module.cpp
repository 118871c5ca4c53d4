#include "gpu/run/loaded_module.hpp"

#include <dlfcn.h>

namespace fascia {

std::filesystem::path file_of(const void* function) {
  Dl_info found{};
  if (dladdr(function, &found) == 0 || found.dli_fname == nullptr) return {};
  std::error_code ignored;
  return std::filesystem::canonical(found.dli_fname, ignored);
}

LoadedModule load_module(const std::filesystem::path& file, const char* entry) {
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* function = library == nullptr ? nullptr : dlsym(library, entry);
  if (function != nullptr) return {function, ""};
  const char* why = dlerror();
  return {nullptr, why == nullptr ? "it lacks " + std::string(entry) : why};
}

}  // namespace fascia
