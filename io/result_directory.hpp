#pragma once

#include "io/directory_lock.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fascia::io {

/// A scene with what was chosen for it, where it stated a need.
inline constexpr const char* kChosenScene = "chosen.toml";

/// A folder inside of the directory for what is computed beside the result; it goes with the next one at the latest.
inline constexpr const char* kTwins = ".fascia.twins";

/// The state of a body in which a run failed.
inline std::string failed_state_file(const std::string& body) { return body + "_failed.vtu"; }

/// The files of a result are called after these.
struct ResultNames {
  std::string stem;                 ///< of the scene's file: NAME.pvd, NAME.png
  std::vector<std::string> bodies;  ///< BODY_00000.vtu, BODY_failed.vtu
};

/// A directory of results, which a run fills as they arise. The files of an older result are set aside, in the
/// directory, until the new one can be shown; they come back where it never can, also after a process that was killed,
/// with the next run there. Files that belong to no result stay where they are.
class ResultDirectory {
 public:
  /// Makes the directory, locks it, sets the older result aside.
  /// @throws FileError  where it cannot be made or locked, or where `target` exists and is no result of this program
  ///                    (a directory that is empty or holds a summary.json with a "fascia" key is), or holds a foreign
  ///                    file of a name that this result needs
  ResultDirectory(const std::filesystem::path& target, const ResultNames& names);
  ~ResultDirectory();
  ResultDirectory(const ResultDirectory&) = delete;
  ResultDirectory& operator=(const ResultDirectory&) = delete;

  const std::filesystem::path& path() const { return target_; }
  /// Says that the new result can be opened: the older one goes.
  void show();
  /// Lets the new result stay where there is no older one that could come back.
  void keep();
  bool shown() const { return shown_; }
  /// Gives the directory free. Unless it was shown or kept, the new result goes and the older one comes back.
  void leave() noexcept;

 private:
  void prepare(const ResultNames& names);

  std::filesystem::path target_;
  bool made_ = false;   ///< the directory is new
  bool shown_ = false;  ///< what is in it stays
  std::optional<DirectoryLock> lock_;
};

}  // namespace fascia::io
