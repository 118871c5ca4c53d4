#pragma once

#include "core/math/half_angle.hpp"
#include "core/math/mat3.hpp"
#include "core/physics/shell_constants.hpp"

/// A triangle of a shell on three frames: 12 strains and their energy, a quadratic form.
///
/// Element axes (columns of T): the normal n of the plane through the three nodes, and in it the rotation of the polar
/// decomposition of F = Σ x_a g_aᵀ, so that no numbering of nodes, stretch or shear turns them. In these axes
///   E = ½ (Fᵀ F − I)                        of the plane (Green-Lagrange),
///   θ_a = log(Tᵀ Q_a T₀)                    rotation of frame a against the element,
///   W = ½ eᵀ D e,  e = (E₁₁ E₂₂ 2E₁₂ θ_az; θ_ax θ_ay),
/// with D from thickness, material and rest shape (shells/shell_stiffness.hpp). All vectors here are in element axes,
/// at rest or at present; displacements enter as increments, so that small strains keep their digits.
namespace fascia {

/// The 12 strains, or what is conjugate to them.
template <class T>
struct ShellStrain {
  T membrane[6]{}, bending[6]{};

  FASCIA_HD Vec3<T> rotation(int a) const { return {{bending[2 * a], bending[2 * a + 1], membrane[3 + a]}}; }
  FASCIA_HD void set_rotation(int a, const Vec3<T>& theta) {
    bending[2 * a] = theta[0];
    bending[2 * a + 1] = theta[1];
    membrane[3 + a] = theta[2];
  }
  FASCIA_HD ShellStrain& operator+=(const ShellStrain& o) {
    for (int k = 0; k < 6; ++k) {
      membrane[k] += o.membrane[k];
      bending[k] += o.bending[k];
    }
    return *this;
  }
  friend FASCIA_HD ShellStrain operator+(ShellStrain a, const ShellStrain& b) { return a += b; }
  friend FASCIA_HD ShellStrain operator-(ShellStrain a, const ShellStrain& b) {
    for (int k = 0; k < 6; ++k) {
      a.membrane[k] -= b.membrane[k];
      a.bending[k] -= b.bending[k];
    }
    return a;
  }
  friend FASCIA_HD ShellStrain operator*(ShellStrain a, const T& s) {
    for (int k = 0; k < 6; ++k) {
      a.membrane[k] *= s;
      a.bending[k] *= s;
    }
    return a;
  }
};

/// y = A x of a packed symmetric matrix.
template <class T>
FASCIA_HD void multiply_packed(const T* A, const T* x, T* y) {
  for (int i = 0; i < 6; ++i) {
    y[i] = A[i * (i + 1) / 2 + i] * x[i];
    for (int j = 0; j < i; ++j) {
      y[i] += A[i * (i + 1) / 2 + j] * x[j];
      y[j] += A[i * (i + 1) / 2 + j] * x[i];
    }
  }
}

template <class T>
FASCIA_HD ShellStrain<T> shell_stress(const ShellConstants<T>& c, const ShellStrain<T>& e) {
  ShellStrain<T> s;
  multiply_packed(c.membrane, e.membrane, s.membrane);
  multiply_packed(c.bending, e.bending, s.bending);
  return s;
}

/// Σ a b over the strains.
template <class T>
FASCIA_HD T contract(const ShellStrain<T>& a, const ShellStrain<T>& b) {
  T sum{};
  for (int k = 0; k < 6; ++k) sum += a.membrane[k] * b.membrane[k] + a.bending[k] * b.bending[k];
  return sum;
}

/// Force and torque, or displacement and rotation, of the three nodes in element axes.
template <class T>
struct ShellNodes {
  Vec3<T> x[3], r[3];
};

/// (e + d) / |e + d| − e of a unit vector e, accurate for small d.
template <class T>
FASCIA_HD Vec3<T> unit_increment(const Vec3<T>& e, const Vec3<T>& d) {
  using std::sqrt;
  const T excess = T(2) * dot(e, d) + squared_norm(d), length = sqrt(T(1) + excess);
  return d - (e + d) * (excess / (length * (T(1) + length)));
}

/// A triangle at a state.
template <class T>
class ShellTriangle {
 public:
  /// @param u  displacements, D  rotations − I, both in rest axes
  FASCIA_HD ShellTriangle(const ShellConstants<T>& constants, const Vec3<T>* u, const Mat3<T>* D) : c_(constants) {
    Vec3<T> h[2];
    for (int a = 0; a < 3; ++a)
      for (int j = 0; j < 2; ++j) h[j] += u[a] * c_.g[a][j];
    turn(h);
    stretch(h);
    for (int a = 0; a < 3; ++a) rotate(a, D[a]);
  }

  /// T₀ᵀ T − I
  FASCIA_HD const Mat3<T>& turned() const { return Z_; }
  FASCIA_HD const ShellStrain<T>& strain() const { return e_; }
  /// Right stretch of the plane: U₁₁, U₁₂, U₂₂.
  FASCIA_HD const T* stretch() const { return U_; }

  /// Forces and torques of what is conjugate to the strains.
  FASCIA_HD ShellNodes<T> forces(const ShellStrain<T>& s) const { return at_nodes(s, moments(s)); }

  /// Change of the strains for a motion of the nodes (in element axes).
  FASCIA_HD ShellStrain<T> strain_differential(const ShellNodes<T>& d) const {
    return strain_differential(variation(d), d);
  }

  /// Keeps what products need of the state. @param s  conjugate to the strains there
  FASCIA_HD void prepare_products(const ShellStrain<T>& s) {
    s_ = s;
    m_ = moments(s);
    f_ = at_nodes(s, m_);
  }

  /// Bᵀ δs + (δB)ᵀ s for a motion d: the Hessian of the energy along d, symmetric in rotations too
  /// (derivative of forces and torques, plus half the torque times the rotation).
  /// @param stiffness  factor of D: 1, more with damping
  /// @param full  false leaves out the second term
  FASCIA_HD ShellNodes<T> product(const ShellNodes<T>& d, const T& stiffness, bool full) const {
    const Variation v = variation(d);
    const ShellStrain<T> ds = shell_stress(c_, strain_differential(v, d)) * stiffness;
    Moments dm = moments(ds);
    if (!full) return at_nodes(ds, dm);
    for (int a = 0; a < 3; ++a) dm.m[a] += moment_differential(a, s_.rotation(a), d.r[a] - v.spin);
    dm.sum = dm.m[0] + dm.m[1] + dm.m[2];
    ShellNodes<T> out = at_nodes(ds, dm);
    Vec3<T> y[2];
    conjugates_differential(s_, m_.sum, v, y);
    for (int a = 0; a < 3; ++a) {
      out.x[a] += y[0] * c_.g[a][0] + y[1] * c_.g[a][1] + cross(v.spin, f_.x[a]);
      out.r[a] += cross(v.spin, m_.m[a]) + cross(m_.m[a], d.r[a]) * T(0.5);
    }
    return out;
  }

 private:
  struct Moments {
    Vec3<T> m[3], sum;
  };
  /// Variation of the element axes and the stretch, for a motion of the nodes.
  struct Variation {
    Vec3<T> p[2];  ///< Tᵀ δF
    Vec3<T> spin;
    T dU[3];  ///< of U₁₁, U₁₂, U₂₂
  };

  FASCIA_HD void turn(const Vec3<T>* h) {
    const Vec3<T> e1{{T(1), T(0), T(0)}}, e3{{T(0), T(0), T(1)}};
    Vec3<T> tilt = cross(h[0], h[1]);  // of (e₁ + h₁) × (e₂ + h₂) − e₃
    tilt[0] -= h[0][2];
    tilt[1] -= h[1][2];
    tilt[2] += h[0][0] + h[1][1];
    const Vec3<T> n = unit_increment(e3, tilt);
    Vec3<T> sum = h[0] + cross(h[1], n);  // f₁ + f₂ × n − 2 e₁
    sum[0] += h[1][1] + n[2];
    sum[1] -= h[1][0];
    sum[2] -= n[0];
    const Vec3<T> t = unit_increment(e1, sum * T(0.5));
    Vec3<T> b = cross(n, t);  // n × t₁ − e₂
    b[0] -= t[1];
    b[1] += t[0] + n[2];
    b[2] -= n[1];
    Z_ = Mat3<T>::from_columns(t, b, n);
  }

  FASCIA_HD void stretch(const Vec3<T>* h) {
    const auto entry = [&](int i, int j) { return h[j][i] + Z_(j, i) + dot(Z_.column(i), h[j]); };
    U_[0] = T(1) + entry(0, 0);
    U_[1] = T(0.5) * (entry(0, 1) + entry(1, 0));
    U_[2] = T(1) + entry(1, 1);
    const T inverse_determinant = T(1) / (U_[0] * U_[2] - U_[1] * U_[1]);
    inverse_[0] = U_[2] * inverse_determinant;
    inverse_[1] = -U_[1] * inverse_determinant;
    inverse_[2] = U_[0] * inverse_determinant;
    inverse_trace_ = T(1) / (U_[0] + U_[2]);
    e_.membrane[0] = h[0][0] + T(0.5) * squared_norm(h[0]);
    e_.membrane[1] = h[1][1] + T(0.5) * squared_norm(h[1]);
    e_.membrane[2] = h[0][1] + h[1][0] + dot(h[0], h[1]);
  }

  FASCIA_HD void rotate(int a, const Mat3<T>& D) {
    const Mat3<T> L = transpose(Z_) + D + transpose_times(Z_, D);  // Λ − I, Λ = Tᵀ Q T₀
    Lambda_[a] = Mat3<T>::identity() + L;
    sine_[a] = axl(transpose(L)) * T(0.5);
    angle_[a] = HalfAngle<T>(trace(L) * T(-0.25));
    e_.set_rotation(a, sine_[a] * angle_[a].f);
  }

  /// B s, Bᵀ s of B = ½ (tr Λ I − Λ), the derivative of the sine vector.
  FASCIA_HD Vec3<T> sine_differential(int a, const Vec3<T>& s) const {
    return (s * (T(3) - T(4) * angle_[a].z) - Lambda_[a] * s) * T(0.5);
  }
  FASCIA_HD Vec3<T> sine_moment(int a, const Vec3<T>& s) const {
    return (s * (T(3) - T(4) * angle_[a].z) - transpose(Lambda_[a]) * s) * T(0.5);
  }
  /// dθ = J ψ, J = f B + ½ f' a aᵀ, ψ: spin of Λ.
  FASCIA_HD Vec3<T> rotation_differential(int a, const Vec3<T>& spin) const {
    return sine_differential(a, spin) * angle_[a].f + sine_[a] * (T(0.5) * angle_[a].df * dot(sine_[a], spin));
  }
  FASCIA_HD Vec3<T> moment(int a, const Vec3<T>& s) const {
    return sine_moment(a, s) * angle_[a].f + sine_[a] * (T(0.5) * angle_[a].df * dot(sine_[a], s));
  }
  /// Derivative of Jᵀ s at fixed s.
  FASCIA_HD Vec3<T> moment_differential(int a, const Vec3<T>& s, const Vec3<T>& spin) const {
    const HalfAngle<T>& h = angle_[a];
    const Vec3<T>& sine = sine_[a];
    const T dz = T(0.5) * dot(sine, spin), along = dot(sine, s);
    const Vec3<T> dsine = sine_differential(a, spin);
    const Vec3<T> dB_s = transpose(Lambda_[a]) * cross(spin, s) * T(0.5) - s * (T(2) * dz);
    return dB_s * h.f + sine_moment(a, s) * (h.df * dz) + sine * (T(0.5) * h.ddf * dz * along) +
           (dsine * along + sine * dot(dsine, s)) * (T(0.5) * h.df);
  }

  FASCIA_HD Moments moments(const ShellStrain<T>& s) const {
    Moments m;
    for (int a = 0; a < 3; ++a) m.m[a] = moment(a, s.rotation(a));
    m.sum = m.m[0] + m.m[1] + m.m[2];
    return m;
  }

  FASCIA_HD Variation variation(const ShellNodes<T>& d) const {
    Variation v;
    for (int a = 0; a < 3; ++a)
      for (int j = 0; j < 2; ++j) v.p[j] += d.x[a] * c_.g[a][j];
    v.spin[0] = v.p[0][2] * inverse_[1] + v.p[1][2] * inverse_[2];
    v.spin[1] = -(v.p[0][2] * inverse_[0] + v.p[1][2] * inverse_[1]);
    v.spin[2] = (v.p[0][1] - v.p[1][0]) * inverse_trace_;
    v.dU[0] = v.p[0][0] + v.spin[2] * U_[1];
    v.dU[1] = v.p[1][0] + v.spin[2] * U_[2];
    v.dU[2] = v.p[1][1] - v.spin[2] * U_[1];
    return v;
  }

  FASCIA_HD ShellStrain<T> strain_differential(const Variation& v, const ShellNodes<T>& d) const {
    ShellStrain<T> e;
    e.membrane[0] = U_[0] * v.p[0][0] + U_[1] * v.p[0][1];
    e.membrane[1] = U_[1] * v.p[1][0] + U_[2] * v.p[1][1];
    e.membrane[2] = U_[0] * v.p[1][0] + U_[1] * (v.p[1][1] + v.p[0][0]) + U_[2] * v.p[0][1];
    for (int a = 0; a < 3; ++a) e.set_rotation(a, rotation_differential(a, d.r[a] - v.spin));
    return e;
  }

  /// Forces and moments on the nodes, from y conjugate to Tᵀ δF: U S, and what moments against the element's own
  /// rotation ask of it.
  FASCIA_HD ShellNodes<T> at_nodes(const ShellStrain<T>& s, const Moments& m) const {
    const T* S = s.membrane;
    const Vec3<T>& M = m.sum;
    const Vec3<T> y[2] = {{{U_[0] * S[0] + U_[1] * S[2], U_[1] * S[0] + U_[2] * S[2] - M[2] * inverse_trace_,
                            M[1] * inverse_[0] - M[0] * inverse_[1]}},
                          {{U_[1] * S[1] + U_[0] * S[2] + M[2] * inverse_trace_, U_[2] * S[1] + U_[1] * S[2],
                            M[1] * inverse_[1] - M[0] * inverse_[2]}}};
    ShellNodes<T> f;
    for (int a = 0; a < 3; ++a) {
      f.x[a] = y[0] * c_.g[a][0] + y[1] * c_.g[a][1];
      f.r[a] = m.m[a];
    }
    return f;
  }

  /// Change of the above with the stretch, at fixed stress and moments.
  FASCIA_HD void conjugates_differential(const ShellStrain<T>& s, const Vec3<T>& M, const Variation& v,
                                         Vec3<T>* y) const {
    const T* S = s.membrane;
    const T* dU = v.dU;
    // −U⁻¹ dU U⁻¹
    const T a = inverse_[0] * dU[0] + inverse_[1] * dU[1], b = inverse_[0] * dU[1] + inverse_[1] * dU[2];
    const T c = inverse_[1] * dU[0] + inverse_[2] * dU[1], d = inverse_[1] * dU[1] + inverse_[2] * dU[2];
    const T i11 = -(a * inverse_[0] + b * inverse_[1]), i12 = -(a * inverse_[1] + b * inverse_[2]),
            i22 = -(c * inverse_[1] + d * inverse_[2]);
    const T dtrace = -(dU[0] + dU[2]) * inverse_trace_ * inverse_trace_;
    y[0] = {{dU[0] * S[0] + dU[1] * S[2], dU[1] * S[0] + dU[2] * S[2] - M[2] * dtrace, M[1] * i11 - M[0] * i12}};
    y[1] = {{dU[1] * S[1] + dU[0] * S[2] + M[2] * dtrace, dU[2] * S[1] + dU[1] * S[2], M[1] * i12 - M[0] * i22}};
  }

  const ShellConstants<T>& c_;
  Mat3<T> Z_;
  T U_[3], inverse_[3], inverse_trace_;
  Mat3<T> Lambda_[3];
  Vec3<T> sine_[3];  ///< sin(angle) · axis
  HalfAngle<T> angle_[3];
  ShellStrain<T> e_;

  ShellStrain<T> s_;
  Moments m_;
  ShellNodes<T> f_;
};

}  // namespace fascia
