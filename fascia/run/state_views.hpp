#pragma once

#include "assembly/simulation/simulation.hpp"
#include "core/solver/reached.hpp"
#include "fascia/rows.hpp"

#include <vector>

namespace fascia {

/// Numbers of the present state for a caller: each view keeps its address, costs nothing before it is asked for, and is
/// kept up to date from then on.
class StateViews {
 public:
  /// @param s  stays with the caller
  explicit StateViews(const Simulation& s);

  bool any() const;

  Rows positions(const State& state);
  Rows rotations(const State& state);
  Rows forces(const ReachedForces& acting);
  Rows surface(std::size_t body, const State& state);

  /// Fills what was asked for. @param acting  has forces, where these were asked for
  void fill(const State& state, const ReachedForces& acting);

 private:
  struct Buffer {
    bool wanted = false;
    std::vector<double> values;

    /// Says whether it was asked for now for the first time.
    bool ask(std::size_t size);
    Rows view(int columns) const;
  };

  std::size_t nodes() const { return s_.model.rest_position.size(); }
  void fill_positions(const State& state);
  void fill_rotations(const State& state);
  void fill_forces(const ReachedForces& acting);
  void fill_surface(std::size_t body, const State& state);

  const Simulation& s_;
  Buffer positions_, rotations_, forces_;
  std::vector<Buffer> surfaces_;
  std::vector<std::vector<Attachment>> attached_;  ///< of the points of surfaces that were asked for
};

}  // namespace fascia
