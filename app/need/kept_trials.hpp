#pragma once

#include "app/need/trials.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

/// Trials of earlier searches: files in the user's cache, of this machine and program alone. What a search needs again,
/// with another need or after another change, is taken from there. Comments, titles and needs of a scene do not count.
class KeptTrials {
 public:
  /// @param scene  whose trials they are  @param anew  nothing is taken, but what is made is kept
  /// @throws FileError  a file that the scene names cannot be read
  KeptTrials(const Scene& scene, bool anew);

  /// Finds what the scene with these changes came to, without its choice. None where it was not tried, did not give all
  /// of the quantities, or where steps are needed and other work lengthened them.
  std::optional<Trial> find(const std::vector<std::string>& changes, const std::vector<Wanted>& wanted) const;

  /// The summary of a run is of the scene as it was read, and of files as they were then.
  bool is_of_scene(const nlohmann::ordered_json& summary) const;

  /// Keeps a trial that gave a result, as far as files can be written.
  void keep(const std::vector<std::string>& changes, const std::vector<Wanted>& wanted, const Trial& trial) const;

 private:
  std::filesystem::path file_of(const std::vector<std::string>& changes) const;

  const Scene& scene_;
  std::filesystem::path folder_;  ///< empty: there is no cache
  bool anew_;
  std::vector<std::string> digests_;  ///< of the files that the scene reads
  std::string origin_;                ///< machine, program and files that all trials share
};

}  // namespace fascia::app
