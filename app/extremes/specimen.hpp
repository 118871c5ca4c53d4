#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

/// The scenes of the map of extremes: one beam in every model, whose numbers the map changes.
namespace fascia::app {

enum class BeamModel {
  grid,
  scattered,
  affine,
  sheet,
  line,
  linear_tetrahedra,
  corotational_tetrahedra,
  tetrahedra,
  quadratic_tetrahedra,
  hexahedra,
  shell,
  coupled
};
inline constexpr std::array kModelNames{"grid",
                                        "scattered",
                                        "affine",
                                        "sheet",
                                        "line",
                                        "linear tetrahedra",
                                        "corotational tetrahedra",
                                        "tetrahedra",
                                        "quadratic tetrahedra",
                                        "hexahedra",
                                        "shell",
                                        "coupled"};
std::string name_of(BeamModel model);
bool is_element(BeamModel model);  ///< of tetrahedra or hexahedra alone
bool is_thin(BeamModel model);     ///< of a surface or a line

/// Loads and motions of the beam, which is held at x = 0.
enum class Action {
  bend,      ///< force F = amount 3 E I / L^2 at the far end: moves it by amount L in linear theory
  weight,    ///< gravity across, such that it moves by about amount L
  pull,      ///< force F = amount E A along the beam
  stretch,   ///< the far end is moved to amount times the length; where that presses, a little weight acts across
  twist,     ///< the far end is turned about the beam by amount [rad]
  compress,  ///< of a column 20 times as long as thick: dead force of amount Euler loads along the beam, and a
             ///< thousandth of it across
  push  ///< of the same column: pressure of amount Euler loads on the far end, which turns with it, and the same across
};

/// A beam along x of rectangular section, bent about y, in which no direction across is like another: what buckles
/// does so in one plane. The base cell is what stands here.
struct Specimen {
  BeamModel model = BeamModel::grid;
  bool dynamic = false;  ///< ten steps of implicit Euler from rest; else statics
  bool cg = false;       ///< conjugate gradients; else Cholesky
  double young = 1e4;    ///< [Pa]
  double poisson = 0.3;
  double density = 1000;          ///< [kg/m3]
  double length = 0.1;            ///< [m]
  double slenderness = 0;         ///< length / thickness; 0: 4 of solids and lines, 20 of their columns, 40 of surfaces
  double time_step = 0.01;        ///< [s]
  double stiffness_contrast = 1;  ///< Young's modulus of the far half / of the near one
  double density_contrast = 1;    ///< likewise; of the coupled model
  double taper = 1;               ///< thickness at the near end / at the far one, of elements; of shells the width
                                  ///< likewise: cells become slivers
  Action action = Action::bend;
  double amount = 0.01;
  bool held = true;
  bool neo_hookean = false;  ///< the law; else St Venant-Kirchhoff

  double thickness() const;
  double width() const;
  double section() const;        ///< A [m2]
  double second_moment() const;  ///< I [m4]

  /// The scene, a TOML text in SI.
  std::string text() const;

  /// False where a uniform bar would ask more than its law bears: where St Venant-Kirchhoff's is not strongly elliptic
  /// in the bar that is pressed, or at the edges of the one that is twisted, whose free faces are in pure shear strain;
  /// or where the bar is pulled until no section is left, which the co-rotational law does not bear either.
  bool is_borne() const;

  /// Size of the far end's displacement in the theory of slender beams [m], where it holds: small strain, one material.
  std::optional<double> theory() const;
};

}  // namespace fascia::app
