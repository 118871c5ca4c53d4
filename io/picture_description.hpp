#pragma once

#include "core/math/vec3.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fascia::io {

/// A material point that is held.
struct PictureSupport {
  std::string body;
  Vec3d X{};          ///< at rest [m]
  bool whole = true;  ///< in every direction
};

struct PictureSpring {
  std::string body;
  Vec3d X{};      ///< where it is attached, at rest [m]
  Vec3d point{};  ///< fixed in space [m]
};

/// Meaning of the numbers of the states.
enum class StateKind { time, load_factor, frequency };

/// A run as its pictures show it, beside the fields of its states: the file picture.json among the .vtu files.
struct PictureDescription {
  std::string title;
  std::optional<Vec3d> up;
  StateKind kind = StateKind::time;
  std::vector<double> states;  ///< of each state a time [s], a load factor [-] or a frequency [Hz]
  std::string end;             ///< how the run ended, where it did not converge
  std::vector<PictureSupport> supports;
  std::vector<PictureSpring> springs;
};

inline constexpr const char* kDescriptionFile = "picture.json";

/// Writes picture.json into a directory. @throws FileError
void write_description(const std::filesystem::path& directory, const PictureDescription& description);

/// Reads the picture.json in a directory; an empty description where there is none.
/// @throws InputError  where it is none that fascia wrote
PictureDescription read_description(const std::filesystem::path& directory);

/// "t = 0.4 s", "load factor 0.5", "mode 3: 12.4 Hz", with the digits that tell it from its neighbours; empty where
/// the description does not know the state.
std::string state_label(const PictureDescription& description, int state);

}  // namespace fascia::io
