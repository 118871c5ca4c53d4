#pragma once

#include "core/executor/executor.hpp"
#include "core/space/space.hpp"
#include "gpu/space/views.hpp"
#include "tests/support/fading.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

/// What the classes of the GPU backend see of a model, on the processor, beside the executor that they must agree with.
namespace fascia::test {

/// The nodes of a model at a state.
class HostModel {
 public:
  HostModel(const Model& model, State state) : model_(model), state_(std::move(state)) {
    const DofLayout& dofs = model.points.dofs;
    for (int node = 0; node < dofs.node_count(); ++node) {
      kind_.push_back(dofs.kind(node));
      dof_.push_back(dofs.begin(node));
      block_.push_back(dofs.block_begin(node));
      D_.push_back(state_.D[at(node)]);
      Q_.push_back(Mat3d::identity() + state_.D[at(node)]);
    }
    dof_.push_back(dofs.total());
    const PointSet& set = model.points;
    motion_.resize(at(set.part_count()));
    for (int node = 0; node < dofs.node_count(); ++node) {
      const auto part = at(set.node_part[at(node)]);
      const double turn = dofs.kind(node) == FrameKind::vertex ? 0.0 : set.part_length[part] * norm(state_.D[at(node)]);
      motion_[part] = std::max({motion_[part], norm(state_.u[at(node)]), turn});
    }
  }

  const Model& model() const { return model_; }
  const State& state() const { return state_; }
  NodesView nodes() const {
    const PointSet& set = model_.points;
    return {set.node_count(), kind_.data(), dof_.data(), block_.data(), set.node_part.data(), set.part_length.data()};
  }
  PoseView pose() const { return {state_.u.data(), D_.data()}; }
  const double* part_motion() const { return motion_.data(); }
  const Mat3d* Q() const { return Q_.data(); }

  /// A motion of all nodes. @param d  by degrees of freedom, kept by the caller
  gpu::DirectionView direction(const std::vector<double>& d) {
    dx_.clear();
    dA_.clear();
    for (int node = 0; node < model_.node_count(); ++node) {
      const double* own = d.data() + dof_[at(node)];
      dx_.push_back({{own[0], own[1], own[2]}});
      dA_.push_back(frame_variation(kind_[at(node)], own + 3, Q_[at(node)]));
    }
    return {d.data(), dx_.data(), dA_.data()};
  }

  /// What add_sums() gives, by degrees of freedom.
  template <class View>
  std::vector<double> gathered(const View& view) const {
    std::vector<double> g(at(model_.dof_count()));
    for (int node = 0; node < model_.node_count(); ++node) {
      gpu::NodeSums sums;
      view.add_sums(node, sums);
      double* own = g.data() + dof_[at(node)];
      for (int k = 0; k < 3; ++k) own[k] = sums.force[k];
      add_moment(kind_[at(node)], sums.N, Q_[at(node)], own + 3);
      if (kind_[at(node)] == FrameKind::rigid)
        for (int k = 0; k < 3; ++k) own[3 + k] += sums.torque[k];
    }
    return g;
  }

  /// Sums of quantities over a part, or over all (−1).
  static double sum(const double* quantities, const std::vector<int>& parts, gpu::Quantity quantity, int part = -1) {
    double sum = 0;
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (parts[i] >= 0 && (part < 0 || parts[i] == part)) sum += quantities[i * gpu::kQuantities + quantity];
    return sum;
  }

 private:
  const Model& model_;
  State state_;
  std::vector<FrameKind> kind_;
  std::vector<int> dof_;
  std::vector<std::size_t> block_;
  std::vector<Mat3d> D_, Q_, dA_;
  std::vector<Vec3d> dx_;
  std::vector<double> motion_;
};

/// The blocks of an assembled matrix that belong to one node each, in the order of DofLayout.
inline std::vector<double> diagonal_blocks(const BlockMatrix& matrix, const DofLayout& dofs) {
  std::vector<double> blocks;
  for (int node = 0; node < dofs.node_count(); ++node) {
    const double* own = matrix.block(matrix.diagonal(node));
    blocks.insert(blocks.end(), own, own + dofs.size(node) * dofs.size(node));
  }
  return blocks;
}

/// |values − reference| / |reference|; 0 where nothing differs.
template <class Values, class Reference>
double relative(const Values& values, const Reference& reference) {
  double error = 0, scale = 0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    error += (values[i] - reference[i]) * (values[i] - reference[i]);
    scale += reference[i] * reference[i];
  }
  return error == 0 ? 0.0 : std::sqrt(error / scale);
}

/// @param what  said where it does not hold
template <class Values, class Reference>
void expect_near(const Values& values, const Reference& reference, const char* what) {
  ASSERT_EQ(values.size(), reference.size()) << what;
  EXPECT_LE(relative(values, reference), 1e-12) << what;
}

/// A class of the backend against the executor of a model that has nothing else.
template <class Class>
class Comparison {
 public:
  /// @param dt  above 0: with viscous stress
  Comparison(const Model& model, const State& state, const State& old, double dt)
      : host_(model, state),
        start_(model, old),
        own_(model.points),
        cpu_(model.points, pool_),
        memory_(model.points, 200) {
    history_.given = memory_.given();
    own_history_.given = memory_.empty() ? nullptr : history_.given.data();
    if (dt <= 0) return;
    history_.inverse_step = 1 / dt;
    cpu_.store_strain(old, history_.E);
    own_history_.E = history_.E.data();
    own_history_.inverse_step = history_.inverse_step;
  }

  void expect_all() {
    expect_same_strains();
    expect_same_fading();
    expect_same_forces();
    for (const Tangent tangent : {Tangent::full, Tangent::material}) expect_same_tangent(tangent);
    expect_same_extrapolation();
  }

  void expect_same_strains() {
    AlignedVector<double> stored;
    cpu_.store_strain(host_.state(), stored);
    std::vector<double> E(own_.strain_size());
    own_.store_strain(host_.pose(), E.data());
    expect_near(E, stored, "strains");
  }

  /// Both store the same of what fades.
  void expect_same_fading() {
    AlignedVector<double> S(memory_.stress_size()), own(S.size());
    if (S.empty()) return;
    for (const std::span<const double> given : {memory_.given(), memory_.relaxing()}) {
      cpu_.store_stress(host_.state(), given, S);
      own_.store_stress(host_.pose(), given.data(), own.data());
      expect_near(own, S, "what fades");
    }
  }

  void expect_same_forces() {
    std::vector<double> g(at(host_.model().dof_count()));
    const InternalEnergy energy = cpu_.gradient(host_.state(), history_, g);
    own_.forces(host_.nodes(), host_.pose(), own_history_, host_.part_motion());
    const std::vector<double> with_energies = host_.gathered(own_.view());
    expect_near(with_energies, g, "forces");
    const PointSet& set = host_.model().points;
    const std::vector<int> parts = own_.item_parts(set);
    const double* q = own_.quantities();
    EXPECT_NEAR(HostModel::sum(q, parts, gpu::kElastic), energy.elastic, 1e-12 * energy.elastic);
    EXPECT_NEAR(HostModel::sum(q, parts, gpu::kViscous), energy.viscous,
                1e-12 * (std::abs(energy.viscous) + (memory_.empty() ? 0 : energy.elastic)));
    EXPECT_EQ(HostModel::sum(q, parts, gpu::kStabilizing), 0);
    for (int part = 0; part < set.part_count(); ++part) {
      const double rounding =
          std::numeric_limits<double>::epsilon() * std::sqrt(HostModel::sum(q, parts, gpu::kRounding, part));
      EXPECT_NEAR(rounding, cpu_.rounding(part), 1e-12 * rounding);
    }
    own_.forces(host_.nodes(), host_.pose(), own_history_, nullptr);
    expect_near(host_.gathered(own_.view()), with_energies, "forces without energies");
  }

  /// Products and diagonals, also after forces at another pose.
  void expect_same_tangent(Tangent tangent) { expect_same_tangent(tangent, nullptr, {}); }

  /// With stresses extrapolated from the old state.
  void expect_same_extrapolation() {
    constexpr double kLength = 0.3;
    const std::vector<double> d = random_direction(host_.model());
    TakenStep taken{start_.state().u, start_.state().D, d};
    for (double& v : taken.d) v *= kLength;
    expect_same_tangent(Tangent::full, &taken, {start_.pose(), start_.direction(d), kLength});
  }

 private:
  void expect_same_tangent(Tangent tangent, const TakenStep* taken, const gpu::TakenStepView& own_taken) {
    std::vector<double> unused(at(host_.model().dof_count())), Kd = unused;
    cpu_.gradient(host_.state(), history_, unused);
    Linearization lin;
    cpu_.linearize(host_.state(), history_, tangent, lin, true, taken);
    const std::vector<double> d = random_direction(host_.model());
    cpu_.multiply(lin, d, Kd);
    BlockMatrix matrix(host_.model().points);
    cpu_.assemble(lin, matrix);
    own_.linearize(host_.pose(), own_history_, tangent, own_taken);
    const HostModel rest(host_.model(), State::at_rest(host_.model()));
    own_.forces(rest.nodes(), rest.pose(), {}, nullptr);
    own_.product(host_.direction(d));
    expect_near(host_.gathered(own_.view()), Kd, "product");
    const DofLayout& dofs = host_.model().points.dofs;
    std::vector<double> diagonal(dofs.block_total());
    own_.add_diagonal(host_.nodes(), host_.Q(), diagonal.data());
    expect_near(diagonal, diagonal_blocks(matrix, dofs), "diagonal");
  }

  HostModel host_, start_;
  Class own_;
  ThreadPool pool_{1};
  CpuExecutor cpu_;
  MidwayMemory memory_;
  StrainHistory history_;
  gpu::HistoryView own_history_;
};

}  // namespace fascia::test
