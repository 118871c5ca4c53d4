#include "core/structure/face_rule.hpp"

#include "core/base/index.hpp"

#include <cmath>
#include <utility>
#include <vector>

namespace fascia {

namespace {

/// @param L  area coordinates
FaceRulePoint triangle_point(bool quadratic, const std::array<double, 3>& L, double weight) {
  constexpr std::array<double, 3> s{-1, 1, 0}, t{-1, 0, 1};  // of the area coordinates
  FaceRulePoint p;
  p.weight = 0.5 * weight;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const double slope = quadratic ? 4 * L[i] - 1 : 1;
    p.N[i] = quadratic ? L[i] * (2 * L[i] - 1) : L[i];
    p.ds[i] = slope * s[i];
    p.dt[i] = slope * t[i];
    if (!quadratic) continue;
    p.N[3 + i] = 4 * L[i] * L[j];
    p.ds[3 + i] = 4 * (s[i] * L[j] + L[i] * s[j]);
    p.dt[3 + i] = 4 * (t[i] * L[j] + L[i] * t[j]);
  }
  return p;
}

FaceRulePoint quadrilateral_point(bool quadratic, double s, double t, double weight) {
  constexpr std::array<double, 8> sn{-1, 1, 1, -1, 0, 1, 0, -1}, tn{-1, -1, 1, 1, -1, 0, 1, 0};
  FaceRulePoint p;
  p.weight = weight;
  for (std::size_t i = 0; i < 4; ++i) {
    const double a = 1 + s * sn[i], b = 1 + t * tn[i], c = s * sn[i] + t * tn[i] - 1;
    p.N[i] = quadratic ? a * b * c / 4 : a * b / 4;
    p.ds[i] = quadratic ? sn[i] * b * (c + a) / 4 : sn[i] * b / 4;
    p.dt[i] = quadratic ? tn[i] * a * (c + b) / 4 : tn[i] * a / 4;
  }
  for (std::size_t i = 4; quadratic && i < 8; ++i) {
    const bool along_s = sn[i] == 0;  // the edge that the node is the middle of
    const double a = 1 + s * sn[i], b = 1 + t * tn[i], bubble = along_s ? 1 - s * s : 1 - t * t;
    p.N[i] = bubble * (along_s ? b : a) / 2;
    p.ds[i] = along_s ? -s * b : sn[i] * bubble / 2;
    p.dt[i] = along_s ? tn[i] * bubble / 2 : -t * a;
  }
  return p;
}

using Rule = std::vector<FaceRulePoint>;

/// Three points, exact for degree 2.
Rule linear_triangle() {
  Rule rule;
  for (std::size_t i = 0; i < 3; ++i) {
    std::array<double, 3> L{1.0 / 6, 1.0 / 6, 1.0 / 6};
    L[i] = 2.0 / 3;
    rule.push_back(triangle_point(false, L, 1.0 / 3));
  }
  return rule;
}

/// Twelve points, exact for degree 6 (Dunavant 1985).
Rule quadratic_triangle() {
  Rule rule;
  for (const auto& [a, w] :
       {std::pair{0.063089014491502, 0.050844906370207}, std::pair{0.249286745170910, 0.116786275726379}})
    for (std::size_t i = 0; i < 3; ++i) {
      std::array<double, 3> L{a, a, a};
      L[i] = 1 - 2 * a;
      rule.push_back(triangle_point(true, L, w));
    }
  constexpr double a = 0.053145049844817, b = 0.310352451033784;
  for (std::size_t i = 0; i < 3; ++i)
    for (const bool turned : {false, true}) {
      std::array<double, 3> L{};
      L[i] = a;
      L[(i + 1) % 3] = turned ? b : 1 - a - b;
      L[(i + 2) % 3] = turned ? 1 - a - b : b;
      rule.push_back(triangle_point(true, L, 0.082851075618374));
    }
  return rule;
}

/// Gauss points: 2 × 2, exact for degree 3 in each direction; quadratic 4 × 4, exact for degree 7.
Rule quadrilateral(bool quadratic) {
  std::vector<std::pair<double, double>> line{{-std::sqrt(1.0 / 3), 1}, {std::sqrt(1.0 / 3), 1}};
  if (quadratic) {
    const double r = 2 * std::sqrt(6.0 / 5) / 7, near = std::sqrt(3.0 / 7 - r), far = std::sqrt(3.0 / 7 + r);
    const double wn = (18 + std::sqrt(30.0)) / 36, wf = (18 - std::sqrt(30.0)) / 36;
    line = {{-far, wf}, {-near, wn}, {near, wn}, {far, wf}};
  }
  Rule rule;
  for (const auto& [s, ws] : line)
    for (const auto& [t, wt] : line) rule.push_back(quadrilateral_point(quadratic, s, t, ws * wt));
  return rule;
}

}  // namespace

std::span<const FaceRulePoint> face_rule(int nodes) {
  static const std::array<Rule, 4> rules{linear_triangle(), quadrilateral(false), quadratic_triangle(),
                                         quadrilateral(true)};
  return rules[nodes == 3 ? 0U : nodes == 4 ? 1U : nodes == 6 ? 2U : 3U];
}

}  // namespace fascia
