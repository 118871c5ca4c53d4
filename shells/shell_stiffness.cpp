#include "shells/shell_stiffness.hpp"

#include <algorithm>
#include <cmath>

namespace fascia {

namespace {

using Matrix3 = std::array<std::array<double, 3>, 3>;

constexpr double kAlpha = 1.5;  ///< of OPT's mean strain
/// Where the surface is curved, inextensional bending turns the corners out of the triangle's plane by the tilt, and
/// the deviations' stiffness, 12 β (tilt · size / thickness)² of the bending one, would lock
/// (docs/decisions/shell_formulation.md).
constexpr double kCurvature = 100;
constexpr double kLeastBeta = 0.01;  ///< of OPT's deviations: at ν = ½ rotations would be free
constexpr double kShearCorrection = 5.0 / 6;

std::size_t next(std::size_t k) { return (k + 1) % 3; }
std::size_t previous(std::size_t k) { return (k + 2) % 3; }

double side_squared(const PlaneTriangle& p, std::size_t from) {
  const auto &a = p[from], &b = p[next(from)];
  return (b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]);
}

/// Deviation of the strains along the three sides from their mean, for unit rotations, at corner `corner`
/// (Felippa 2003, eq. 24: Q₁, Q₂, Q₃).
Matrix3 side_deviations(const PlaneTriangle& p, double area, std::size_t corner) {
  constexpr std::array<std::array<double, 9>, 3> beta{
      {{1, 2, 1, 0, 1, -1, -1, -1, -2}, {-2, -1, -1, 1, 1, 2, -1, 0, 1}, {1, -1, 0, -1, -2, -1, 2, 1, 1}}};
  Matrix3 Q{};
  for (std::size_t side = 0; side < 3; ++side)
    for (std::size_t a = 0; a < 3; ++a) Q[side][a] = 2 * area / 3 * beta[corner][3 * side + a] / side_squared(p, side);
  return Q;
}

/// Strains ε₁₁, ε₂₂, 2ε₁₂ from those along the sides.
Matrix3 from_sides(const PlaneTriangle& p, double area) {
  const auto x = [&](std::size_t i, std::size_t j) { return p[i][0] - p[j][0]; };
  const auto y = [&](std::size_t i, std::size_t j) { return p[i][1] - p[j][1]; };
  const double s = 1 / (4 * area * area);
  Matrix3 T{};
  for (std::size_t side = 0; side < 3; ++side) {
    const std::size_t i = side, j = next(side), k = previous(side);
    const double f = s * side_squared(p, side);
    T[0][side] = y(j, k) * y(i, k) * f;
    T[1][side] = x(j, k) * x(i, k) * f;
    T[2][side] = (y(j, k) * x(k, i) + x(k, j) * y(i, k)) * f;
  }
  return T;
}

Matrix3 product(const Matrix3& A, const Matrix3& B) {
  Matrix3 C{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) C[i][j] += A[i][k] * B[k][j];
  return C;
}

/// out += weight Bᵀ C B, packed. @param n  rows of B
template <std::size_t N>
void add_square(const double (&B)[N][6], const std::array<std::array<double, N>, N>& C, double weight, double* out) {
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j) {
      double sum = 0;
      for (std::size_t a = 0; a < N; ++a)
        for (std::size_t b = 0; b < N; ++b) sum += B[a][i] * C[a][b] * B[b][j];
      out[i * (i + 1) / 2 + j] += weight * sum;
    }
}

void add_membrane(const PlaneTriangle& p, const ShellSection& section, double area, double* out) {
  const Matrix3 C = plane_stress(section);
  const Matrix3 drilling = drilling_strains(p);
  double mean[3][6]{};
  for (std::size_t i = 0; i < 3; ++i) {
    mean[i][i] = 1;
    for (std::size_t a = 0; a < 3; ++a) mean[i][3 + a] = drilling[i][a];
  }
  const double volume = area * section.thickness;
  add_square(mean, C, volume, out);
  const double optimal = std::max(kLeastBeta, 0.5 * (1 - 4 * section.poisson * section.poisson));
  const double beta = std::max(
      kLeastBeta * optimal, optimal / (1 + kCurvature * section.tilt * area / (section.thickness * section.thickness)));
  const Matrix3 T = from_sides(p, area);
  std::array<Matrix3, 3> Q;
  for (std::size_t corner = 0; corner < 3; ++corner) Q[corner] = product(T, side_deviations(p, area, corner));
  for (std::size_t corner = 0; corner < 3; ++corner) {  // at the middles of the sides
    double deviation[3][6]{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t a = 0; a < 3; ++a) deviation[i][3 + a] = 0.5 * (Q[corner][i][a] + Q[next(corner)][i][a]);
    add_square(deviation, C, 0.75 * beta * volume, out);
  }
}

}  // namespace

LinearGradients linear_gradients(const PlaneTriangle& p) {
  LinearGradients l;
  const auto cross = [](double ax, double ay, double bx, double by) { return ax * by - ay * bx; };
  l.area = 0.5 * cross(p[1][0] - p[0][0], p[1][1] - p[0][1], p[2][0] - p[0][0], p[2][1] - p[0][1]);
  for (std::size_t a = 0; a < 3; ++a)
    l.g[a] = {(p[next(a)][1] - p[previous(a)][1]) / (2 * l.area), (p[previous(a)][0] - p[next(a)][0]) / (2 * l.area)};
  return l;
}

std::array<std::array<double, 3>, 3> plane_stress(const ShellSection& s) {
  const double c = s.young / (1 - s.poisson * s.poisson);
  return {{{c, c * s.poisson, 0}, {c * s.poisson, c, 0}, {0, 0, 0.5 * c * (1 - s.poisson)}}};
}

std::array<std::array<double, 3>, 3> drilling_strains(const PlaneTriangle& p) {
  const double area = linear_gradients(p).area;
  Matrix3 B{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t j = next(a), k = previous(a);
    const auto x = [&](std::size_t m, std::size_t n) { return p[m][0] - p[n][0]; };
    const auto y = [&](std::size_t m, std::size_t n) { return p[m][1] - p[n][1]; };
    const double s = kAlpha / (12 * area);
    B[0][a] = s * y(j, k) * (y(a, k) - y(j, a));
    B[1][a] = s * x(k, j) * (x(k, a) - x(a, j));
    B[2][a] = 2 * s * (x(k, a) * y(a, k) - x(a, j) * y(j, a));
  }
  return B;
}

PlateStrains plate_strains(const PlaneTriangle& p, const ShellSection& section, const std::array<double, 3>& L) {
  const LinearGradients linear = linear_gradients(p);
  // The normal's slopes β₁ = θ_y, β₂ = −θ_x; along a side also 4 L_i L_j Δβ (cos, sin).
  PlateStrains s;
  const auto add = [&](double b1_1, double b1_2, double b2_1, double b2_2, std::size_t dof, double value) {
    s.curvature[0][dof] += b1_1 * value;
    s.curvature[1][dof] += b2_2 * value;
    s.curvature[2][dof] += (b1_2 + b2_1) * value;
  };
  for (std::size_t a = 0; a < 3; ++a) {
    add(linear.g[a][0], linear.g[a][1], 0, 0, 2 * a + 1, 1);
    add(0, 0, linear.g[a][0], linear.g[a][1], 2 * a, -1);
  }
  const double phi_over = 2 / (kShearCorrection * (1 - section.poisson)) * section.thickness * section.thickness;
  double side_shear[3][6]{};  // γ along each side
  std::array<std::array<double, 2>, 3> direction{};
  for (std::size_t side = 0; side < 3; ++side) {
    const std::size_t i = side, j = next(side);
    const double length = std::sqrt(side_squared(p, side)), phi = phi_over / (length * length);
    const double c = (p[j][0] - p[i][0]) / length, d = (p[j][1] - p[i][1]) / length;
    direction[side] = {c, d};
    const double bulge = -0.75 / (1 + phi);  // Δβ for a unit sum of the slopes along the side at its ends
    const double g1 = 4 * (L[i] * linear.g[j][0] + L[j] * linear.g[i][0]);
    const double g2 = 4 * (L[i] * linear.g[j][1] + L[j] * linear.g[i][1]);
    for (const std::size_t end : {i, j}) {
      add(c * g1, c * g2, d * g1, d * g2, 2 * end + 1, bulge * c);
      add(c * g1, c * g2, d * g1, d * g2, 2 * end, -bulge * d);
      side_shear[side][2 * end + 1] += -2.0 / 3 * phi * bulge * c;
      side_shear[side][2 * end] += 2.0 / 3 * phi * bulge * d;
    }
  }
  for (std::size_t corner = 0; corner < 3; ++corner) {  // from the two sides that meet there
    const std::size_t out = corner, in = previous(corner);
    const auto &a = direction[out], &b = direction[in];
    const double det = a[0] * b[1] - a[1] * b[0];
    for (std::size_t k = 0; k < 6; ++k) {
      s.shear[0][k] += L[corner] * (b[1] * side_shear[out][k] - a[1] * side_shear[in][k]) / det;
      s.shear[1][k] += L[corner] * (a[0] * side_shear[in][k] - b[0] * side_shear[out][k]) / det;
    }
  }
  return s;
}

ShellConstants<double> shell_stiffness(const PlaneTriangle& p, const ShellSection& section) {
  const LinearGradients linear = linear_gradients(p);
  ShellConstants<double> c;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t j = 0; j < 2; ++j) c.g[a][j] = linear.g[a][j];
  add_membrane(p, section, linear.area, c.membrane);
  const double t = section.thickness, G = section.young / (2 * (1 + section.poisson));
  const Matrix3 C = plane_stress(section);
  const std::array<std::array<double, 2>, 2> shear{{{1, 0}, {0, 1}}};
  for (const std::array<double, 3>& L :
       {std::array{0.5, 0.5, 0.0}, std::array{0.0, 0.5, 0.5}, std::array{0.5, 0.0, 0.5}}) {
    const PlateStrains s = plate_strains(p, section, L);
    add_square(s.curvature, C, linear.area / 3 * t * t * t / 12, c.bending);
    add_square(s.shear, shear, linear.area / 3 * kShearCorrection * G * t, c.bending);
  }
  return c;
}

}  // namespace fascia
