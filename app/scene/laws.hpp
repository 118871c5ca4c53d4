#pragma once

#include "core/physics/law.hpp"

#include <array>
#include <optional>
#include <string_view>

namespace fascia::app {

/// A law of `material.law`, in the words of a scene.
struct LawWord {
  Law law;
  const char *word, *meaning;
};

inline constexpr std::array kMaterialLaws = {
    LawWord{Law::st_venant_kirchhoff, "st-venant-kirchhoff",
            "Linear between Green-Lagrange strain and second Piola-Kirchhoff stress."},
    LawWord{Law::neo_hookean, "neo-hookean",
            "Compressible: stiffens as it is compressed to nothing. Not for thin meshless bodies, nor "
            "`formulation = \"corotational\"` or `\"linear\"`."}};

constexpr const char* word(Law law) {
  for (const LawWord& known : kMaterialLaws)
    if (known.law == law) return known.word;
  return "";
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
