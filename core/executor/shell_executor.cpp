#include "core/executor/shell_executor.hpp"

#include "core/base/errors.hpp"
#include "core/executor/group_kernels.hpp"
#include "core/linear/block_matrix.hpp"
#include "core/math/lane_rows.hpp"
#include "core/physics/shell_triangle.hpp"

#include <algorithm>
#include <limits>

namespace fascia {

using namespace kernels;

namespace {

constexpr int kGrain = 16, kCornerDofs = 6, kElementDofs = 18, kPairs = 6, kBlock = kCornerDofs * kCornerDofs;

constexpr int pair_number(int a, int b) { return a * (a + 1) / 2 + b; }

/// Three numbers of each lane. @param from  from(lane) is where a lane has them
template <class From>
Vec3<Lanes> gather_vector(const From& from) {
  const auto component = [&](int i) { return lanes_of([&](int lane) { return from(lane)[i]; }); };
  return {{component(0), component(1), component(2)}};
}

/// Constants of a batch, and its frames at a state in rest axes.
struct ShellBatch {
  ShellConstants<Lanes> constants;
  Mat3<Lanes> axes;
  Lanes viscosity;  ///< β / dt
  bool remembers;   ///< what fades: stresses are those of `factor` times the strain and of `given`
  Lanes factor{1.0}, lasting{1.0};
  ShellStrain<Lanes> given{};
  const int* node;  ///< of the first lane
  Vec3<Lanes> u[3];
  Mat3<Lanes> D[3];

  ShellBatch(const ShellBlock& block, int batch, int half, const BlockState& state)
      : remembers(!state.given.empty()), node(block.nodes_of(batch) + half * kBatchWidth) {
    if (remembers) load_given(given_rows(state.given, at(2 * batch)), half);
    const double* rows = block.constants_of(batch);
    for (int a = 0; a < 3; ++a)
      for (int j = 0; j < 2; ++j) constants.g[a][j] = row(rows, ShellBlock::kGradients + 2 * a + j, half);
    for (int k = 0; k < kPacked6; ++k) {
      constants.membrane[k] = row(rows, ShellBlock::kMembrane + k, half);
      constants.bending[k] = row(rows, ShellBlock::kBending + k, half);
    }
    axes = matrix(rows, ShellBlock::kAxes, half);
    viscosity = row(rows, ShellBlock::kDamping, half) * Lanes(state.inverse_step);
    for (int a = 0; a < 3; ++a) {
      Mat3<Lanes> turn;
      for (int k = 0; k < 9; ++k)
        turn(k / 3, k % 3) = lanes_of([&](int lane) { return state.D[at(node_of(a, lane))](k / 3, k % 3); });
      u[a] = transpose(axes) * gather_vector([&](int lane) { return state.u[at(node_of(a, lane))].v; });
      D[a] = transpose_times(axes, turn * axes);
    }
  }
  int node_of(int corner, int lane) const { return node[corner * kElementLanes + lane]; }

 private:
  void load_given(const double* membrane, int half) {
    const double* bending = membrane + kGivenRows * kElementLanes;
    factor = row(membrane, kGivenFactors, half);
    lasting = row(membrane, kLastingFactors, half);
    for (int k = 0; k < 6; ++k) {
      given.membrane[k] = row(membrane, kGivenStress + k, half);
      given.bending[k] = row(bending, kGivenStress + k, half);
    }
  }
};

/// Strains or stresses of a batch; zero where there are none.
ShellStrain<Lanes> load_strain(std::span<const double> e, int batch, int half) {
  ShellStrain<Lanes> strain;
  if (e.empty()) return strain;
  const double* rows = e.data() + at(batch) * 12 * kElementLanes;
  for (int k = 0; k < 6; ++k) {
    strain.membrane[k] = row(rows, k, half);
    strain.bending[k] = row(rows, 6 + k, half);
  }
  return strain;
}

void store_strain_of(const ShellStrain<Lanes>& strain, std::span<double> e, int batch, int half) {
  double* rows = e.data() + at(batch) * 12 * kElementLanes;
  for (int k = 0; k < 6; ++k) {
    store(rows, k, half, strain.membrane[k]);
    store(rows, 6 + k, half, strain.bending[k]);
  }
}

/// Elastic and viscous stress.
ShellStrain<Lanes> total_stress(const ShellBatch& batch, const ShellStrain<Lanes>& strain,
                                const ShellStrain<Lanes>& old) {
  if (batch.remembers)
    return shell_stress(batch.constants, strain * batch.factor + (strain - old) * batch.viscosity + batch.given);
  return shell_stress(batch.constants, strain + (strain - old) * batch.viscosity);
}

/// Square of what rounding leaves in a triangle's forces: that of the strains grows with the displacements that cancel
/// in them, and passes through the stiffness.
Lanes rounding_of(const ShellBatch& batch, const ShellStrain<Lanes>& e, const ShellNodes<Lanes>& f, double motion) {
  Lanes gradient, membrane, bending, squares;
  for (int a = 0; a < 3; ++a) {
    for (int j = 0; j < 2; ++j) gradient += batch.constants.g[a][j] * batch.constants.g[a][j];
    squares += squared_norm(f.x[a]);
  }
  for (int i = 0; i < 6; ++i) {
    const Lanes m = batch.constants.membrane[pair_number(i, i)], b = batch.constants.bending[pair_number(i, i)];
    membrane += m * m;
    bending += b * b;
  }
  const Lanes strain = contract(e, e), moved = gradient * Lanes(motion * motion);
  const Lanes stiffness = (Lanes(1) + batch.viscosity) * (Lanes(1) + batch.viscosity);
  return squares + gradient * (membrane + bending) * stiffness * (strain + moved) * (Lanes(1) + strain);
}

}  // namespace

ShellExecutor::ShellExecutor(const ShellBlock& block, const PointSet& set, ThreadPool& pool)
    : block_(block),
      set_(set),
      pool_(pool),
      slot_sums_(at(block.batch_count()) * kElementLanes * kElementDofs),
      sums_(at(block.batch_count())) {}

namespace {

/// Forces and torques in world axes, by triangle.
void store_corners(const Mat3<Lanes>& axes, const ShellNodes<Lanes>& f, double* out) {
  LaneArray<kElementDofs> corners;
  for (int a = 0; a < 3; ++a) {
    const Vec3<Lanes> force = axes * f.x[a], torque = axes * f.r[a];
    for (int i = 0; i < 3; ++i) {
      corners.set(kCornerDofs * a + i, force[i]);
      corners.set(kCornerDofs * a + 3 + i, torque[i]);
    }
  }
  store_rows<kElementDofs>(corners, [&](int lane) { return out + lane * kElementDofs; });
}

}  // namespace

[[gnu::flatten]] void ShellExecutor::forces_of_batch(const BlockState& state, int batch, bool energies, double motion) {
  Sums sums;
  for (int half = 0; half < kBatches; ++half) {
    const ShellBatch shell(block_, batch, half, state);
    const ShellTriangle<Lanes> triangle(shell.constants, shell.u, shell.D);
    const ShellStrain<Lanes>& e = triangle.strain();
    const ShellStrain<Lanes> old = load_strain(state.E, batch, half);
    const ShellNodes<Lanes> f = triangle.forces(total_stress(shell, e, old));
    const Mat3<Lanes> axes = shell.axes + shell.axes * triangle.turned();
    store_corners(axes, f, slot_sums_.data() + (at(batch) * kElementLanes + at(half * kBatchWidth)) * kElementDofs);
    if (!energies) continue;
    if (shell.remembers) {  // what never fades is elastic, and the rest of the step's potential viscous
      const ShellStrain<Lanes> stress = shell_stress(shell.constants, e);
      const Lanes energy = contract(e, stress) * Lanes(0.5);
      sums.elastic += lane_sum(shell.lasting * energy);
      sums.viscous += lane_sum((shell.factor - shell.lasting) * energy + contract(shell.given, stress));
    } else {
      sums.elastic += 0.5 * lane_sum(contract(e, shell_stress(shell.constants, e)));
    }
    if (block_.damped) {
      const ShellStrain<Lanes> flow = e - old;
      sums.viscous += 0.5 * lane_sum(contract(flow, shell_stress(shell.constants, flow)) * shell.viscosity);
    }
    sums.rounding += lane_sum(rounding_of(shell, e, f, motion));
  }
  sums_[at(batch)] = sums;
}

void ShellExecutor::compute_forces(const BlockState& state, bool energies, std::span<const double> part_motion) {
  pool_.for_ranges(block_.batch_count(), kGrain, [&](int begin, int end) {
    for (int batch = begin; batch < end; ++batch)
      forces_of_batch(state, batch, energies, energies ? part_motion[at(part_of_batch(batch))] : 0.0);
  });
  if (!energies) return;
  elastic_ = viscous_ = 0;
  for (const Sums& s : sums_) {
    elastic_ += s.elastic;
    viscous_ += s.viscous;
  }
}

void ShellExecutor::add_rounding(std::span<double> squares_of_parts) const {
  for (int batch = 0; batch < block_.batch_count(); ++batch)
    squares_of_parts[at(part_of_batch(batch))] += sums_[at(batch)].rounding;
}

void ShellExecutor::add_sums(int node, NodeSum& sum) const {
  Vec3d force, torque;
  for (int k = block_.node_slot_begin[at(node)]; k < block_.node_slot_begin[at(node + 1)]; ++k) {
    const double* s = slot_sums_.data() + at(block_.node_slot[at(k)]) * kCornerDofs;
    force += {{s[0], s[1], s[2]}};
    torque += {{s[3], s[4], s[5]}};
  }
  sum.force += force;
  sum.torque += torque;
}

void ShellExecutor::store_strain(const BlockState& state, std::span<double> e) {
  pool_.for_ranges(block_.batch_count(), kGrain, [&](int begin, int end) {
    for (int batch = begin; batch < end; ++batch) {
      for (int half = 0; half < kBatches; ++half) {
        const ShellBatch shell(block_, batch, half, state);
        store_strain_of(ShellTriangle<Lanes>(shell.constants, shell.u, shell.D).strain(), e, batch, half);
      }
    }
  });
}

namespace {

/// The tangent of a batch at a state, ready for directions.
struct BatchProducts {
  ShellBatch shell;
  ShellTriangle<Lanes> triangle;
  Mat3<Lanes> axes;
  Lanes stiffness;
  bool full;

  BatchProducts(const ShellBlock& block, int batch, int half, const BlockState& state)
      : shell(block, batch, half, state),
        triangle(shell.constants, shell.u, shell.D),
        axes(shell.axes + shell.axes * triangle.turned()),
        stiffness(shell.factor + shell.viscosity),
        full(state.tangent == Tangent::full) {
    triangle.prepare_products(state.kept.empty()
                                  ? total_stress(shell, triangle.strain(), load_strain(state.E, batch, half))
                                  : load_strain(state.kept, batch, half));
  }
  BatchProducts(const BatchProducts&) = delete;
  BatchProducts& operator=(const BatchProducts&) = delete;
};

/// A motion of the model's nodes, in element axes.
ShellNodes<Lanes> motion_in(const Mat3<Lanes>& axes, const ShellBatch& shell, const DofLayout& dofs,
                            std::span<const double> d) {
  ShellNodes<Lanes> motion;
  for (int a = 0; a < 3; ++a) {
    const auto from = [&](int lane) { return d.data() + dofs.begin(shell.node_of(a, lane)); };
    motion.x[a] = transpose(axes) * gather_vector(from);
    motion.r[a] = transpose(axes) * gather_vector([&](int lane) { return from(lane) + 3; });
  }
  return motion;
}

}  // namespace

[[gnu::flatten]] void ShellExecutor::product_of_batch(const BlockState& state, int batch, std::span<const double> d) {
  for (int half = 0; half < kBatches; ++half) {
    const BatchProducts products(block_, batch, half, state);
    const ShellNodes<Lanes> motion = motion_in(products.axes, products.shell, set_.dofs, d);
    store_corners(products.axes, products.triangle.product(motion, products.stiffness, products.full),
                  slot_sums_.data() + (at(batch) * kElementLanes + at(half * kBatchWidth)) * kElementDofs);
  }
}

void ShellExecutor::linearize(const BlockState&, const BlockState* start, const BlockDirection* step,
                              std::span<double> kept) {
  if (kept.empty()) return;
  pool_.for_ranges(block_.batch_count(), kGrain, [&](int begin, int end) {
    for (int batch = begin; batch < end; ++batch) {
      for (int half = 0; half < kBatches; ++half) {
        const ShellBatch shell(block_, batch, half, *start);
        const ShellTriangle<Lanes> triangle(shell.constants, shell.u, shell.D);
        const Mat3<Lanes> axes = shell.axes + shell.axes * triangle.turned();
        const ShellStrain<Lanes> e =
            triangle.strain() + triangle.strain_differential(motion_in(axes, shell, set_.dofs, step->d));
        store_strain_of(total_stress(shell, e, load_strain(start->E, batch, half)), kept, batch, half);
      }
    }
  });
}

void ShellExecutor::compute_product(const BlockState& state, const BlockDirection& direction) {
  pool_.for_ranges(block_.batch_count(), kGrain, [&](int begin, int end) {
    for (int batch = begin; batch < end; ++batch) product_of_batch(state, batch, direction.d);
  });
}

[[gnu::flatten]] void ShellExecutor::assemble_batch(const BlockState& state, int batch, BlockMatrix& matrix) const {
  for (int half = 0; half < kBatches; ++half) {
    const std::uint32_t* slot = pair_slot_.data() + at(batch * kPairs) * kElementLanes + half * kBatchWidth;
    for (int pair = 0; pair < kPairs; ++pair)
      for (int lane = 0; lane < kBatchWidth; ++lane)
        prefetch_to_add(matrix.values() + slot[pair * kElementLanes + lane], kBlock);
    const BatchProducts products(block_, batch, half, state);
    const auto place = [upper = matrix.fills_upper()](int i, int k) {
      return upper ? kCornerDofs * k + i : kCornerDofs * i + k;
    };
    LaneArray<kBlock> K[kPairs];
    for (int b = 0; b < 3; ++b) {
      for (int k = 0; k < kCornerDofs; ++k) {
        ShellNodes<Lanes> motion;
        (k < 3 ? motion.x : motion.r)[b] = products.axes.row(k % 3);
        const ShellNodes<Lanes> f = products.triangle.product(motion, products.stiffness, products.full);
        for (int a = b; a < 3; ++a) {
          const Vec3<Lanes> force = products.axes * f.x[a], torque = products.axes * f.r[a];
          for (int i = 0; i < 3; ++i) {
            K[pair_number(a, b)].set(place(i, k), force[i]);
            K[pair_number(a, b)].set(place(3 + i, k), torque[i]);
          }
        }
      }
    }
    for (int pair = 0; pair < kPairs; ++pair)
      add_to_rows<kBlock>(K[pair], [&](int lane) { return matrix.values() + slot[pair * kElementLanes + lane]; });
  }
}

void ShellExecutor::find_pair_slots(const BlockMatrix& matrix) {
  pattern_ = matrix.pattern();
  if (matrix.value_count() > std::numeric_limits<std::uint32_t>::max())
    throw InputError("the matrix has more than 4e9 entries; use fewer triangles");
  pair_slot_.resize(at(block_.batch_count() * kPairs) * kElementLanes);
  for (int batch = 0; batch < block_.batch_count(); ++batch)
    for (int lane = 0; lane < kElementLanes; ++lane)
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b <= a; ++b) {
          const int* node = block_.nodes_of(batch) + lane;
          const int i = node[a * kElementLanes], j = node[b * kElementLanes];
          const int index = matrix.fills_upper() ? matrix.find(j, i) : matrix.find(i, j);
          pair_slot_[at(batch * kPairs + pair_number(a, b)) * kElementLanes + at(lane)] =
              static_cast<std::uint32_t>(matrix.block(index) - matrix.values());
        }
}

void ShellExecutor::assemble(const BlockState& state, BlockMatrix& matrix, Entries /*entries*/) {
  if (pattern_ != matrix.pattern()) find_pair_slots(matrix);
  for (std::size_t c = 0; c + 1 < block_.color_begin.size(); ++c) {
    const int first = block_.color_begin[c];
    pool_.for_ranges(block_.color_begin[c + 1] - first, 4, [&](int begin, int end) {
      for (int i = begin; i < end; ++i) assemble_batch(state, block_.color_batch[at(first + i)], matrix);
    });
  }
}

}  // namespace fascia
