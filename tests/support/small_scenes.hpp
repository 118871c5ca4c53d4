#pragma once

#include "app/reader/parse.hpp"
#include "assembly/build/build_simulation.hpp"
#include "assembly/simulation/simulation.hpp"
#include "tests/support/cases.hpp"
#include "tests/support/paths.hpp"

#include <map>
#include <string>
#include <vector>

namespace fascia::test {

/// A scene of this project for comparisons that any size of it serves: those whose solution takes seconds are a few
/// times smaller, unless tests run in full size.
/// @param scene     name of a file under scenes/, without ".toml"
/// @param settings  as after --set
/// @throws FileError  where a mesh is not there
inline Simulation small_scene(const std::string& scene, const std::vector<std::string>& settings = {}) {
  static const std::map<std::string, std::vector<std::string>> smaller{
      {"affine_cantilever", {"bodies.beam.frames.grid=[9,3,3]"}},
      {"bone_plate", {"bodies.bone.domain.cylinder.cells=[8,10]", "bodies.cushion.frames.poisson_disk=0.013"}},
      {"contracting_muscle", {"bodies.muscle.frames.grid=[7,3,3]", "solver.duration=0.4"}},
      {"free_fall", {"bodies.beam.frames.grid=[6,3,3]"}},
      {"relaxing_ligament", {"bodies.ligament.domain.box.cells=[4,2,1]", "solver.duration=0.3"}},
      {"riding_surface", {"bodies.skin.domain.ellipsoid.cells=[40]", "bodies.organ.frames.poisson_disk=0.03"}},
      {"roll_up", {"bodies.line.frames.grid=[21]"}},
      {"settling_beam", {"bodies.beam.frames.grid=[6,3,3]"}},
      {"soft_cantilever", {"bodies.beam.frames.grid=[13,3,3]"}},
      {"soft_cantilever_tetrahedra", {"bodies.beam.domain.box.cells=[8,2,2]"}},
      {"struck_beam", {"bodies.beam.frames.grid=[6,3,3]"}},
      {"traction_clamped", {"bodies.cylinder.frames.grid=[9,4,4]"}},
      {"uterus_bladder",
       {"bodies.uterus.domain.ellipsoid.cells=[12]", "bodies.bladder.domain.ellipsoid.cells=[12]",
        "bodies.tissue.points.count=300"}}};
  std::vector<std::string> all;
  if (const auto found = smaller.find(scene); !full_size() && found != smaller.end()) all = found->second;
  all.insert(all.end(), settings.begin(), settings.end());
  return build_simulation(app::parse_scene_file(source_dir() / "scenes" / (scene + ".toml"), all));
}

}  // namespace fascia::test
