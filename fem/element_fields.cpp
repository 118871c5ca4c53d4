#include "core/base/index.hpp"
#include "core/base/throwing_loops.hpp"
#include "core/math/polar.hpp"
#include "core/physics/element_law.hpp"
#include "fem/element_body.hpp"
#include "fem/quadrature.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

/// Places, strains and stresses of finite elements, for results.
namespace fascia {

Attachment ElementBody::attachment(std::size_t e, const ElementPoint& place) const {
  const auto nodes = mesh().element(e);
  std::array<std::size_t, kMostElementNodes> places;
  const std::span order = std::span(places).first(nodes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return nodes[a] < nodes[b]; });
  Attachment a;
  a.cell = static_cast<int>(e);
  a.nodes.reserve(nodes.size());
  a.influences.reserve(nodes.size());
  for (const std::size_t k : order) {
    a.nodes.push_back(first_node_ + nodes[k]);
    a.influences.push_back({place.N[k], place.dN_dX[k], {}, {}});
  }
  return a;
}

Attachment ElementBody::attach(const Vec3d& X) const {
  const Located l = locator_.locate(X);
  return attachment(at(l.element), shape_at(mesh(), at(l.element), l.xi));
}

Attachment ElementBody::attach_point(std::size_t point) const {
  const std::vector<QuadraturePoint>& rule = quadrature(mesh().shape);
  const std::size_t e = point / rule.size();
  return attachment(e, shape_at_point(mesh(), e, rule[point % rule.size()]));
}

Attachment ElementBody::attach_surface(std::size_t point) const {
  Attachment a;
  a.nodes = {first_node_ + static_cast<int>(point)};
  a.influences.resize(1);
  a.influences[0].w = 1;
  return a;
}

/// ∂u/∂X at each integration point of an element; zero where it has no volume.
ElementBody::PointGradients ElementBody::gradients_in(std::size_t e, const State& state) const {
  PointGradients H;
  const auto nodes = mesh().element(e);
  const Vec3d& origin = mesh().nodes[at(nodes[0])];
  std::size_t q = 0;
  for (const QuadraturePoint& place : quadrature(mesh().shape)) {
    Mat3d J, G;  // ∂X/∂ξ, ∂u/∂ξ
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      J += outer(mesh().nodes[at(nodes[n])] - origin, place.dN[n]);
      G += outer(state.u[at(first_node_ + nodes[n])], place.dN[n]);
    }
    H[q++] = determinant(J) == 0 ? Mat3d{} : G * inverse(J);
  }
  return H;
}

ElementBody::Strained ElementBody::strained(std::size_t e, const PointGradients& gradients) const {
  const std::size_t points = points_.size() / mesh().size();
  Strained s;
  Mat3d mean;
  double volume = 0;
  for (std::size_t k = 0; k < points; ++k) {
    const Mat3d& H = gradients[k];
    const double v = points_[points * e + k].volume;
    mean += H * v;
    s.swelling += volume_change(H) * v;
    volume += v;
  }
  s.swelling /= volume;
  if (formulation_ == ElementFormulation::corotational) s.turn = nearest_rotation_increment(mean * (1 / volume));
  return s;
}

/// Of each element, averaged about its nodes as the mechanics does, law by law; empty where nothing is averaged.
std::vector<ElementBody::Averaged> ElementBody::averages(const State& state) const {
  if (!averaged_) return {};
  const std::size_t n = mesh().nodes.size();
  std::vector<Averaged> result(mesh().size());
  for (const Law law : kSolidLaws) {
    std::vector<double> theta(n), volume(n);
    std::vector<VolumetricMean> modulus(n);
    for (std::size_t e = 0; e < mesh().size(); ++e) {
      if (points_[e].law != law) continue;
      const Mat3d H = gradients_in(e, state)[0];
      const double strain = with_solid_law(law, [&]<Law L>() { return SolidLaw<L, double>::volumetric_strain(H); });
      for (const int node : mesh().element(e)) {
        theta[at(node)] += strain * points_[e].volume;
        volume[at(node)] += points_[e].volume;
        modulus[at(node)].add(volumetric_modulus(law, lasting_constants(points_[e])), points_[e].volume);
      }
    }
    for (std::size_t e = 0; e < mesh().size(); ++e) {
      if (points_[e].law != law) continue;
      for (const int node : mesh().element(e)) {
        const double mean = theta[at(node)] / volume[at(node)], stiffness = modulus[at(node)].value();
        result[e].pressure += 0.25 * stiffness * mean;
        result[e].energy_density += 0.125 * stiffness * mean * mean;
      }
    }
  }
  return result;
}

/// @param past  what the point remembers, or makes by itself, added to what never fades
PointTensors ElementBody::tensors_of(std::size_t point, const Mat3d& H, const RememberedStress& past,
                                     const Strained& element, const std::optional<Averaged>& averaged) const {
  const LawConstants p = lasting_constants(points_[point]), relaxing = relaxing_constants(points_[point]);
  const double pull = penalty_ * element.swelling * std::abs(element.swelling);
  const double penalty_energy = penalty_ * std::pow(std::abs(element.swelling), 3) / 3;
  const StVenantKirchhoff<double> law{p.lambda, p.mu}, fading{relaxing.lambda, relaxing.mu};
  PointTensors t;
  t.strain = green_strain(H);
  if (formulation_ == ElementFormulation::linear) {
    t.stress = law.second_piola(sym(H)) + past.at(fading.second_piola(sym(H))) + past.active;
    t.energy_density = law.energy_density(sym(H));
  } else if (formulation_ == ElementFormulation::corotational) {
    const Mat3d R = Mat3d::identity() + element.turn;
    const Mat3d strain = sym(transpose(element.turn) + H + transpose_times(element.turn, H));
    t.stress = times_transpose(R * (law.second_piola(strain) + past.at(fading.second_piola(strain)) + past.active), R);
    t.energy_density = law.energy_density(strain);
  } else {
    const Mat3d F = Mat3d::identity() + H;
    const Mat3d S = past.active + with_solid_law(points_[point].law, [&]<Law L>() {
                      using Solid = SolidLaw<L, double>;
                      const auto solid = make_law<Solid>(p);
                      t.energy_density =
                          averaged ? solid.shear_energy(H) + averaged->energy_density : energy_density(solid, H);
                      const double pressure =
                          averaged ? averaged->pressure : solid.volumetric_modulus() * Solid::volumetric_strain(H);
                      const Mat3d lasts = solid.second_piola(typename Solid::At(H), t.strain, pressure);
                      if (p.viscosity == nullptr) return lasts;
                      // Averages fade in all of their stress.
                      return lasts + past.at(averaged ? lasts * (1 / p.viscosity->long_term())
                                                      : second_piola(make_law<Solid>(relaxing), H));
                    });
    t.stress = times_transpose(F * S, F) * (1 / determinant(F));
  }
  t.stress += Mat3d::diagonal(pull);
  t.energy_density += penalty_energy;
  return t;
}

std::vector<Mat3d> ElementBody::gradients(const State& state) const {
  const auto points = static_cast<std::ptrdiff_t>(points_.size() / mesh().size());
  std::vector<Mat3d> all;
  all.reserve(points_.size());
  for (std::size_t e = 0; e < mesh().size(); ++e) {
    const PointGradients H = gradients_in(e, state);
    all.insert(all.end(), H.begin(), H.begin() + points);
  }
  return all;
}

void ElementBody::store_tensors(const State& state, ThreadPool& pool, std::span<PointTensors> out) const {
  constexpr int kGrain = 128;
  const std::vector<Averaged> average = averages(state);
  const std::size_t points = points_.size() / mesh().size();
  for_throwing_ranges(pool, static_cast<int>(mesh().size()), kGrain, [&](int begin, int end) {
    for (std::size_t e = at(begin); e < at(end); ++e) {
      const PointGradients H = gradients_in(e, state);
      const Strained element = strained(e, H);
      for (std::size_t q = points * e; q < points * (e + 1); ++q)
        out[q] = tensors_of(q, H[q - points * e], remembered(q, state), element,
                            average.empty() ? std::nullopt : std::optional(average[e]));
    }
  });
}

PointTensors ElementBody::tensors_at(const Attachment& place, std::size_t nearest, const State& state) const {
  return tensor_field(state)(place, nearest);
}

TensorField ElementBody::tensor_field(const State& state) const {
  return [this, &state, average = averages(state)](const Attachment& place, std::size_t nearest) {
    const std::size_t cell = at(place.cell);
    return tensors_of(nearest, field_at(place, state).H, remembered(nearest, state),
                      strained(cell, gradients_in(cell, state)),
                      average.empty() ? std::nullopt : std::optional(average[cell]));
  };
}

}  // namespace fascia
