#pragma once

#include "assembly/specification/scene.hpp"

#include <exception>
#include <string>
#include <utility>
#include <vector>

namespace fascia {

/// One thing that is wrong in a scene, and what would be right.
struct Diagnostic {
  Place place;
  std::string message;  ///< "what is wrong; what would be right"

  /// FILE:LINE:COLUMN: key.path: message
  std::string text() const;
};

/// Everything that is wrong with a scene. Exit status 2.
class SceneError : public std::exception {
 public:
  explicit SceneError(std::vector<Diagnostic> diagnostics);
  const char* what() const noexcept override { return text_.c_str(); }
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
  std::string text_;
};

/// Gathers what parts of a scene have wrong, so that it is told in one go.
class SceneErrors {
 public:
  /// Runs a part, and keeps what it throws.
  template <class Act>
  void gather(const Act& act) {
    try {
      act();
    } catch (const SceneError& e) {
      found_.insert(found_.end(), e.diagnostics().begin(), e.diagnostics().end());
    }
  }
  /// @throws SceneError  all that was kept, if anything was
  void tell() const {
    if (!found_.empty()) throw SceneError(found_);
  }

 private:
  std::vector<Diagnostic> found_;
};

}  // namespace fascia
