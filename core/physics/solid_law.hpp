#pragma once

#include "core/physics/law.hpp"
#include "core/physics/mooney_rivlin.hpp"
#include "core/physics/neo_hookean.hpp"
#include "core/physics/small_strain.hpp"

#include <concepts>

/// Laws of solids, for points, elements and results, on the processor and the GPU: a struct of constants each, whose
/// energy density is that of distortion and of a volumetric strain θ,
///
///   ψ = ψ_μ(H) + k θ(H)²/2,   S = S_μ + p ∂θ/∂E   with p = k θ, or its average about nodes; k is λ, or of isochoric
/// laws the bulk modulus.
///
/// A new one is a header beside neo_hookean.hpp, a name in Law, and below a LawOf and a place in kSolidLaws; with its
/// type in tests/unit/core/laws_test.cpp it is held to its derivatives, objectivity and rest.
namespace fascia {

template <class L, class T>
concept IsSolidLaw = requires(const L law, const typename L::At at, const Mat3<T> M, const T p) {
  { L::kSmall } -> std::convertible_to<bool>;               ///< P = S, of small rotations
  { L::kOwn } -> std::convertible_to<int>;                  ///< constants beside λ and μ
  typename L::At;                                           ///< what stresses share at a state:
  { typename L::At(M) } -> std::same_as<typename L::At>;    ///< made of H = F − I
  { L::strain(M) } -> std::same_as<Mat3<T>>;                ///< E of H; of damping too
  { L::volumetric_strain(M) } -> std::same_as<T>;           ///< θ of H
  { L::volumetric_gradient(M) } -> std::same_as<Mat3<T>>;   ///< ∂θ/∂F at H
  { law.volumetric_modulus() } -> std::same_as<T>;          ///< k [Pa]
  { law.shear_energy(M) } -> std::same_as<T>;               ///< ψ_μ of H [J/m³]
  { law.second_piola(at, M, p) } -> std::same_as<Mat3<T>>;  ///< S of E and p [Pa]
  /// dS of dE, with k for dp; where not full, one that is never negative [Pa]
  { law.second_piola_differential(at, p, p, M, true) } -> std::same_as<Mat3<T>>;
};

template <Law L>
struct LawOf;
template <>
struct LawOf<Law::st_venant_kirchhoff> {
  template <class T>
  using Of = StVenantKirchhoff<T>;
};
template <>
struct LawOf<Law::neo_hookean> {
  template <class T>
  using Of = NeoHookean<T>;
};
template <>
struct LawOf<Law::mooney_rivlin> {
  template <class T>
  using Of = MooneyRivlin<T>;
};
template <>
struct LawOf<Law::linear> {
  template <class T>
  using Of = SmallStrain<T>;
};
template <>
struct LawOf<Law::corotational> : LawOf<Law::linear> {};  ///< in the element's axes
template <Law L, class T>
using SolidLaw = typename LawOf<L>::template Of<T>;

/// Those of large strain.
inline constexpr Law kSolidLaws[] = {Law::st_venant_kirchhoff, Law::neo_hookean, Law::mooney_rivlin};
inline constexpr int kSolidLawCount = sizeof(kSolidLaws) / sizeof(Law);

/// Calls act.operator()<L>() for a law of large strain.
template <int I = 0, class Act>
FASCIA_HD constexpr decltype(auto) with_solid_law(Law law, const Act& act) {
  constexpr Law kThis = kSolidLaws[I];
  static_assert(IsSolidLaw<SolidLaw<kThis, double>, double>);
  if constexpr (I + 1 < kSolidLawCount)
    if (law != kThis) return with_solid_law<I + 1>(law, act);
  return act.template operator()<kThis>();
}

/// Constants that a law has beside λ and μ.
constexpr int own_constant_count(Law law) {
  return is_of_points(law) ? with_solid_law(law, []<Law L>() { return int{SolidLaw<L, double>::kOwn}; }) : 0;
}
/// @throws InputError  the record lacks constants that its law has
void check_own_constants(Law law, const LawConstants& constants);
/// @param stiffness_damping  β [s], which a material that fades has none of
/// @throws InputError  shares or times that no material has, or that the law does not take
void check_viscosity(Law law, const Viscosity& viscosity, double stiffness_damping);

/// ψ [J/m³]
template <class T, template <class> class L>
FASCIA_HD T energy_density(const L<T>& law, const Mat3<T>& H) requires IsSolidLaw<L<T>, T> {
  const T theta = L<T>::volumetric_strain(H);
  return law.shear_energy(H) + T(0.5) * law.volumetric_modulus() * theta * theta;
}
/// Elastic S [Pa]
template <class T, template <class> class L>
FASCIA_HD Mat3<T> second_piola(const L<T>& law, const Mat3<T>& H) requires IsSolidLaw<L<T>, T> {
  return law.second_piola(typename L<T>::At(H), L<T>::strain(H), law.volumetric_modulus() * L<T>::volumetric_strain(H));
}
/// dS of dE at H [Pa]
template <class T, template <class> class L>
FASCIA_HD Mat3<T> second_piola_differential(const L<T>& law, const Mat3<T>& H,
                                            const Mat3<T>& dE) requires IsSolidLaw<L<T>, T> {
  const T k = law.volumetric_modulus();
  return law.second_piola_differential(typename L<T>::At(H), k * L<T>::volumetric_strain(H), k, dE, true);
}

}  // namespace fascia
