#include "fem/quadrature.hpp"

#include <array>
#include <span>

namespace fascia {
namespace {

struct LinePoint {
  double x, weight;
};

std::vector<QuadraturePoint> cube_rule(std::span<const LinePoint> line) {
  std::vector<QuadraturePoint> points;
  for (const LinePoint& c : line)
    for (const LinePoint& b : line)
      for (const LinePoint& a : line) points.push_back({{{a.x, b.x, c.x}}, a.weight * b.weight * c.weight, {}, {}});
  return points;
}

std::vector<QuadraturePoint> places_of_rule(ElementShape shape) {
  constexpr double a = 0.58541019662496852, b = 0.13819660112501048;    // (5 ± k√5)/20, k = 3 and −1
  constexpr double g2 = 0.57735026918962576, g3 = 0.77459666924148338;  // 1/√3, √(3/5)
  constexpr std::array<LinePoint, 2> two{{{-g2, 1}, {g2, 1}}};
  constexpr std::array<LinePoint, 3> three{{{-g3, 5.0 / 9}, {0, 8.0 / 9}, {g3, 5.0 / 9}}};
  switch (shape) {
    case ElementShape::tet4:
      return {{{{0.25, 0.25, 0.25}}, 1.0 / 6, {}, {}}};
    case ElementShape::tet10:
      return {{{{b, b, b}}, 1.0 / 24, {}, {}},
              {{{a, b, b}}, 1.0 / 24, {}, {}},
              {{{b, a, b}}, 1.0 / 24, {}, {}},
              {{{b, b, a}}, 1.0 / 24, {}, {}}};
    case ElementShape::hex8:
      return cube_rule(two);
    case ElementShape::hex20:
      return cube_rule(three);
  }
  return {};
}

std::vector<QuadraturePoint> rule_of(ElementShape shape) {
  std::vector<QuadraturePoint> rule = places_of_rule(shape);
  for (QuadraturePoint& q : rule) {
    q.N = shape_values(shape, q.xi);
    q.dN = shape_gradients(shape, q.xi);
  }
  return rule;
}

}  // namespace

const std::vector<QuadraturePoint>& quadrature(ElementShape shape) {
  static const std::array<std::vector<QuadraturePoint>, 4> rules{
      rule_of(ElementShape::tet4), rule_of(ElementShape::tet10), rule_of(ElementShape::hex8),
      rule_of(ElementShape::hex20)};
  return rules[static_cast<std::size_t>(shape)];
}

}  // namespace fascia
