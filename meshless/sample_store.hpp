#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace fascia {

/// Where samples of matter may be kept between runs: the same description gives the same bytes.
class SampleStore {
 public:
  virtual ~SampleStore() = default;
  /// Finds what was kept of a description; none where nothing was.
  virtual std::optional<std::string> find(std::string_view description) const = 0;
  /// Says whether something is worth being kept. @param seconds  that it took to make
  virtual bool wants(double seconds) const = 0;
  virtual void keep(std::string_view description, std::string_view bytes) const = 0;
};

}  // namespace fascia
