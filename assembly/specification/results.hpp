#pragma once

#include "assembly/specification/region.hpp"
#include "core/math/vec3.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Probes of a run, and the results that it writes.
namespace fascia {

enum class Quantity {
  displacement,
  position,
  rotation,
  velocity,
  strain,
  stress,  // at points
  force,
  moment,  // on constrained or loaded nodes
  volume,
  mass,
  energy,
  kinetic_energy,
  total_energy,
  momentum,
  angular_momentum,
  max_displacement,
  mean_displacement,
  frequency,
  fluid_volume,
  fluid_pressure
};

struct Probe {
  Place place{};
  std::string name{};
  std::optional<std::string> body{};
  Quantity quantity = Quantity::displacement;
  std::vector<Vec3d> at{};
  Place at_place{};
  bool at_is_list = false;  ///< `at` was a list of points: the value is a list
  std::optional<Region> where{};
  std::optional<Vec3d> about{};
};

struct Picture {
  Vec3d view{{1, 1, 1}};
  std::array<int, 2> size{1200, 800};
  std::string field = "von_mises";
  std::optional<std::array<double, 2>> range{};  ///< of the colours, in SI
};

/// Which other meshes estimate the errors of results: finer ones where they are small, else coarser ones.
enum class EstimateBy { automatic, finer, coarser };

struct Output {
  Place place{};
  std::filesystem::path directory{};
  double every = 0;     ///< [s]; 0: not given
  int every_steps = 0;  ///< 0: not given
  std::vector<std::string> fields{};
  std::optional<Picture> picture{};
  std::optional<EstimateBy> estimate{};  ///< none: errors are not estimated
  bool keeps_samples = true;             ///< of matter, for the next run
  std::filesystem::path cache{};         ///< where; empty: the user's cache
};

}  // namespace fascia
