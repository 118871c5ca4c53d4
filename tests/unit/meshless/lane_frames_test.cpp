// Points with few frames each are computed lane by lane, in patches; the same points one to a group, slot by slot.
#include "core/executor/lane_frames.hpp"
#include "core/base/errors.hpp"
#include "core/executor/executor.hpp"
#include "core/structure/edit.hpp"
#include "tests/unit/meshless/shared_models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <ostream>

namespace fascia::lane_frames_test {
namespace {

using namespace test;

struct Case {
  std::string name;
  BlockOptions block;
  ScatteredKind weights = ScatteredKind::shepard;
  std::optional<int> neighbours = 4;
  bool shared = false;  ///< on nodes of elements too, of which some turn
  bool lanes = true;    ///< most groups are computed by lanes
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

std::vector<Case> cases() {
  std::vector<Case> all;
  const auto add = [&](const std::string& name, auto change) {
    Case c;
    c.name = name;
    c.block.drilling = 0;
    change(c);
    all.push_back(c);
  };
  add("rigid", [](Case&) {});
  add("drilling", [](Case& c) { c.block.drilling = 0.1; });
  add("half_blend", [](Case& c) {
    c.block.drilling = 0.1;
    c.block.half_blend = true;
  });
  add("affine", [](Case& c) { c.block.affine = true; });
  add("affine_tied", [](Case& c) {
    c.block.affine = true;
    c.block.drilling = 0.05;
  });
  add("damped", [](Case& c) { c.block.stiffness_damping = 0.02; });
  add("neo_hookean", [](Case& c) { c.block.law = Law::neo_hookean; });
  add("least_squares", [](Case& c) {
    c.weights = ScatteredKind::mls;
    c.neighbours.reset();
    c.lanes = false;
  });
  add("on_elements", [](Case& c) {
    c.shared = true;
    c.lanes = false;
  });
  return all;
}

SharedModel built(const Case& c) {
  SharedModel s;
  if (c.shared) {
    HostOptions host;
    host.kind = HostKind::turning;
    add_host(s, host);
  }
  ScatterSpec scatter = unit_scatter(SpacedChoice{0.3, 1});
  scatter.parts.solid->surface = box_surface({}, {{1, 1, 1}}, 2, 2, 2);
  scatter.points = SpacedChoice{0.17, 1};
  scatter.weights = c.weights;
  scatter.neighbours = c.neighbours;
  add_cloud(s, scatter, c.block);
  s.finish();
  return s;
}

/// The points of a set, each in a group of its own.
PointSet one_by_one(const PointSet& set, const Model& model) {
  PointSetBuilder builder;
  for (int group = 0; group < set.group_count(); ++group) {
    const std::span<const int> nodes = set.nodes(group);
    for (int lane = 0; lane < kGroupSize; ++lane) {
      if (set.lane_point[at(group * kGroupSize + lane)] < 0) continue;
      const auto constant = [&](MaterialRow row) { return set.material_of_group(group)[row * kGroupSize + lane]; };
      PointSample p;
      p.volume = constant(kVolume);
      p.lambda = constant(kLambda);
      p.mu = constant(kMu);
      p.stabilization = constant(kStabilization);
      p.stiffness_damping = constant(kStiffnessDamping);
      std::vector<int> own;
      for (std::size_t s = 0; s < nodes.size(); ++s) {
        const double* row = set.shape_of_slot(set.slot_begin[at(group)] + static_cast<int>(s)) + lane;
        Influence influence;
        influence.w = row[0];
        for (int i = 0; i < 3; ++i) influence.g[i] = row[(1 + i) * kGroupSize];
        for (int i = 0; i < 9; ++i) influence.B(i / 3, i % 3) = row[(4 + i) * kGroupSize];
        if (influence.w == 0 && squared_norm(influence.g) == 0 && contract(influence.B, influence.B) == 0) continue;
        own.push_back(nodes[s]);
        p.influences.push_back(influence);
      }
      builder.add_points(own, std::span(&p, 1), set.group_length[at(group)], set.rule[at(group)].rule);
    }
  }
  for (const ElementBlock& block : set.blocks) builder.add_elements(block);
  return std::move(builder).finish(model.frame_kind);
}

double difference(const std::vector<double>& a, std::vector<double> b) {
  for (std::size_t i = 0; i < a.size(); ++i) b[i] -= a[i];
  return norm(b) / norm(a);
}

class LaneFramesOf : public testing::TestWithParam<Case> {
 protected:
  LaneFramesOf() : built_(built(GetParam())), state_(random_state(built_.model, 0.02, 0.3)) {}

  struct Found {
    std::vector<double> gradient, product, assembled, strain;
    double energy = 0, rounding = 0;
  };
  /// Forces, then a tangent whose stresses are extrapolated along a step, or not, and its matrix.
  Found find(const PointSet& set, int threads, bool taken) const {
    ThreadPool pool(threads);
    CpuExecutor executor(set, pool);
    Found f;
    f.gradient.resize(at(set.dofs.total()));
    f.product = f.assembled = f.gradient;
    StrainHistory history;
    executor.store_strain(random_state(built_.model, 0.01, 0.1, 5), history.E);
    f.strain.assign(history.E.begin(), history.E.end());
    history.inverse_step = 20;
    if (!set.damped) history = {};
    f.energy = executor.gradient(state_, history, f.gradient).total();
    f.rounding = executor.rounding(0);
    TakenStep step;
    step.d = random_direction(built_.model, 7);
    for (double& d : step.d) d *= 0.05;
    step.u = state_.u;
    step.D = state_.D;
    Linearization lin;
    executor.linearize(state_, history, Tangent::full, lin, true, taken ? &step : nullptr);
    const std::vector<double> x = random_direction(built_.model);
    executor.multiply(lin, x, f.product);
    BlockMatrix matrix(set);
    executor.assemble(lin, matrix);
    matrix.multiply(pool, x, f.assembled);
    return f;
  }

  SharedModel built_;
  State state_;
};

TEST_P(LaneFramesOf, EqualGroupsOfOnePoint) {
  const PointSet& set = built_.model.points;
  const LaneFrames lanes(set);
  int by_lanes = 0;
  for (int group = 0; group < set.group_count(); ++group) by_lanes += lanes.count(group) > 0 ? 1 : 0;
  EXPECT_GT(2 * by_lanes, GetParam().lanes ? set.group_count() : -1);
  EXPECT_GT(lanes.patch_count(), GetParam().lanes ? 4 : -1);
  const PointSet single = one_by_one(set, built_.model);
  EXPECT_EQ(LaneFrames(single).patch_count(), 0);
  for (const bool taken : {false, true}) {
    const Found f = find(set, 2, taken), g = find(single, 2, taken);
    EXPECT_NEAR(f.energy, g.energy, 1e-13 * std::abs(g.energy));
    EXPECT_NEAR(f.rounding, g.rounding, 1e-9 * g.rounding);
    EXPECT_LT(difference(g.gradient, f.gradient), 1e-13);
    EXPECT_LT(difference(g.product, f.product), 1e-13);
    EXPECT_LT(difference(g.assembled, f.assembled), 1e-13);
    EXPECT_LT(difference(f.product, f.assembled), 1e-13);
  }
}

/// The blocks of the diagonal alone, as preconditioners of the material part ask for them.
TEST_P(LaneFramesOf, FillTheDiagonalAlike) {
  const PointSet& set = built_.model.points;
  ThreadPool pool(2);
  CpuExecutor executor(set, pool);
  std::vector<double> gradient(at(set.dofs.total()));
  executor.gradient(state_, {}, gradient);
  Linearization lin;
  executor.linearize(state_, {}, Tangent::material, lin);
  BlockMatrix all(set), diagonal(set);
  for (BlockMatrix* matrix : {&all, &diagonal})
    std::fill_n(matrix->values(), matrix->value_count(), std::numeric_limits<double>::quiet_NaN());
  executor.assemble(lin, all);
  executor.assemble(lin, diagonal, Entries::diagonal);
  for (int node = 0; node < set.node_count(); ++node) {
    const int n = set.dofs.size(node) * set.dofs.size(node);
    const double *a = all.block(all.diagonal(node)), *b = diagonal.block(diagonal.diagonal(node));
    EXPECT_EQ(std::vector(a, a + n), std::vector(b, b + n)) << node;
  }
}

TEST_P(LaneFramesOf, DoNotDependOnThreads) {
  const Found one = find(built_.model.points, 1, true);
  for (const int threads : {2, 3, 7}) {
    const Found f = find(built_.model.points, threads, true);
    EXPECT_EQ(f.gradient, one.gradient);
    EXPECT_EQ(f.product, one.product);
    EXPECT_EQ(f.assembled, one.assembled);
    EXPECT_EQ(f.strain, one.strain);
    EXPECT_EQ(f.energy, one.energy);
  }
}

/// Points that left have lanes without frames.
TEST_P(LaneFramesOf, EqualThemWherePointsHaveLeft) {
  if (GetParam().block.stiffness_damping > 0 || GetParam().shared) return;
  Edit edit;
  for (int point = 0; point < built_.model.points.point_count; point += 5) edit.points.push_back(point);
  for (int lane = 0; lane < kGroupSize; ++lane)  // a group of which nothing is left
    if (const int point = built_.model.points.lane_point[at(lane)]; point > 0 && point % 5 != 0)
      edit.points.push_back(point);
  apply(edit, built_.model);
  const Found f = find(built_.model.points, 2, true), g = find(one_by_one(built_.model.points, built_.model), 2, true);
  EXPECT_LT(difference(g.gradient, f.gradient), 1e-13);
  EXPECT_LT(difference(g.assembled, f.assembled), 1e-13);
}

TEST_P(LaneFramesOf, GiveEachSlotItsSums) {
  if (GetParam().shared) return;
  const PointSet& set = built_.model.points;
  ThreadPool pool(2);
  CpuExecutor executor(set, pool);
  std::vector<double> gradient(at(set.dofs.total())), sums;
  executor.gradient(state_, {}, gradient);
  executor.store_slot_sums(state_, {}, sums);
  for (int node = 0; node < set.node_count(); ++node) {
    const NodeSum sum = sum_of_groups(set, sums, {0, set.group_count()}, node);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(sum.force[i], gradient[at(set.dofs.begin(node) + i)], 1e-12 * norm(gradient)) << node;
  }
}

/// Consistent weights halve the blend, so that frames carry nothing rigidly; Shepard's have nothing to halve.
TEST(LaneFrames, CarryUnlessTheirBlendIsHalved) {
  for (const ScatteredKind weights : {ScatteredKind::shepard, ScatteredKind::mls}) {
    Case c;
    c.weights = weights;
    const SharedModel model = built(c);
    const LaneFrames lanes(model.model.points);
    int carried = 0, all = 0;
    for (int group = 0; group < model.model.points.group_count(); ++group) {
      if (lanes.count(group) == 0) continue;
      ++all;
      carried += lanes.carries(group) ? 1 : 0;
    }
    EXPECT_GT(all, 0);
    EXPECT_EQ(carried, weights == ScatteredKind::shepard ? all : 0);
  }
}

/// In the order of their nodes, whatever the order in which the caller names them.
TEST(LaneFrames, NodesOfPointsMayBeInAnyOrder) {
  Case c;
  const SharedModel model = built(c);
  PointSample p;
  p.volume = 0.01;
  p.lambda = p.mu = 1e4;
  for (int k = 0; k < 3; ++k) {
    Influence influence;
    influence.w = 0.2 + 0.1 * k;
    influence.g = {{1.0 - k, 0.5 * k, 0.3}};
    influence.B = Mat3d::identity() * influence.w;
    p.influences.push_back(influence);
  }
  PointSample turned = p;
  std::swap(turned.influences[0], turned.influences[2]);
  PointSet sets[2];
  for (int i = 0; i < 2; ++i) {
    PointSetBuilder builder;
    builder.add_points(i == 0 ? std::vector{2, 5, 7} : std::vector{7, 5, 2}, std::span(i == 0 ? &p : &turned, 1), 0.1);
    sets[i] = std::move(builder).finish(model.model.frame_kind);
  }
  EXPECT_EQ(sets[0].slot_node, sets[1].slot_node);
  EXPECT_EQ(sets[0].shape, sets[1].shape);
  PointSetBuilder builder;
  EXPECT_THROW(builder.add_points(std::vector{2, 5, 2}, std::span(&p, 1), 0.1), InputError);
}

/// Frames that no point has in common have no block, though a group has both.
TEST(LaneFrames, LeaveTheMatrixSparse) {
  Case c;
  c.block.drilling = 0;
  const SharedModel model = built(c);
  const PointSet& set = model.model.points;
  std::vector<char> together(at(set.node_count() * set.node_count()));
  const PointSet single = one_by_one(set, model.model);
  for (int group = 0; group < single.group_count(); ++group)
    for (const int a : single.nodes(group))
      for (const int b : single.nodes(group)) together[at(a * set.node_count() + b)] = 1;
  std::size_t pairs = 0;
  for (const char t : together) pairs += t != 0 ? 1 : 0;
  EXPECT_EQ(BlockMatrix(set).block_count(), pairs);
}

INSTANTIATE_TEST_SUITE_P(All, LaneFramesOf, testing::ValuesIn(cases()),
                         [](const auto& parameter) { return parameter.param.name; });

}  // namespace
}  // namespace fascia::lane_frames_test
