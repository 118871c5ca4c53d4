#pragma once

#include "assembly/specification/scene.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

/// A scene at another resolution in space and time, or solved more exactly: what has to be set in it.
namespace fascia::app {

/// What makes another scene of one that describes the same bodies, loads and supports.
struct SceneTwin {
  std::vector<std::string> overrides;   ///< "key.path=value", to stand behind the scene's own
  std::vector<std::string> changes;     ///< clauses: "beam" has 41 x 5 x 5 frames in the place of 21 x 3 x 3
  std::vector<std::string> kept;        ///< clauses: what stays as it is, and why
  std::map<std::string, double> nodes;  ///< of each body that changes: about how many times as many nodes it has

  /// Everything that was asked for is changed, and something is.
  bool complete() const { return kept.empty() && !changes.empty(); }
};

/// Both behind one another.
SceneTwin operator+(SceneTwin a, const SceneTwin& b);

/// Every body at `ratio` times as many cells or frames along each direction, rounded: grids by their cells, scattered
/// frames by their spacing or count (with the points among them and the reach of their weights), generated meshes by
/// their cells, meshes of files by halving or joining what `refine` cut. Gauss points of a cell stay. Rigid bodies and
/// surfaces have no resolution and are passed over.
///
/// A body stays where that cannot be done, or would change what is computed: a region names its nodes by their numbers,
/// a load is given by node, its frames or points are listed, its mesh has no coarser one.
/// @param ratio  > 0; above 1 finer
/// @param body  the only one that changes; otherwise all
SceneTwin resized(const Scene& scene, double ratio, const std::optional<std::string>& body = {});

/// The same with every cell cut into `factor` along each direction: nodes of the scene are nodes of its twin.
SceneTwin refined(const Scene& scene, int factor, const std::optional<std::string>& body = {});

/// The same with `factor` cells joined along each direction; a body whose cells do not come in such numbers stays.
SceneTwin coarsened(const Scene& scene, int factor, const std::optional<std::string>& body = {});

/// Linear elements become quadratic ones on the same cells.
SceneTwin raised_order(const Scene& scene, const std::optional<std::string>& body = {});

/// Dynamics with the time step times `factor`; duration and saved times stay.
/// @param step  the step that an automatic one stands for [s]; without it that stays
SceneTwin with_time_step(const Scene& scene, double factor, std::optional<double> step = {});

/// Newton's and the linear solver's tolerances at 1e-10, with the iterations that it takes.
SceneTwin solved_exactly(const Scene& scene);

/// All arithmetic in 64 bits.
SceneTwin in_double(const Scene& scene);

}  // namespace fascia::app
