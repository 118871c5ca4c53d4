#pragma once

#include "tests/support/scene_run.hpp"

#include <string>
#include <vector>

/// Cases whose true error is known, for the effectivity of estimated errors.
namespace fascia::effectivity_test {

using test::Settings;

struct Case {
  std::string name, scene;
  Settings settings;
  std::string probe;
  std::vector<std::size_t> components = {};  ///< that the reference knows, by columns of probes.csv; none: all
  std::vector<double> reference = {};
  std::string source;
  bool quick = false;        ///< part of every check
  Settings converged = {};   ///< in the place of a reference: the same run with this, for its error over time
  std::string outside = {};  ///< why the estimate is off by more than a factor of two
};

inline Settings operator+(Settings a, const Settings& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// The soft and the steel cantilever of every model; displacements of the tip (x, y) or y alone.
inline std::vector<Case> cantilevers() {
  const std::vector<double> soft{-1.5987, -6.50964}, stiffer{-0.12403, -1.86025}, lighter{-0.020134, -0.75081};
  const std::string solids = "20-node hexahedra of another program, h, h/2, h/4 and Richardson: ";
  const std::string b40 = solids + "1.5e-3 m", b160 = solids + "1.2e-4 m", g10 = solids + "6e-5 m";
  const std::string steel_source = solids + "3e-5 m";
  const Settings young{"materials.silicone.young='160 kPa'"}, tenth{"world.gravity=[0,-0.981,0]"};
  const auto grid = [](const char* g) { return Settings{std::string("bodies.beam.frames.grid=") + g}; };
  const auto cells = [](const char* c) { return Settings{std::string("bodies.beam.domain.box.cells=") + c}; };
  const Settings linear{"bodies.beam.order=1"}, affine{"bodies.beam.frames.kind='affine'"};
  const Settings of_steel{"materials.silicone.young='200 GPa'", "bodies.beam.mass=31200",
                          "bodies.beam.domain.box.min=[0,-0.25,-0.25]", "bodies.beam.domain.box.max=[16,0.25,0.25]"};
  const std::string hexahedra = "soft_cantilever_hexahedra", tetrahedra = "soft_cantilever_tetrahedra";
  return {
      {"soft, 9 x 3 x 3 frames", "soft_cantilever", grid("[9,3,3]"), "tip", {0, 1}, soft, b40},
      {"soft, 21 x 3 x 3 frames", "soft_cantilever", grid("[21,3,3]"), "tip", {0, 1}, soft, b40},
      {"160 kPa, 33 x 3 x 3 frames", "soft_cantilever", grid("[33,3,3]") + young, "tip", {0, 1}, stiffer, b160},
      {"a tenth of the weight, 33 x 4 x 4", "soft_cantilever", grid("[33,4,4]") + tenth, "tip", {0, 1}, lighter, g10},
      {"soft, 9 x 3 x 3 affine frames", "affine_cantilever", grid("[9,3,3]"), "tip", {0, 1}, soft, b40},
      {"soft, 21 x 3 x 3 affine frames", "affine_cantilever", {}, "tip", {0, 1}, soft, b40},
      {"soft, scattered frames",
       "scattered_cantilever",
       {"bodies.beam.frames.poisson_disk=0.7"},
       "tip",
       {0, 1},
       soft,
       b40},
      {"soft, 20-node hexahedra", hexahedra, {}, "tip", {0, 1}, soft, b40},
      {"160 kPa, 20-node hexahedra", hexahedra, young, "tip", {0, 1}, stiffer, b160},
      {"a tenth of the weight, 8 x 2 x 2", hexahedra, tenth + cells("[8,2,2]"), "tip", {0, 1}, lighter, g10},
      {"soft, small displacements",
       hexahedra,
       {"bodies.beam.formulation='linear'"},
       "tip",
       {1},
       {-7.5222},
       solids + "8e-4 m"},
      {"soft, 8-node hexahedra 20 x 2 x 2", hexahedra, linear + cells("[20,2,2]"), "tip", {0, 1}, soft, b40, true},
      {"soft, 8-node hexahedra 32 x 4 x 4", hexahedra, linear + cells("[32,4,4]"), "tip", {0, 1}, soft, b40},
      {"soft, ten-node tetrahedra", tetrahedra, {}, "tip", {0, 1}, soft, b40},
      {"soft, four-node tetrahedra 20 x 2 x 2", tetrahedra, linear + cells("[20,2,2]"), "tip", {0, 1}, soft, b40},
      {"soft, four-node tetrahedra 32 x 4 x 4", tetrahedra, linear + cells("[32,4,4]"), "tip", {0, 1}, soft, b40},
      {"steel, 25 x 3 x 3 frames", "steel_cantilever", grid("[25,3,3]"), "tip", {1}, {-0.15016}, steel_source},
      {"steel, 25 x 5 x 5 frames", "steel_cantilever", {}, "tip", {1}, {-0.15016}, steel_source},
      {"steel, 25 x 3 x 3 affine frames",
       "steel_cantilever",
       grid("[25,3,3]") + affine,
       "tip",
       {1},
       {-0.15016},
       steel_source},
      {"steel, 20-node hexahedra", hexahedra, of_steel, "tip", {1}, {-0.15016}, steel_source},
      {"steel, ten-node tetrahedra", tetrahedra, of_steel, "tip", {1}, {-0.15016}, steel_source},
      {"steel, frequencies, 25 x 3 x 3 frames",
       "beam_modes",
       grid("[25,3,3]") + Settings{"solver.count=4"},
       "frequency",
       {},
       {1.5988, 1.5988, 9.974, 9.974},
       solids + "1e-3 of them"},
  };
}

/// Panels, rods, plates, shells, a hollow sphere.
inline std::vector<Case> others() {
  const std::string elastica = "Bisshopp and Drucker 1945", plate = "solid elements, the same law: 2e-3 of it";
  const auto rods = [](int n) { return Settings{"bodies.rod.frames.grid=[" + std::to_string(n) + "]"}; };
  const auto panel = [](const char* c) { return Settings{std::string("bodies.panel.domain.block.cells=") + c}; };
  // (λ + 2 μ) l (l² − 1) / 2 = ρ g (L − X), integrated by Simpson's rule.
  const std::vector<double> column{0.02519943, 0,          0, 0.15474990, 0,          0, 0.24311044, 0,
                                   0,          0.28225771, 0, 0,          0.28315262, 0, 0};
  return {
      {"Cook, linear, top, 4 x 4", "cook_linear", panel("[4,4,1]"), "top", {1}, {25.178}, "literature, 5 digits", true},
      {"Cook, linear, middle, 8 x 8", "cook_linear", panel("[8,8,1]"), "middle", {1}, {23.963}, "literature, 5 digits"},
      {"Cook, neo-Hookean, top",
       "cook_neo_hookean",
       panel("[8,8,1]"),
       "top",
       {1},
       {6.1469},
       "B. Mueller, thesis, 2015"},
      {"Cook, neo-Hookean, 8-node hexahedra",
       "cook_neo_hookean",
       {"bodies.panel.order=1"},
       "top",
       {1},
       {6.1469},
       "B. Mueller, thesis, 2015"},
      {"hollow sphere, inside", "hollow_sphere", {}, "inside", {0}, {4e-6}, "Lame"},
      {"clamped traction, force",
       "traction_clamped",
       {},
       "pull",
       {0},
       {1.0181 * 1570.796},
       "20-node hexahedra of another program: 2e-3 of it"},
      {"clamped traction, radius",
       "traction_clamped",
       {},
       "surface",
       {13},
       {-1.5268e-4},
       "20-node hexahedra of another program: 2e-3 of it"},
      {"hanging column", "hanging_column", {}, "along", {}, column, "closed form"},
      {"line, end force", "line_cantilever", {}, "tip", {1}, {1e-6}, "P L^3 / (3 E I), shear neglected: 2e-4", true},
      {"elastica, tip, 11 frames", "elastica", rods(11), "tip", {0, 1}, {0.4450044, 0.8106090}, elastica, true},
      {"elastica, slope, 21 frames", "elastica", rods(21), "slope", {2}, {1.430286}, elastica},
      {"roll-up, moment", "roll_up", {}, "moment", {2}, {-4.91539e-3}, "closed form"},
      {"plate, 21 x 21", "square_plate", {}, "center", {2}, {-0.01175}, plate},
      {"plate, small load, 11 x 11",
       "square_plate",
       {"loads[0].total_force=[0,0,-1e-3]", "bodies.plate.frames.grid=[11,11]"},
       "center",
       {2},
       {-6.96e-5},
       plate,
       true},
      {"roof, 8 x 8",
       "shell_roof",
       {"bodies.roof.domain.cylinder.cells=[8,8]"},
       "edge",
       {2},
       {-0.3014e-3},
       "solid elements, 2e-5"},
      {"pinched cylinder, 8 x 8",
       "shell_pinched_cylinder",
       {"bodies.cylinder.domain.cylinder.cells=[8,8]"},
       "load",
       {2},
       {-1.8248e-5},
       "Belytschko et al. 1985"},
      {"hemisphere of a file",
       "shell_hemisphere",
       {},
       "load",
       {0},
       {9.37e-5},
       "solid elements, 2e-3 of it",
       false,
       {},
       "the file's facets stay flat when they are cut, and bend about their edges"},
      {"slit ring, 4 x 32",
       "shell_slit_plate",
       {"bodies.plate.domain.annulus.cells=[4,32]"},
       "outer",
       {2},
       {17.528},
       "Sze, Liu and Lo 2004"},
      {"plate of shells, frequencies",
       "shell_plate_modes",
       {"solver.count=3"},
       "frequency",
       {},
       {0.27408, 0.5590, 0.5590},
       "Leissa 1969"},
  };
}

/// The error over time alone, against the same scheme with a sixteenth of the step or less.
inline std::vector<Case> dynamics() {
  const Settings sixteenth{"solver.time_step=0.000625", "solver.steps=", "solver.duration=1",
                           "output.every_steps=", "output.every=0.1"};
  const Settings coarse{"output.estimate='coarser'"};  // only the step counts here
  const auto struck = [&](const char* kind, const char* probe) {
    return Case{std::string("struck beam, ") + kind,
                "struck_beam",
                coarse + Settings{std::string("solver.kind='") + kind + "'"},
                probe,
                {},
                {},
                "a sixteenth of the step",
                false,
                sixteenth};
  };
  std::vector<double> fall;
  for (int i = 0; i < 3; ++i) fall.insert(fall.end(), {0, -9.81 / 2, 0});
  return {
      {"free fall", "free_fall", coarse, "points", {}, fall, "g t^2 / 2"},
      struck("implicit-euler", "tip"),
      struck("bdf2", "tip"),
      struck("newmark", "tip"),
      struck("midpoint", "tip"),
      {"swinging line",
       "line_swing",
       {"output.every_steps=", "output.every=0.1"},
       "tip",
       {},
       {},
       "a twentieth of the step",
       true,
       {"solver.time_step=0.001"}},
      {"settling beam, 4 s",
       "settling_beam",
       coarse + Settings{"solver.duration=4", "output.every=0.5"},
       "tip",
       {},
       {},
       "a twentieth of the step",
       false,
       {"solver.time_step=0.005"}},
      {"spinning block",
       "midpoint_spin",
       {"output.every=0.1"},
       "points",
       {},
       {},
       "a twentieth of the step",
       false,
       {"solver.time_step=0.00025"}},
      {"explicit beam",
       "explicit_cantilever",
       {},
       "tip",
       {},
       {},
       "a sixteenth of the step",
       false,
       {"solver.time_step=0.0000625"}},
  };
}

}  // namespace fascia::effectivity_test
