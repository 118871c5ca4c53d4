#pragma once

#include <string>
#include <vector>

namespace fascia::app {

/// Runs another program, looked up on the PATH unless its name holds a slash, with this one's standard streams.
/// @return its exit status; 127 where it cannot be started, 128 + the number of a signal that ended it
int run_other_program(const std::vector<std::string>& arguments);

}  // namespace fascia::app
