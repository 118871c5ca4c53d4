#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace fascia::app {

/// How far a body is from one that moves as a whole, the largest values over the saved states of a result.
struct BodyMotion {
  double rotation = 0;           ///< of the rigid motion that fits the body's points best [rad]
  std::optional<double> strain;  ///< largest principal Green-Lagrange strain at any point; none: not saved
  double deformation = 0;        ///< what is left of displacements beside that motion [m]
  double displacement = 0;       ///< the largest [m]
};

/// The motions of the bodies of a result, from the files that its .pvd lists.
/// @throws FileError, InputError
std::map<std::string, BodyMotion> body_motions(const std::filesystem::path& pvd);

}  // namespace fascia::app
