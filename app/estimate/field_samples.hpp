#pragma once

#include "app/estimate/series.hpp"
#include "assembly/simulation/simulation.hpp"

#include <string>
#include <vector>

namespace fascia::app {

/// Displacements of a run's bodies at places of their rest shapes, over the saved times, for comparison with runs of
/// other meshes: there the same places are a probe.
class FieldSamples {
 public:
  /// @param coarser  the same scene at a lower resolution, which must hold the places too; or null
  FieldSamples(const Simulation& simulation, const Simulation* coarser);

  void add(double time, const State& state);

  std::size_t size() const { return bodies_.size(); }
  const std::string& body(std::size_t i) const { return bodies_[i].name; }
  /// The name of the probe in other runs, and what makes it.
  std::string probe(std::size_t i) const;
  std::string override_for(std::size_t i) const;
  /// Of the run itself. @param over_time  otherwise the end alone
  Series series(std::size_t i, bool over_time) const;
  /// Of another run's probe, weighted as the run's own: |values| is the mean over the matter.
  Series weighted(std::size_t i, Series of_probe) const;

 private:
  struct Samples {
    std::string name;
    std::vector<Vec3d> X;
    std::vector<Attachment> places;
    std::vector<double> weight;  ///< square root of the part of the mass
    Series series;
  };
  std::vector<Samples> bodies_;
  std::string prefix_;
};

}  // namespace fascia::app
