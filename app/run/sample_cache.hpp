#pragma once

#include "assembly/specification/results.hpp"
#include "meshless/sample_store.hpp"

#include <filesystem>
#include <string>

namespace fascia::app {

/// Samples of matter in files of a cache, for this build of the library alone; the oldest go where it grows above a
/// gigabyte. What cannot be read or written is made again.
class SampleCache final : public SampleStore {
 public:
  /// @param output  says whether and where
  explicit SampleCache(const Output& output);

  std::optional<std::string> find(std::string_view description) const override;
  bool wants(double seconds) const override;
  void keep(std::string_view description, std::string_view bytes) const override;

 private:
  std::filesystem::path file_of(std::string_view description) const;

  std::filesystem::path folder_;  ///< empty: nothing is kept
  std::string origin_;            ///< the library that samples
};

}  // namespace fascia::app
