#pragma once

#include <string>
#include <vector>

namespace fascia::app {

/// A command of the program, for completion.
struct CommandWords {
  std::string name;
  std::vector<std::string> options;    ///< "--output"
  std::vector<std::string> arguments;  ///< what may follow beside files
};

/// A script for bash that completes commands, options, scene files, and after --set the keys of the scene format with
/// their values; a body, material or probe by the names that the scene on the line has. Installed as
/// share/bash-completion/completions/fascia, or sourced: source <(fascia completion bash).
std::string bash_completion(const std::vector<CommandWords>& commands);

}  // namespace fascia::app
