#pragma once

#include "core/executor/group_kernels.hpp"

/// Columns of the tangent of a batch of points: what one degree of freedom of a frame does to their stress, and what
/// that does to another frame.
namespace fascia::kernels {

/// A frame as it moves the points of a batch; nothing at first.
struct PointFrame {
  LaneArray<22> rows;  ///< w, g (3), A (9): B of an affine frame, else Q B; w Q (9) with Q = I + D

  void set(FrameKind kind, const double* shape, bool carries, int batch, const Mat3<Lanes>& Q) {
    const Vec3<Lanes> g = vector(shape, 1, batch);
    Mat3<Lanes> A = carries ? outer(vector(shape, 4, batch), g) + Mat3<Lanes>::diagonal(row(shape, 0, batch))
                            : kernels::matrix(shape, 4, batch);
    if (kind != FrameKind::affine) A = Q * A;
    rows.set(0, row(shape, 0, batch));
    for (int i = 0; i < 3; ++i) {
      rows.set(1 + i, g[i]);
      for (int j = 0; j < 3; ++j) {
        rows.set(4 + 3 * i + j, A(i, j));
        rows.set(13 + 3 * i + j, Q(i, j) * row(shape, 0, batch));
      }
    }
  }
  Lanes w() const { return rows[0]; }
  Lanes g(int i) const { return rows[1 + i]; }
  Lanes A(int i, int j) const { return rows[4 + 3 * i + j]; }
  Lanes Q_weighted(int i, int j) const { return rows[13 + 3 * i + j]; }

  static Vec3<Lanes> vector(const double* shape, int first, int batch) {
    return {{row(shape, first, batch), row(shape, first + 1, batch), row(shape, first + 2, batch)}};
  }
};

/// The motion of a point for a unit of one degree of freedom of a frame; rigid ones turn by e × of each column.
template <FrameKind Frame>
PointMotion<Lanes> unit_motion(const PointFrame& f, int dof) {
  PointMotion<Lanes> d;
  if (dof < 3) {
    for (int j = 0; j < 3; ++j) d.H(dof, j) = f.g(j);
  } else if constexpr (Frame == FrameKind::rigid) {
    const int next = (dof - 2) % 3, last = (dof - 1) % 3;
    for (int j = 0; j < 3; ++j) {
      d.H(next, j) = -f.A(last, j);
      d.H(last, j) = f.A(next, j);
      d.Dbar(next, j) = -f.Q_weighted(last, j);
      d.Dbar(last, j) = f.Q_weighted(next, j);
    }
  } else {
    const int q = (dof - 3) / 3, i = (dof - 3) % 3;
    for (int j = 0; j < 3; ++j) d.H(i, j) = f.A(q, j);
    d.Dbar(i, q) = f.w();
  }
  return d;
}

/// v ∂P/∂H of the points of a batch, without their ties: dP of a unit of each entry of H. All frames of a point make
/// their columns of these nine, so that the law is asked for six strains and not for each degree of freedom.
class PointModuli {
 public:
  /// @param S  the stress of the geometric part
  template <class Material>
  void set(const Mat3<Lanes>& H, const Mat3<Lanes>& S, const Material& material, Tangent tangent) {
    if (is_tether(material)) return set_tether(material);
    LaneMatrix F;
    F.set(Mat3<Lanes>::identity() + H);
    LaneArray<6> of_strain[6], dS;  // entries of dS at kSymmetricPlaces, by those of dE
    for (int c = 0; c < 6; ++c) {
      const Mat3<Lanes> dE = broadcast(symmetric_unit<double>(c));
      of_strain[c] = symmetric_part(stress_differential(material, H, dE) * (material.volume * (c < 3 ? 1 : 0.5)));
    }
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        for (int c = 0; c < 6; ++c)
          dS.set(c, F(i, 0) * of_strain[kSymmetricPlaceOf[0][j]][c] + F(i, 1) * of_strain[kSymmetricPlaceOf[1][j]][c] +
                        F(i, 2) * of_strain[kSymmetricPlaceOf[2][j]][c]);
        LaneMatrix& dP = entry_[3 * i + j];
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b)
            dP.LaneArray::set(3 * a + b, F(a, 0) * dS[kSymmetricPlaceOf[0][b]] + F(a, 1) * dS[kSymmetricPlaceOf[1][b]] +
                                             F(a, 2) * dS[kSymmetricPlaceOf[2][b]]);
        for (int b = 0; b < 3 && tangent == Tangent::full; ++b)
          dP.LaneArray::set(3 * i + b, dP(i, b) + S(j, b) * material.volume);
      }
  }

  /// dP of each degree of freedom of a frame.
  template <FrameKind Frame>
  void columns(const PointFrame& f, LaneMatrix* dP) const {
    for (int i = 0; i < 3; ++i)
      for (int p = 0; p < 9; ++p) dP[i].LaneArray::set(p, along(i, f.g(0), f.g(1), f.g(2), p));
    if constexpr (Frame == FrameKind::rigid)
      for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3, last = (k + 2) % 3;
        for (int p = 0; p < 9; ++p)
          dP[3 + k].LaneArray::set(p, along(last, f.A(next, 0), f.A(next, 1), f.A(next, 2), p) -
                                          along(next, f.A(last, 0), f.A(last, 1), f.A(last, 2), p));
      }
    if constexpr (Frame == FrameKind::affine)
      for (int q = 0; q < 3; ++q)
        for (int i = 0; i < 3; ++i)
          for (int p = 0; p < 9; ++p) dP[3 + 3 * q + i].LaneArray::set(p, along(i, f.A(q, 0), f.A(q, 1), f.A(q, 2), p));
  }

 private:
  static LaneArray<6> symmetric_part(const Mat3<Lanes>& m) {
    LaneArray<6> out;
    for (int c = 0; c < 6; ++c) out.set(c, m(kSymmetricPlaces[c][0], kSymmetricPlaces[c][1]));
    return out;
  }
  /// Entry p of dP where row i of H moves by h.
  Lanes along(int i, const Lanes& h0, const Lanes& h1, const Lanes& h2, int p) const {
    return h0 * entry_[3 * i][p] + h1 * entry_[3 * i + 1][p] + h2 * entry_[3 * i + 2][p];
  }
  template <class Material>
  void set_tether(const Material& material) {
    if constexpr (std::is_same_v<Material, ThinMaterial<Lanes>>)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          Mat3<Lanes> d;
          d(i, j) = Lanes(1);
          entry_[3 * i + j].set(tether_stress(material, d.column(0)) * material.volume);
        }
  }

  LaneMatrix entry_[9];
};

/// A batch of points as a tie of frames' rotations to F reads it: no law is asked.
struct PointTie {
  PointMotion<Lanes> x;
  TangentStress<Lanes> stress;
  Lanes volume, stabilization;  ///< [m³], γ [Pa]: 0 of tethers
};

/// Sets v dP and, where rotations blend, v dY of each degree of freedom of a frame.
template <Stabilization Tie, FrameKind Frame>
void stress_columns(const PointModuli& moduli, const PointTie& of, Tangent tangent, const PointFrame& f, LaneMatrix* dP,
                    LaneMatrix* dY) {
  moduli.columns<Frame>(f, dP);
  if constexpr (Tie != Stabilization::none) {
    for (int k = 0; k < dof_count(Frame); ++k) {
      PointStressDifferential<Lanes> tie;
      add_tie_differential<Tie>(of.x, of.stress, of, tangent, unit_motion<Frame>(f, k), tie);
      dP[k].set(dP[k] + tie.dP * of.volume);
      dY[k].set(tie.dY * of.volume);
    }
  }
}

/// Calls put(degree of freedom, what dP and dY are on a frame of this kind there).
template <bool Blend, FrameKind Frame, class Put>
inline void put_column(const PointFrame& f, const LaneMatrix& dP, const LaneMatrix& dY, const Put& put) {
  for (int i = 0; i < 3; ++i) put(i, dP(i, 0) * f.g(0) + dP(i, 1) * f.g(1) + dP(i, 2) * f.g(2));
  if constexpr (Frame == FrameKind::vertex) return;
  // N = dP Aᵀ + w dY, of rigid frames with w dY Qᵀ, whose torque is its axial vector.
  const auto moment = [&](int i, int j) {
    Lanes sum = dP(i, 0) * f.A(j, 0) + dP(i, 1) * f.A(j, 1) + dP(i, 2) * f.A(j, 2);
    if constexpr (Blend && Frame == FrameKind::rigid)
      sum += dY(i, 0) * f.Q_weighted(j, 0) + dY(i, 1) * f.Q_weighted(j, 1) + dY(i, 2) * f.Q_weighted(j, 2);
    else if constexpr (Blend)
      sum += dY(i, j) * f.w();
    return sum;
  };
  if constexpr (Frame == FrameKind::rigid) {
    put(3, moment(2, 1) - moment(1, 2));
    put(4, moment(0, 2) - moment(2, 0));
    put(5, moment(1, 0) - moment(0, 1));
  }
  if constexpr (Frame == FrameKind::affine) {
    for (int q = 0; q < 3; ++q)
      for (int i = 0; i < 3; ++i) put(3 + 3 * q + i, moment(i, q));
  }
}

/// Calls act.operator()<FrameKind>().
template <class Act>
void with_frame(FrameKind kind, const Act& act) {
  switch (kind) {
    case FrameKind::vertex:
      return act.template operator()<FrameKind::vertex>();
    case FrameKind::rigid:
      return act.template operator()<FrameKind::rigid>();
    case FrameKind::affine:
      return act.template operator()<FrameKind::affine>();
  }
}

}  // namespace fascia::kernels
