#include "app/reader/parse.hpp"
#include "assembly/specification/errors.hpp"
#include "core/base/errors.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

/// Any bytes are a scene or a SceneError. The last line, after a zero byte, is an override.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  const std::size_t zero = input.rfind('\0');
  std::vector<std::string> overrides;
  if (zero != std::string_view::npos) overrides.emplace_back(input.substr(zero + 1));
  try {
    fascia::app::parse_scene_text(input.substr(0, zero), "fuzz.toml", overrides);
  } catch (const fascia::SceneError&) {
  } catch (const fascia::FileError&) {
  }
  return 0;
}
