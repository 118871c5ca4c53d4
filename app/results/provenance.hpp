#pragma once

#include "assembly/simulation/simulation.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

namespace fascia::app {

/// The command that the process was started with, words quoted for a shell where they must be.
void remember_command(int argc, char** argv);
std::string remembered_command();
/// The words that begin a command of this program, for execv of /proc/self/exe, before its arguments: its name, or what
/// a loader that was started by name (as a bundle does it) was told up to the program.
std::vector<std::string> first_words_of_command();

/// A word as a shell takes it: in quotes where it must be.
std::string quoted_for_shell(const std::string& word);

/// Where a result comes from, so that it can be repeated: the scene's text and its SHA-256, its file, overrides and
/// output directory, the files that it reads with theirs, the command, the program (version, commit, compiler, flags,
/// libraries, processor level), the machine, the time of the start (UTC) and the units.
/// @throws FileError  a file that the scene names cannot be read
nlohmann::ordered_json provenance_of(const Simulation& simulation);

/// Files that a scene reads, in its order.
std::vector<std::filesystem::path> input_files(const Scene& scene);

/// Stands for what a scene simulates, in 16 hexadecimal digits: its keys but for title, needs, probes and output, and
/// the paths and contents of its files. @throws FileError  one of them cannot be read
std::string simulation_digest(const Scene& scene);

}  // namespace fascia::app
