#include "core/executor/element_batch.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace fascia {

using namespace kernels;

ElementExecutor::ElementExecutor(const ElementBlock& block, const PointSet& set, ThreadPool& pool)
    : block_(block),
      set_(set),
      pool_(pool),
      slot_u_(at(block.slot_count())),
      slot_sum_(at(block.slot_count())),
      patch_sums_(at(block.patch_count())) {
  if (block_.averaged) prepare_average();
  find_lane_parts();
}

/// Only where an element lies in another part than its patch's first node.
void ElementExecutor::find_lane_parts() {
  bool mixed = false;
  std::vector<int> parts;
  block_.for_each_element([&](std::span<const int> nodes) { parts.push_back(set_.node_part[at(nodes[0])]); });
  std::size_t element = 0;
  for (int patch = 0; patch < block_.patch_count(); ++patch)
    for (const std::size_t end = std::min(parts.size(), at(block_.patch_batch[at(patch + 1)]) * kElementLanes);
         element < end; ++element)
      mixed = mixed || parts[element] != part_of_patch(patch);
  if (!mixed) return;
  lane_part_ = std::move(parts);
  lane_part_.resize(at(block_.batch_count()) * kElementLanes, lane_part_.back());
  lane_rounding_.resize(lane_part_.size());
}

/// Motion of the parts in which the elements of a half batch lie.
Lanes ElementExecutor::lane_motion(int batch, int half, std::span<const double> part_motion) const {
  Lanes motion;
  const int* part = lane_part_.data() + at(batch) * kElementLanes + at(half * kBatchWidth);
  for (int lane = 0; lane < kBatchWidth; ++lane) motion.v[lane] = part_motion[at(part[lane])];
  return motion;
}

std::size_t ElementExecutor::strain_size() const {
  return at(block_.batch_count()) * at(block_.points) * 6 * kElementLanes;
}

void ElementExecutor::gather_patch(std::span<const Vec3d> values, int patch, std::vector<Vec3d>& out) const {
  const auto nodes = block_.nodes_of_patch(patch);
  const auto first = at(block_.patch_begin[at(patch)]);
  for (std::size_t i = 0; i < nodes.size(); ++i) out[first + i] = values[at(nodes[i])];
}

namespace {

Lanes squared(const Mat3<Lanes>& m) { return contract(m, m); }

/// Square of what rounding leaves in a point's forces: that of F − I grows with the displacements that cancel in it,
/// and passes through the stiffness.
Lanes rounding_of(const Mat3<Lanes>& H, const Mat3<Lanes>& P, const ElementMaterial<Lanes>& m, const Lanes& v,
                  const Lanes& squared_gradient, const Lanes& motion) {
  const Lanes stiffness = v * (m.lambda + m.mu * Lanes(2.0)) * (Lanes(1.0) + m.viscosity), strain = squared(H);
  const Lanes moved = squared_gradient * motion * motion;
  return squared_gradient * (v * v * squared(P) + stiffness * stiffness * (strain + moved) * (Lanes(1.0) + strain));
}

}  // namespace

template <Law L, int N>
[[gnu::flatten]] void ElementExecutor::forces_of_patch(const BlockState& state, int patch,
                                                       std::span<const double> part_motion) {
  const bool energies = !part_motion.empty();
  const Lanes patch_motion(energies ? part_motion[at(part_of_patch(patch))] : 0.0);
  gather_patch(state.u, patch, slot_u_);
  const auto first = at(block_.patch_begin[at(patch)]);
  const auto nodes = block_.nodes_of_patch(patch);
  std::fill_n(slot_sum_.begin() + static_cast<std::ptrdiff_t>(first), nodes.size(), Vec3d{});
  const int n = nodes_of<N>(block_);
  const bool remembers = !state.given.empty();
  PatchSums sums;
  for (int batch = block_.patch_batch[at(patch)]; batch < block_.patch_batch[at(patch) + 1]; ++batch) {
    for (int half = 0; half < kBatches; ++half) {
      Vec3<Lanes> u[kRoom<N>], f[kRoom<N>];
      gather<N>(block_, batch, half, slot_u_.data() + first, u);
      const BatchPoints<N> points(block_, batch, half, u);
      const auto m = element_material<L>(block_, batch, half, state);
      const bool mixed = energies && !lane_part_.empty();
      const Lanes motion = mixed ? lane_motion(batch, half, part_motion) : patch_motion;
      Lanes rounding;
      const auto add = [&](int q, const Mat3<Lanes>& P) {
        const Mat3<Lanes> force = P * points.v(q);
        const double* g = block_.gradient_of(batch, q);
        for (int a = 0; a < n; ++a) f[a] += force * gradient(g, a, half);
        if (!energies) return;
        Lanes squares;
        for (int a = 0; a < n; ++a) squares += squared_norm(gradient(g, a, half));
        rounding += rounding_of(points.H[q], P, m, points.v(q), squares, motion);
      };
      const auto energy = [&](int q, const Lanes& elastic, const Mat3<Lanes>& viscous_strain) {
        if (!energies) return;
        sums.elastic += lane_sum(points.v(q) * elastic);
        if (block_.damped)
          sums.viscous += lane_sum(points.v(q) * m.viscosity *
                                   StVenantKirchhoff<Lanes>{m.lambda, m.mu}.energy_density(viscous_strain));
      };
      // Where points remember stresses, what never fades is elastic, and the rest of the step's potential viscous.
      const auto split = [&](int q, const Lanes& acting, const auto& density, const Mat3<Lanes>& strain) {
        const Lanes fading = acting - density(element_material<L>(block_, batch, half, state, kLastingFactors));
        const Mat3<Lanes> given = given_stress(block_, state, batch, q, half);
        sums.elastic -= lane_sum(points.v(q) * fading);
        sums.viscous += lane_sum(points.v(q) * (fading + contract(given, strain)));
      };
      const Lanes s = block_.penalised ? swelling(points) : Lanes(0), pull = m.penalty * s * abs(s);
      if (block_.penalised && energies)
        sums.elastic += lane_sum(points.volume * m.penalty * s * s * abs(s) * Lanes(1.0 / 3));
      const auto with_penalty = [&](int q, const Mat3<Lanes>& P) {
        return block_.penalised ? P + cofactor(Mat3<Lanes>::identity() + points.H[q]) * pull : P;
      };
      if constexpr (L == Law::corotational) {
        CorotationalElement<Lanes> element(points.mean(points.H), points.safe_volume(), true);
        Mat3<Lanes> sigma[BatchPoints<N>::kPoints];
        for (int q = 0; q < points.count(); ++q) {
          const Mat3<Lanes> strain = element.strain(points.H[q]), old = old_strain(block_, state.E, batch, q, half);
          sigma[q] = element.stress(strain, m, old, block_.damped);
          if (remembers) sigma[q] += given_stress(block_, state, batch, q, half);
          if (N != 4 || block_.damped || remembers) element.add_point(points.H[q], sigma[q], points.v(q));
          energy(q, StVenantKirchhoff<Lanes>{m.lambda, m.mu}.energy_density(strain), strain - old);
          if (remembers && energies)
            split(
                q, StVenantKirchhoff<Lanes>{m.lambda, m.mu}.energy_density(strain),
                [&](const auto& lasting) {
                  return StVenantKirchhoff<Lanes>{lasting.lambda, lasting.mu}.energy_density(strain);
                },
                strain);
        }
        element.close();
        for (int q = 0; q < points.count(); ++q) add(q, with_penalty(q, element.first_piola(sigma[q])));
      } else {
        for (int q = 0; q < points.count(); ++q) {
          const Mat3<Lanes>& H = points.H[q];
          const Mat3<Lanes> old = old_strain(block_, state.E, batch, q, half);
          Lanes p, theta;
          if (block_.averaged) {
            p = mean_pressure(block_, batch, half, nodes, node_pressure_);
          } else {
            theta = SolidLaw<L, Lanes>::volumetric_strain(H);
            p = m.law().volumetric_modulus() * theta;
          }
          ElasticPoint<L, Lanes> point(H, m, p, old, block_.damped);
          if (remembers) point.S += given_stress(block_, state, batch, q, half);
          add(q, with_penalty(q, point.first_piola()));
          const auto density = [&](const auto& constants) {
            const auto law = constants.law();
            return law.shear_energy(H) + Lanes(0.5) * law.volumetric_modulus() * theta * theta;
          };
          if (energies) energy(q, density(m), SolidLaw<L, Lanes>::strain(H) - old);
          if (remembers && energies) split(q, density(m), density, SolidLaw<L, Lanes>::strain(H));
        }
      }
      scatter<N>(block_, batch, half, f, slot_sum_.data() + first);
      if (!mixed) sums.rounding += lane_sum(rounding);
      for (int lane = 0; lane < kBatchWidth && mixed; ++lane)
        lane_rounding_[at(batch) * kElementLanes + at(half * kBatchWidth + lane)] = rounding.v[lane];
    }
  }
  patch_sums_[at(patch)] = sums;
}

void ElementExecutor::compute_forces(const BlockState& state, bool energies, std::span<const double> part_motion) {
  if (block_.averaged) average(state);
  with_element_kind(block_.law, block_.nodes, [&]<Law L, int N>() {
    pool_.for_ranges(block_.patch_count(), 1, [&](int patch, int) {
      forces_of_patch<L, N>(state, patch, energies ? part_motion : std::span<const double>{});
    });
  });
  if (!energies) return;
  elastic_ = viscous_ = 0;
  for (const PatchSums& s : patch_sums_) {
    elastic_ += s.elastic;
    viscous_ += s.viscous;
  }
  if (block_.averaged) {
    const double acting = average_energy(state), elastic = acting * lasting_part(state);
    elastic_ += elastic;
    viscous_ += acting - elastic;
  }
}

void ElementExecutor::add_rounding(std::span<double> squares_of_parts) const {
  for (int patch = 0; patch < block_.patch_count(); ++patch)
    squares_of_parts[at(part_of_patch(patch))] += patch_sums_[at(patch)].rounding;
  for (std::size_t lane = 0; lane < lane_part_.size(); ++lane)
    squares_of_parts[at(lane_part_[lane])] += lane_rounding_[lane];
}

template <Law L, int N>
void ElementExecutor::strain_of_patch(int patch, std::span<double> E) const {
  const auto first = at(block_.patch_begin[at(patch)]);
  for (int batch = block_.patch_batch[at(patch)]; batch < block_.patch_batch[at(patch) + 1]; ++batch) {
    for (int half = 0; half < kBatches; ++half) {
      Vec3<Lanes> u[kRoom<N>];
      gather<N>(block_, batch, half, slot_u_.data() + first, u);
      const BatchPoints<N> points(block_, batch, half, u);
      for (int q = 0; q < points.count(); ++q) {
        double* out = E.data() + symmetric_row(block_, batch, q);
        if constexpr (L == Law::corotational) {
          const CorotationalElement<Lanes> element(points.mean(points.H), points.safe_volume(), true);
          store_symmetric(out, 0, half, element.strain(points.H[q]));
        } else {
          store_symmetric(out, 0, half, SolidLaw<L, Lanes>::strain(points.H[q]));
        }
      }
    }
  }
}

template <Law L, int N>
void ElementExecutor::stress_of_patch(const BlockState& state, int patch, std::span<double> S) const {
  const auto first = at(block_.patch_begin[at(patch)]);
  const auto nodes = block_.nodes_of_patch(patch);
  for (int batch = block_.patch_batch[at(patch)]; batch < block_.patch_batch[at(patch) + 1]; ++batch) {
    for (int half = 0; half < kBatches; ++half) {
      Vec3<Lanes> u[kRoom<N>];
      gather<N>(block_, batch, half, slot_u_.data() + first, u);
      const Lanes pressure = block_.averaged ? mean_pressure(block_, batch, half, nodes, node_pressure_) : Lanes(0);
      const BatchTangent<L, N> tangent(block_, batch, half, u, state, pressure);
      for (int q = 0; q < tangent.points.count(); ++q)
        store_symmetric(S.data() + symmetric_row(block_, batch, q), 0, half, tangent.stress(q));
    }
  }
}

/// Products go on with the pressures of the last forces.
void ElementExecutor::store_stress(const BlockState& state, std::span<double> S) {
  kept_pressure_ = node_pressure_;
  if (block_.averaged) average(state);
  with_element_kind(block_.law, block_.nodes, [&]<Law L, int N>() {
    pool_.for_ranges(block_.patch_count(), 1, [&](int patch, int) {
      gather_patch(state.u, patch, slot_u_);
      stress_of_patch<L, N>(state, patch, S);
    });
  });
  node_pressure_.swap(kept_pressure_);
}

void ElementExecutor::store_strain(const BlockState& state, std::span<double> E) {
  with_element_kind(block_.law, block_.nodes, [&]<Law L, int N>() {
    pool_.for_ranges(block_.patch_count(), 1, [&](int patch, int) {
      gather_patch(state.u, patch, slot_u_);
      strain_of_patch<L, N>(patch, E);
    });
  });
}

}  // namespace fascia
