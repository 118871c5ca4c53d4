#pragma once

#include "core/geometry/mesh.hpp"

#include <functional>
#include <string>

namespace fascia::io {

/// Runs a reader in a child process: readers of other makers may crash on damaged files, and then only the child dies.
/// What the child prints is dropped.
///
/// @param file  for messages
/// @throws InputError  with the reader's message, or where the child dies
/// @throws FileError   where no child can be started
Mesh read_isolated(const std::string& file, const std::function<Mesh()>& read);

}  // namespace fascia::io
