#pragma once

#include "app/scene/errors.hpp"
#include "core/base/errors.hpp"

namespace fascia::app {

/// What read() returns, for the file that a key of the scene names.
/// @throws FileError  read()'s own, behind the key: "SCENE:LINE:COLUMN: key: FILE: why it cannot be read"
template <class Read>
auto read_for(const Place& key, const Read& read) {
  try {
    return read();
  } catch (const FileError& e) {
    throw FileError(Diagnostic{key, e.what()}.text());
  }
}

}  // namespace fascia::app
