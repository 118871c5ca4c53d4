#pragma once

#include "assembly/specification/actions.hpp"
#include "assembly/specification/body.hpp"
#include "assembly/specification/results.hpp"
#include "assembly/specification/solver.hpp"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

/// A scene: all that is simulated, and how.
namespace fascia {

struct Scene {
  std::filesystem::path path{};
  std::string text{};                     ///< of the file
  std::vector<std::string> overrides{};   ///< "key.path=value", in their order
  std::vector<std::string> silenced{};    ///< names of warnings
  std::map<std::string, Place> places{};  ///< of every key that is written, by its full path
  std::string title{};
  World world{};
  std::vector<Body> bodies{};  ///< in the order of the file
  std::vector<Constraint> constraints{};
  std::vector<Load> loads{};
  std::vector<Coupling> couplings{};  ///< in the order of the file
  Solver solver{};
  std::vector<Probe> probes{};  ///< in the order of the file
  Output output{};
  std::optional<StatedNeed> need{};

  /// Something is needed, of the scene or of a body.
  bool states_need() const;

  /// True where a key is written: "loads[0].over".
  bool says(const std::string& key) const { return places.contains(key); }
  /// Where a key is written; where it is not, the table that would hold it.
  Place place_of(const std::string& key) const;
};

}  // namespace fascia
