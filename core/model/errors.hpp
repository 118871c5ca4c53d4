#pragma once

#include <stdexcept>
#include <string>

namespace fascia {

/// A file or directory that could not be read or written. Exit status 4.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Input whose content is wrong: the message names the place and a remedy. Exit status 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace fascia
