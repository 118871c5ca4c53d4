#include "app/tools.hpp"

#include "app/tools_tag.hpp"
#include "core/base/errors.hpp"
#include "gpu/run/loaded_module.hpp"

#include <fmt/format.h>

#include <string_view>

namespace fascia::app {
namespace {

/// Beside the library that holds this function: of one that is chosen by the processor, made for the same.
const Tools& load() {
  namespace fs = std::filesystem;
  const fs::path file = file_of(reinterpret_cast<const void*>(&tools)).parent_path() / "fascia-tools.so";
  if (!fs::exists(file))
    throw FileError(
        fmt::format("this build is without study, verify, compare and their like: there is no {}; build the target "
                    "fascia-tools (in a checkout ./run does)",
                    file.string()));
  const LoadedModule module = load_module(file, kToolsEntry);
  if (module.entry == nullptr) throw FileError(fmt::format("{} cannot be loaded: {}", file.string(), module.reason));
  const Tools* found = reinterpret_cast<ToolsEntry>(module.entry)();
  if (found->build != std::string_view(FASCIA_TOOLS_TAG))
    throw FileError(
        fmt::format("{} is of another build than this program: build the target fascia-tools again", file.string()));
  return *found;
}

}  // namespace

const Tools& tools() {
  static const Tools& loaded = load();
  return loaded;
}

}  // namespace fascia::app
