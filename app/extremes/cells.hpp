#pragma once

#include "app/extremes/specimen.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace fascia::app {

/// A place of the map: a scene, and what is known of its answer.
struct ExtremeCell {
  std::string row;               ///< "hexahedra, static, cholesky"
  std::string axis;              ///< "Young's modulus"; of pairs "pairs"
  std::string value;             ///< "1e+12 Pa"
  std::string text;              ///< the scene, TOML
  std::optional<double> theory;  ///< size of the probe "tip" by the theory of beams [m]
  double force = 0, length = 0;  ///< of the beam: E A [N], and its length [m]; 0: not known
  /// False where the law gives way by a closed form (Specimen::is_borne()): to stop for that reason is as good as an
  /// answer.
  bool is_borne = true;
  bool has_equilibrium = true;  ///< else nothing holds a body at rest: to refuse it is right, and to converge wrong

  std::string name() const { return row + ": " + axis + " " + value; }
};

/// One number of a specimen over decades, all others as in the sound base cell.
struct ExtremeAxis {
  std::string name, unit;
  std::vector<double> values;
  bool (*applies)(const Specimen&);
  void (*set)(Specimen&, double value);

  std::string text_of(double value) const;
};

const std::vector<ExtremeAxis>& extreme_axes();

/// "hexahedra, static, cholesky"
std::string row_of(const Specimen& specimen);

/// Every model, in statics and dynamics, by Cholesky and by conjugate gradients, over every axis that applies.
std::vector<ExtremeCell> map_cells();

/// The extreme values of every axis at every model, one kind of run each, which changes from one to the next: what a
/// check has time for.
std::vector<ExtremeCell> reduced_cells();

/// Cells in which two axes take values of theirs at random, always the same ones.
std::vector<ExtremeCell> pair_cells(int count, std::uint64_t seed = 1);

}  // namespace fascia::app
