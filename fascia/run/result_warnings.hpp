#pragma once

#include "assembly/simulation/simulation.hpp"
#include "core/run/drivers.hpp"

#include <string>
#include <vector>

namespace fascia {

/// Looks for load steps in which the elastic energy falls by half although every load and motion grew: the body found
/// another equilibrium, which may lack a turn that it was given.
class SnapWatch {
 public:
  explicit SnapWatch(const Simulation& s);
  void look(double time, double energy);
  const std::string& warning() const { return warning_; }

 private:
  const Simulation& simulation_;
  std::vector<double> factors_;
  double scale_ = 0, energy_ = 0;
  std::string warning_;
};

/// Adds what a user must know of a result that converged; a run with steps above the tolerance counts as not converged.
void add_result_warnings(const Simulation& simulation, const State& end, RunReport& run, Warnings& warnings);

}  // namespace fascia
