#pragma once

#include "core/structure/model.hpp"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <functional>
#include <string>

namespace fascia::app {

/// The errors of a scene's results, estimated without a reference. Made before the scene's own run, of which it is told
/// the states.
class ErrorEstimate {
 public:
  virtual ~ErrorEstimate() = default;

  /// A saved state of the scene's own run.
  virtual void add(double time, const State& state) = 0;

  /// Puts `estimated_error` and `estimate` into the summary.
  /// @param directory  of the scene's own result, which converged
  /// @param tell       is told what is done, a line each
  /// @param stop       ends it once it says true; then the summary stays as it was
  /// @return  whether it was not stopped
  virtual bool run(const std::filesystem::path& directory, nlohmann::ordered_json& summary,
                   const std::function<void(const std::string&)>& tell, const std::function<bool()>& stop) = 0;
};

}  // namespace fascia::app
