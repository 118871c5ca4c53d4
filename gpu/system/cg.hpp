#pragma once

#include "core/base/index.hpp"
#include "core/levels/multigrid.hpp"
#include "core/linear/cg.hpp"
#include "core/space/array.hpp"
#include "core/space/space.hpp"
#include "gpu/space/views.hpp"

#include <algorithm>
#include <cmath>

namespace fascia::gpu {

/// Where a solve stands, in memory of the space.
struct CgProgress {
  double rz = 0, rz_start = 0, rr = 0, rr_start = 0, alpha = 0, beta = 0;
  double tolerance = 0;
  int limit = 0, iterations = 0;
  int done = 0;
  CgStatus status = CgStatus::converged;
};

/// Vectors of a solve by degrees of freedom. An operator calls next_direction() for all of them before it uses p, and
/// gives p · Ap to curvature(). Numbers of all degrees of freedom are of 64 bits whatever the vectors' scalar V is.
template <class V>
struct CgView {
  V *x = nullptr, *r = nullptr, *z = nullptr, *p = nullptr, *Ap = nullptr;
  CgProgress* progress = nullptr;

  /// p ← z + β p
  FASCIA_HD void next_direction(int i) const { p[i] = static_cast<V>(z[i] + progress->beta * p[i]); }
  FASCIA_HD void curvature(double pAp) const {
    CgProgress& s = *progress;
    if (s.done != 0) return;
    s.alpha = s.rz / pAp;
    if (pAp > 0 && pAp - pAp == 0) return;
    s.status = pAp - pAp == 0 ? CgStatus::negative_curvature : CgStatus::not_finite;
    s.done = 1;
    s.alpha = s.status == CgStatus::negative_curvature && s.iterations == 0 ? 1.0 : 0.0;  // x = p at the first
  }
  /// After x, r and z were updated.
  FASCIA_HD void residual(double rz, double rr) const {
    CgProgress& s = *progress;
    if (s.done != 0) {
      s.alpha = 0;
      return;
    }
    ++s.iterations;
    s.rr = rr;
    s.beta = rz / s.rz;
    s.rz = rz;
    s.done = 1;
    if (rz < -kCycleRounding * s.rz_start)  // an indefinite preconditioner, with which the rest means nothing
      s.status = CgStatus::not_finite;
    else if (rz <= s.tolerance * s.tolerance * s.rz_start)
      s.status = CgStatus::converged;
    else if (s.iterations >= s.limit)
      s.status = CgStatus::limit;
    else
      s.done = 0;
    if (s.done != 0) s.alpha = 0;
  }
};

namespace kernels {

/// r · z and r · r of a node with z = M⁻¹ r, after x ← x + α p, r ← r − α Ap.
template <class V>
struct CgUpdate {
  NodesView nodes;
  CgView<V> v;
  const V* inverse;

  FASCIA_HD void operator()(int node, Sums<2>& sums) const {
    const CgProgress& s = *v.progress;
    if (s.done != 0 && s.alpha == 0) return;
    const int first = nodes.dof[node], n = nodes.size(node);
    const V* block = inverse + nodes.block[node];
    double r[kMostDofs];
    for (int i = 0; i < n; ++i) {
      v.x[first + i] = static_cast<V>(v.x[first + i] + s.alpha * v.p[first + i]);
      r[i] = v.r[first + i] = static_cast<V>(v.r[first + i] - s.alpha * v.Ap[first + i]);
    }
    for (int i = 0; i < n; ++i) {
      double z = 0;
      for (int j = 0; j < n; ++j) z += block[n * i + j] * r[j];
      v.z[first + i] = static_cast<V>(z);
      sums.v[0] += r[i] * z;
      sums.v[1] += r[i] * r[i];
    }
  }
};

/// Puts a new solve in the place of the last.
template <class V>
struct CgBegin {
  CgView<V> v;
  CgProgress fresh;
  FASCIA_HD void operator()(int) const { *v.progress = fresh; }
};

/// Ends the first sum: of the right-hand side. @tparam Judges  the preconditioner may be indefinite
template <class V, bool Judges>
struct CgStart {
  CgView<V> v;
  FASCIA_HD void operator()(const Sums<2>& total) const {
    CgProgress& s = *v.progress;
    s.rz = s.rz_start = total.v[0];
    s.rr = s.rr_start = total.v[1];
    const bool indefinite = s.rz < 0 || (s.rz == 0 && s.rr > 0);
    if (s.rz - s.rz != 0 || (Judges && indefinite)) s.status = CgStatus::not_finite;
    if (s.limit <= 0) s.status = CgStatus::limit;
    s.done = !(s.rz > 0) || s.status != CgStatus::converged;
  }
};

template <class V>
struct CgResidual {
  CgView<V> v;
  FASCIA_HD void operator()(const Sums<2>& total) const { v.residual(total.v[0], total.v[1]); }
};

/// x ← x + α p, r ← r − α Ap
template <class V>
struct CgAdvance {
  CgView<V> v;
  FASCIA_HD void operator()(int i) const {
    const CgProgress& s = *v.progress;
    if (s.done != 0 && s.alpha == 0) return;
    v.x[i] = static_cast<V>(v.x[i] + s.alpha * v.p[i]);
    v.r[i] = static_cast<V>(v.r[i] - s.alpha * v.Ap[i]);
  }
};

/// r · z and r · r
template <class V>
struct CgProducts {
  CgView<V> v;
  FASCIA_HD void operator()(int i, Sums<2>& sums) const {
    sums.v[0] += static_cast<double>(v.r[i]) * v.z[i];
    sums.v[1] += static_cast<double>(v.r[i]) * v.r[i];
  }
};

}  // namespace kernels

/// Preconditioned conjugate gradients as in core/linear/cg.hpp, without the host: scalars stay in the space, and the
/// operator's loops are recorded once. @tparam V  scalar of vectors
template <class Space, class V>
class ConjugateGradients {
 public:
  explicit ConjugateGradients(std::size_t dofs) : x_(dofs), r_(dofs), z_(dofs), p_(dofs), Ap_(dofs), progress_(1) {}

  /// Right-hand side, to be written before solve(); held entries zero.
  V* rhs() { return r_.data(); }
  V* solution() { return x_.data(); }

  /// @param inverse  block-diagonal preconditioner, by node
  /// @param key      of the operator: what its loops were recorded with
  /// @param apply    apply(view): loops that make Ap of p
  template <class Apply>
  CgReport solve(const NodesView& nodes, const V* inverse, const CgOptions& options, std::uint64_t key,
                 const Apply& apply) {
    const CgView<V> v = begin(options);
    const kernels::CgUpdate<V> update{nodes, v, inverse};
    Space::template sum<2>(nodes.count, update, kernels::CgStart<V, false>{v});
    loop_.run(key, options.max_iterations, kAtOnce, &progress_.data()->done, [&] {
      apply(v);
      Space::template sum<2>(nodes.count, update, kernels::CgResidual<V>{v});
    });
    return end();
  }

  /// @param precondition  precondition(r, z): loops that make z = M⁻¹ r, which take longer than a look at the flag; an
  ///                      indefinite one ends as `not_finite`
  template <class Precondition, class Apply>
  CgReport solve_with(const Precondition& precondition, const CgOptions& options, std::uint64_t key,
                      const Apply& apply) {
    const CgView<V> v = begin(options);
    const int dofs = static_cast<int>(x_.size());
    const kernels::CgProducts<V> products{v};
    precondition(v.r, v.z);
    Space::template sum<2>(dofs, products, kernels::CgStart<V, true>{v});
    cycles_.run(key, options.max_iterations, 1, &progress_.data()->done, [&] {
      apply(v);
      Space::for_each(dofs, kernels::CgAdvance<V>{v});
      precondition(v.r, v.z);
      Space::template sum<2>(dofs, products, kernels::CgResidual<V>{v});
    });
    return end();
  }

 private:
  static constexpr int kAtOnce = 10;

  CgView<V> begin(const CgOptions& options) {
    const CgView<V> v{x_.data(), r_.data(), z_.data(), p_.data(), Ap_.data(), progress_.data()};
    x_.set_zero();
    p_.set_zero();
    Ap_.set_zero();
    CgProgress fresh;
    fresh.tolerance = options.tolerance;
    fresh.limit = options.max_iterations;
    Space::for_each(1, kernels::CgBegin<V>{v, fresh});
    return v;
  }
  CgReport end() const {
    CgProgress end;
    progress_.download(std::span(&end, 1));
    if (end.status == CgStatus::converged && end.rz_start - end.rz_start != 0) end.status = CgStatus::not_finite;
    const auto ratio = [](double now, double start) { return start > 0 ? std::sqrt(std::max(now, 0.0) / start) : 0.0; };
    return {end.status, end.iterations, ratio(end.rz, end.rz_start), ratio(end.rr, end.rr_start)};
  }

  Array<Space, V> x_, r_, z_, p_, Ap_;
  Array<Space, CgProgress> progress_;
  typename Space::Loop loop_, cycles_;
};

}  // namespace fascia::gpu
