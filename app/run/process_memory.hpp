#pragma once

#include <filesystem>
#include <string>

namespace fascia::app {

/// Has the C library keep some MB that were freed, in place of giving them back to the system at once: a saved state
/// allocates and frees some hundred times, and each return and each first touch of a page costs a call of the kernel,
/// most of the time of small states. Frees a block of 4 MB, after which glibc takes blocks up to that size from its own
/// heap and gives that back where 8 MB lie free at its end, as it does by itself once a run has freed such a block.
void keep_freed_memory();

/// Memory of this process that stands in the machine's [bytes]; what it has freed is given back first.
double resident_memory();

/// The most that there was since the program started [bytes]; not of the process that started it.
double peak_memory();

/// Memory that a process may still take.
struct FreeMemory {
  double bytes = 0;
  std::string limit;  ///< what sets it, in words that complete "X GB are free"; empty where the machine does
};

/// The least that the machine, the control groups of the process and its own limits (ulimit -v, -d) leave. A process
/// that has such a limit needs some of it for what it reserves and does not use.
FreeMemory free_memory();

/// Control groups leave this to their members [bytes]; infinite where they set no limit.
/// @param groups  as /proc/self/cgroup
/// @param root    where they are mounted: /sys/fs/cgroup
double memory_left_by_groups(const std::filesystem::path& groups, const std::filesystem::path& root);

/// The program can start to work within the limits that its process has.
/// @throws InputError  too little room, with the limit and what is needed
void require_room();

}  // namespace fascia::app
