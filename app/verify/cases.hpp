#pragma once

#include "app/schema/schema.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// The registry of verification cases: scenes/cases/*.toml, which `fascia verify`, the tests and docs/validation.md
/// read.
namespace fascia::app {

/// Which number of a probe's value is meant.
struct Entry {
  std::vector<std::size_t> indices;  ///< into lists, vectors and matrices, from outside in; none: a number
  bool norm = false;                 ///< the root of the sum of the squares of all numbers
};

/// How far a value may be from its reference.
struct Allowed {
  double error = 0;
  bool relative = true;  ///< to the reference; otherwise in its unit
};

/// One value with its source.
struct VerificationCase {
  std::string name, title;
  std::string probe, minus;  ///< of the scene; `minus` is subtracted, empty: nothing is
  Entry at;
  double over = 1;   ///< what the value is divided by
  double value = 0;  ///< the reference, in SI units
  std::string unit, source, why;
  double uncertainty = 0;  ///< of the reference, relative
  Allowed allowed;
};

/// One simulation and the values that it must give.
struct VerificationRun {
  std::string name, title;
  std::string topic, heading;  ///< of its file: "beams_static", and its title
  std::vector<std::string> features;
  bool full = false;                 ///< takes long: only with --full
  bool repeated = false;             ///< run again on one thread and on all, to be equal bit for bit
  std::filesystem::path scene;       ///< its file; of a text the case file, by which paths in it are resolved
  std::optional<std::string> text;   ///< a whole scene
  std::vector<std::string> changes;  ///< "key.path=value"
  std::vector<VerificationCase> cases;
};

using Registry = std::vector<VerificationRun>;

/// What a case file may hold.
const Shape& case_file_schema();

/// Reads every .toml of a folder, in the order of their names, with the scenes that they name.
/// @throws SceneError  with everything that is wrong in any of them
/// @throws FileError   where the folder or a file cannot be read
Registry read_registry(const std::filesystem::path& folder);

/// The folder of the cases that come with the program. @throws FileError
std::filesystem::path cases_folder();

}  // namespace fascia::app
