#include "app/study/machine_load.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <string>

namespace fascia::app {
namespace {

struct ProcessorTime {
  double busy = 0, total = 0;  ///< [s]
};

/// First line of /proc/stat: user, nice, system, idle, iowait, irq, softirq, steal, in ticks.
ProcessorTime processor_time() {
  std::ifstream file("/proc/stat");
  std::string word;
  std::array<double, 8> ticks{};
  file >> word;
  for (double& t : ticks) file >> t;
  if (!file || word != "cpu") return {};
  const auto second = static_cast<double>(sysconf(_SC_CLK_TCK));
  ProcessorTime time;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    time.total += ticks[i] / second;
    if (i != 3 && i != 4) time.busy += ticks[i] / second;
  }
  return time;
}

}  // namespace

MachineLoad::MachineLoad() {
  const ProcessorTime now = processor_time();
  busy_ = now.busy;
  total_ = now.total;
}

double MachineLoad::others(double own) const {
  const ProcessorTime now = processor_time();
  const double total = now.total - total_;
  // Ticks are hundredths of a second: shorter times tell nothing.
  if (total < 0.2) return 0;
  return std::clamp((now.busy - busy_ - own - 0.02) / total, 0.0, 1.0);
}

}  // namespace fascia::app
