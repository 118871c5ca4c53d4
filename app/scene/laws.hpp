#pragma once

#include "core/physics/law.hpp"

#include <array>
#include <optional>
#include <span>
#include <string_view>

namespace fascia::app {

/// A constant that a law has of its own, as a key of a material.
struct LawKey {
  const char *name, *unit, *meaning;
  bool needed;  ///< otherwise 0 where it is missing
};

inline constexpr std::array kMooneyRivlinKeys = {
    LawKey{"c10", "Pa", "factor of I1 - 3. `c10` + `c01` is half the shear modulus.", true},
    LawKey{"c01", "Pa", "factor of I2 - 3.", true}, LawKey{"c20", "Pa", "factor of (I1 - 3)^2.", false},
    LawKey{"c11", "Pa", "factor of (I1 - 3)(I2 - 3).", false}, LawKey{"c02", "Pa", "factor of (I2 - 3)^2.", false}};

/// A law of `material.law`, in the words of a scene. Without constants of its own it takes Young's modulus and
/// Poisson's ratio or Lamé's parameters; with them, these and `bulk`.
struct LawWord {
  Law law;
  const char *word, *meaning;
  std::span<const LawKey> own{};  ///< in the law's order
  /// μ of small strain, by its own constants [Pa]
  double (*shear_modulus)(std::span<const double> own) = nullptr;
};

inline constexpr std::array kMaterialLaws = {
    LawWord{Law::st_venant_kirchhoff, "st-venant-kirchhoff",
            "Linear between Green-Lagrange strain and second Piola-Kirchhoff stress."},
    LawWord{Law::neo_hookean, "neo-hookean",
            "Compressible: stiffens as it is compressed to nothing. Not for thin meshless bodies, nor "
            "`formulation = \"corotational\"` or `\"linear\"`."},
    LawWord{Law::mooney_rivlin, "mooney-rivlin",
            "Given by `c10`, `c01`, if wanted `c20`, `c11`, `c02`, and `bulk`: c10 (I1 - 3) + c01 (I2 - 3) + c20 (I1 - "
            "3)^2 + "
            "c11 (I1 - 3)(I2 - 3) + c02 (I2 - 3)^2 of the strain without its change of volume, and "
            "bulk/2 (J - 1)^2. It may stand where `\"neo-hookean\"` may.",
            kMooneyRivlinKeys, [](std::span<const double> c) { return 2 * (c[0] + c[1]); }}};

constexpr const LawWord& law_word(Law law) {
  for (const LawWord& known : kMaterialLaws)
    if (known.law == law) return known;
  return kMaterialLaws[0];
}
constexpr const char* word(Law law) { return law_word(law).word; }
/// The key of a material by which it is made stiffer.
constexpr const char* stiffness_key(Law law) {
  const LawWord& known = law_word(law);
  return known.own.empty() ? "young" : known.own.front().name;
}

/// The first where there is none of that name, which the schema has refused.
constexpr Law material_law(std::string_view text) {
  for (const LawWord& known : kMaterialLaws)
    if (text == known.word) return known.law;
  return kMaterialLaws[0].law;
}

/// Shells, thin bodies and formulations of small strain do not take it: they know the first alone.
constexpr bool needs_large_strain(Law law) { return law != kMaterialLaws[0].law; }

}  // namespace fascia::app
