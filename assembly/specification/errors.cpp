#include "assembly/specification/errors.hpp"

#include <fmt/format.h>

namespace fascia {

std::string Diagnostic::text() const {
  const std::string key = place.key.empty() ? "" : place.key + ": ";
  if (place.file.empty()) return key + message;
  return fmt::format("{}:{}:{}: {}{}", place.file, place.line, place.column, key, message);
}

SceneError::SceneError(std::vector<Diagnostic> diagnostics) : diagnostics_(std::move(diagnostics)) {
  for (const Diagnostic& diagnostic : diagnostics_) {
    if (!text_.empty()) text_ += '\n';
    text_ += diagnostic.text();
  }
}

}  // namespace fascia
