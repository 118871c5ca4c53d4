#include "core/levels/edge_ends.hpp"
#include "core/levels/vertex_rows.hpp"
#include "core/linear/cg.hpp"
#include "core/solver/mechanical_system.hpp"
#include "tests/support/tangent_at_rest.hpp"
#include "tests/unit/fem/element_models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <vector>

/// Levels of quadratic elements, the first of which are their corners.
namespace fascia::corner_levels_test {
namespace {

using namespace fascia::test;

ElementOptions bar(ElementShape shape, std::array<int, 3> cells) {
  ElementOptions o;
  o.shape = shape;
  o.cells = cells;
  o.formulation = ElementFormulation::linear;
  return o;
}

/// A bar of 4 m, held at x = 0.
Model held_bar(const ElementOptions& o) {
  ElementMesh mesh = generate_box({}, {{4, 1, 1}}, o.cells, {family_of(o.shape), order_of(o.shape), 6});
  Model model = element_model(o, std::move(mesh)).model;
  hold_face(model);
  return model;
}

int middles_of(const EdgeEnds& ends) {
  return static_cast<int>(std::count_if(ends.begin(), ends.end(), [](const auto& e) { return e[0] >= 0; }));
}

CgReport solved(TangentAtRest& t, Multigrid& levels, std::vector<double>& x) {
  EXPECT_TRUE(t.build(levels));
  const CpuVectors vectors(t.pool);
  return conjugate_gradients(
      vectors, [&](const auto& p, auto& Ap) { t.multiply(p, Ap); },
      [&](const auto& r, auto& z) { return levels.precondition(r, z); }, t.random_force(1), x, {200, 1e-8});
}

/// Each node of an edge is found with its ends, no corner is, and no node of linear elements; in cells of 0.8 × 0.33 ×
/// 0.5, and in flat ones, where diagonals pass by the middles of edges at a hundredth of their length.
void expect_ends(ElementShape shape, const Vec3d& size) {
  const ElementOptions o = bar(shape, {5, 3, 2});
  const ElementMesh mesh = generate_box({}, size, o.cells, {family_of(shape), order_of(shape), 6});
  const ElementModel built = element_model(o, mesh);
  const EdgeEnds ends = find_edge_ends(built.model);
  std::vector<std::array<int, 2>> expected(mesh.nodes.size(), {-1, -1});
  const auto edges = edges_of(family_of(shape));
  for (std::size_t e = 0; e < mesh.size() && order_of(shape) == 2; ++e)
    for (std::size_t k = 0; k < edges.size(); ++k) {
      const auto nodes = mesh.element(e);
      auto& of = expected[at(nodes[at(corner_count(shape)) + k])];
      of = {nodes[at(edges[k][0])], nodes[at(edges[k][1])]};
      std::sort(of.begin(), of.end());
    }
  ASSERT_EQ(ends.size(), expected.size());
  for (std::size_t i = 0; i < ends.size(); ++i) {
    std::array<int, 2> found = ends[i];
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected[i]) << i;
  }
}

TEST(CornerLevels, FindTheEndsOfEdges) {
  for (const ElementShape shape : {ElementShape::tet10, ElementShape::hex20, ElementShape::tet4, ElementShape::hex8})
    for (const Vec3d& size : {Vec3d{{4, 1, 1}}, Vec3d{{4, 3, 0.02}}, Vec3d{{40, 1, 0.5}}}) expect_ends(shape, size);
}

/// The node of a curved edge moves by itself, and so does one whose end hangs on others.
TEST(CornerLevels, LeaveWhatTheMeanOfTheEndsDoesNotMove) {
  const ElementOptions o = bar(ElementShape::hex20, {4, 2, 2});
  Model model = held_bar(o);
  const EdgeEnds before = find_edge_ends(model);
  int middle = -1;
  for (std::size_t i = 0; i < before.size() && middle < 0; ++i)
    if (before[i][0] >= 0 && model.rest_position[i][0] > 2.1) middle = static_cast<int>(i);
  ASSERT_GE(middle, 0);
  const auto [a, b] = before[at(middle)];
  const double length = norm(model.rest_position[at(b)] - model.rest_position[at(a)]);
  Model curved = model;
  curved.rest_position[at(middle)] += Vec3d{{0.06, 0.06, 0.06}} * length;
  EXPECT_EQ(find_edge_ends(curved)[at(middle)][0], -1);
  Model hanging = model;
  DependentNode follower;
  follower.node = b;
  follower.hosts = {0};
  follower.w = {1};
  follower.b = {Vec3d{}};
  hanging.points.dependents.push_back(follower);
  EXPECT_EQ(find_edge_ends(hanging)[at(middle)][0], -1);
}

/// With a plane of symmetry, corners that constraints turn into axes of their own, and one that follows a node far
/// away.
Model bar_of_all_sorts() {
  ElementOptions o = bar(ElementShape::hex20, {12, 4, 4});
  Model model = held_bar(o);
  const auto nearest = [&](const Vec3d& x) {
    int found = 0;
    for (int i = 1; i < model.node_count(); ++i)
      if (norm(model.rest_position[at(i)] - x) < norm(model.rest_position[at(found)] - x)) found = i;
    return found;
  };
  for (const double along : {1.0, 2.0, 3.0}) {
    FrameConstraint c;
    c.node = nearest({{along, 1, 0}});
    c.translations = 1;
    c.translation_axes = Mat3d::identity() + rotation_increment(Vec3d{{0.2, 0.3, 0.1}});
    model.constraints.push_back(c);
  }
  Mat3d across;  // y first
  across(0, 1) = across(1, 2) = across(2, 0) = 1;
  for (int i = 0; i < model.node_count(); ++i) {
    if (model.rest_position[at(i)][1] > 1e-9 || model.rest_position[at(i)][0] < 1e-9) continue;
    FrameConstraint c;
    c.node = i;
    c.translations = 1;
    c.translation_axes = across;
    model.constraints.push_back(c);
  }
  DependentNode follower;
  follower.node = nearest({{4, 1, 1}});
  follower.hosts = {nearest({{4, 1, 0}})};
  follower.w = {1};
  follower.b = {Vec3d{}};
  PointSetBuilder again(std::move(model.points));
  again.add_dependent(follower);
  model.points = std::move(again).finish(model.frame_kind);
  return model;
}

/// Corners have Pᵀ K P, with P as the mean of ends: entry by entry of products with unit vectors would be long, so with
/// vectors that nothing favours. A rigid motion comes through unchanged, and where nothing holds the body it costs
/// nothing on the level of corners either.
void expect_matrix_of_means(Model model, bool free) {
  TangentAtRest t(std::move(model), 2);
  const FineRows fine(t.matrix, t.filter);
  const Corners corners(find_edge_ends(t.model), t.filter);
  ASSERT_GT(corners.count(), 0);
  const VertexRows coarse(fine, corners, t.pool);
  std::vector<double> x(at(3 * corners.count())), y(x.size()), expected(x.size()), on_fine(at(t.model.dof_count())),
      product(on_fine.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const bool fixed = ((coarse.fixed(static_cast<int>(i / 3)) >> (i % 3)) & 1U) != 0;
    x[i] = fixed ? 0 : std::sin(1.0 + static_cast<double>(i * i % 1009));
  }
  corners.add_prolonged(fine, t.pool, x, on_fine);
  std::vector<double> ends(on_fine.size()), world = on_fine;  // in the axes of the world
  for (std::size_t i = 0; i < x.size(); ++i) ends[at(3 * corners.origin()[i / 3]) + i % 3] = x[i];
  t.filter.to_global(ends);
  t.filter.to_global(world);
  for (int i = 0; i < t.model.node_count(); ++i)
    for (int k = 0; k < 3 && fine.fixed(i) == 0; ++k) {
      const auto [a, b] = corners.parents(i);
      const double mean = 0.5 * (ends[at(3 * corners.origin()[at(a)] + k)] + ends[at(3 * corners.origin()[at(b)] + k)]);
      EXPECT_NEAR(world[at(3 * i + k)], mean, 1e-14);
    }
  t.multiply(on_fine, product);
  corners.restrict_to(fine, t.pool, product, expected);
  coarse.multiply_rounded(t.pool, x, y);
  double largest = 0, error = 0, exact_error = 0;
  for (int row = 0; row < coarse.rows(); ++row)
    coarse.for_each_block(row, [&](int column, const double* B) {
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) expected[at(3 * row + i)] -= B[3 * i + j] * x[at(3 * column + j)];
    });
  for (const double v : y) largest = std::max(largest, std::abs(v));
  for (const double v : expected) exact_error = std::max(exact_error, std::abs(v));
  EXPECT_LE(exact_error, 1e-13 * largest);
  std::vector<double> exact(y.size(), 0.0);
  for (int row = 0; row < coarse.rows(); ++row)
    coarse.for_each_block(row, [&](int column, const double* B) {
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) exact[at(3 * row + i)] += B[3 * i + j] * x[at(3 * column + j)];
    });
  for (std::size_t i = 0; i < y.size(); ++i) error = std::max(error, std::abs(y[i] - exact[i]));
  EXPECT_LE(error, 1e-6 * largest) << "rounding of entries";
  if (!free) return;
  const Vec3d U{{0.3, -0.7, 1.1}}, turn{{0.5, 0.2, -0.4}};
  const auto motion = [&](int node) { return U + cross(turn, t.model.rest_position[at(node)]); };
  for (int c = 0; c < corners.count(); ++c)
    for (int k = 0; k < 3; ++k) x[at(3 * c + k)] = motion(corners.origin()[at(c)])[k];
  std::fill(on_fine.begin(), on_fine.end(), 0.0);
  corners.add_prolonged(fine, t.pool, x, on_fine);
  for (int i = 0; i < t.model.node_count(); ++i)
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(on_fine[at(3 * i + k)], motion(i)[k], 1e-14 * 8);
  for (int row = 0; row < coarse.rows(); ++row) {
    Vec3d force;
    coarse.for_each_block(row, [&](int column, const double* B) {
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) force[i] += B[3 * i + j] * x[at(3 * column + j)];
    });
    EXPECT_LE(norm(force), 1e-12 * largest);
  }
}

TEST(CornerLevels, HaveTheMatrixOfMeans) {
  for (const ElementShape shape : {ElementShape::tet10, ElementShape::hex20}) {
    const ElementOptions o = bar(shape, {5, 3, 2});
    ElementMesh mesh = generate_box({}, {{4, 1, 1}}, o.cells, {family_of(shape), 2, 6});
    expect_matrix_of_means(held_bar(o), false);
    expect_matrix_of_means(element_model(o, std::move(mesh)).model, true);
  }
  expect_matrix_of_means(bar_of_all_sorts(), false);
}

TEST(CornerLevels, AreSymmetricAndPositive) {
  TangentAtRest t(bar_of_all_sorts(), 2);
  const EdgeEnds ends = find_edge_ends(t.model);
  Multigrid levels(t.matrix, t.filter, t.pool, ends);
  ASSERT_TRUE(t.build(levels));
  EXPECT_EQ(levels.level_sizes()[1], t.model.node_count() - middles_of(ends));
  expect_symmetric_and_positive(levels, t);
  std::vector<double> x;
  EXPECT_LE(solved(t, levels, x).iterations, 20);
}

/// Those that run elsewhere know no level of corners.
TEST(CornerLevels, AreOfFramesAloneElsewhere) {
  Model model = held_bar(bar(ElementShape::hex20, {12, 4, 4}));
  ThreadPool pool(2);
  MechanicalSystem system(model, pool, {});
  system.begin_step(State::at_rest(model), 0);
  system.set_rest();
  system.evaluate();
  const Multigrid* levels = system.levels(false);
  ASSERT_NE(levels, nullptr);
  ASSERT_GE(levels->level_count(), 2U);
  EXPECT_NE(levels->level(0).P, nullptr);
  EXPECT_NE(levels->level(1).matrix, nullptr);
}

/// Fewer iterations than with levels of all nodes, and the same answer. Their number hardly grows with the mesh, and
/// does not depend on threads.
TEST(CornerLevels, TakeFewerIterations) {
  for (const ElementShape shape : {ElementShape::tet10, ElementShape::hex20}) {
    std::vector<int> counts;
    for (const int n : {3, 6}) {
      TangentAtRest t(held_bar(bar(shape, {4 * n, n, n})), 2);
      const EdgeEnds ends = find_edge_ends(t.model);
      EXPECT_GT(middles_of(ends), t.model.node_count() / 2);
      Multigrid frames(t.matrix, t.filter, t.pool), corners(t.matrix, t.filter, t.pool, ends);
      std::vector<double> x, y;
      const CgReport before = solved(t, frames, x), after = solved(t, corners, y);
      std::printf("%d unknowns: %d iterations with levels of all nodes, %d with corners\n", t.model.dof_count(),
                  before.iterations, after.iterations);
      EXPECT_EQ(after.status, CgStatus::converged);
      EXPECT_LT(after.iterations, (shape == ElementShape::hex20 ? 0.7 : 1.0) * before.iterations);
      counts.push_back(after.iterations);
      double largest = 0, apart = 0;
      for (std::size_t i = 0; i < x.size(); ++i) {
        largest = std::max(largest, std::abs(x[i]));
        apart = std::max(apart, std::abs(x[i] - y[i]));
      }
      EXPECT_LE(apart, 1e-6 * largest);
      if (n != 3) continue;
      TangentAtRest alone(held_bar(bar(shape, {4 * n, n, n})), 1);
      Multigrid by_one(alone.matrix, alone.filter, alone.pool, ends);
      std::vector<double> z;
      EXPECT_EQ(solved(alone, by_one, z).iterations, after.iterations);
      EXPECT_EQ(z, y);
    }
    EXPECT_LE(counts[1], counts[0] + 4);
  }
}

/// A quarter of a ring of few elements around, or of many: nodes farther than a twentieth of their edge from its middle
/// are nodes of the level of corners too.
TEST(CornerLevels, TakeCurvedElements) {
  struct Ring {
    std::array<int, 3> cells;
    bool all;  ///< nodes of edges move by the mean of their ends
  };
  for (const auto& [cells, all] : {Ring{{2, 6, 8}, false}, Ring{{12, 3, 6}, true}}) {
    ElementOptions o = bar(ElementShape::hex20, cells);
    ElementMesh mesh = generate_box({}, {{1, 1, 1}}, o.cells, {ElementFamily::hexahedra, 2, 6});
    const int corners_of_mesh = (cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1);
    const int around = cells[0] * (cells[1] + 1) * (cells[2] + 1);
    for (Vec3d& x : mesh.nodes) {
      const double angle = 0.5 * M_PI * x[0], radius = 1 + 0.3 * x[1];
      x = {{radius * std::sin(angle), radius * std::cos(angle), x[2]}};
    }
    Model model = element_model(o, std::move(mesh)).model;
    hold_face(model);
    TangentAtRest t(std::move(model), 2);
    const EdgeEnds ends = find_edge_ends(t.model);
    EXPECT_EQ(middles_of(ends), t.model.node_count() - corners_of_mesh - (all ? 0 : around));
    Multigrid frames(t.matrix, t.filter, t.pool), corners(t.matrix, t.filter, t.pool, ends);
    std::vector<double> x, y;
    const CgReport before = solved(t, frames, x), after = solved(t, corners, y);
    std::printf("ring, %d around: %d iterations with levels of all nodes, %d with corners\n", cells[0],
                before.iterations, after.iterations);
    EXPECT_EQ(after.status, CgStatus::converged);
    EXPECT_EQ(corners.level_sizes()[1], t.model.node_count() - middles_of(ends));
    EXPECT_LT(after.iterations, before.iterations);
  }
}

}  // namespace
}  // namespace fascia::corner_levels_test
