#pragma once

#include <string>

namespace fascia {

/// Processors that this process may use: fewer than the machine has under taskset, in a batch job, or in a container
/// that is given the time of some.
int available_processors();

/// Reads how many processors' time a process may take, rounded up; 0: that of all.
/// @param groups  lines of /proc/self/cgroup
/// @param root    where control groups are mounted: /sys/fs/cgroup
int processors_of_quota(const std::string& groups, const std::string& root);

}  // namespace fascia
