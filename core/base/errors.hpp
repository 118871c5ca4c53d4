#pragma once

#include <stdexcept>
#include <string>

namespace fascia {

/// A file or directory that could not be read or written. Exit status 4.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Part of a body's description that is to blame.
enum class Blame { domain, frames, points, weights };

/// Input whose content is wrong: the message names the place and a remedy. Exit status 2.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message, Blame to_blame = Blame::domain)
      : std::runtime_error(message), blame(to_blame) {}
  Blame blame;
};

/// A state that a run reached and that no result can show: a number of it is not finite. Exit status 3.
class StateError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace fascia
