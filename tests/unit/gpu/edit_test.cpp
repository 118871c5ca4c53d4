#include "core/structure/edit.hpp"

#include "core/base/errors.hpp"
#include "core/linear/block_matrix.hpp"
#include "core/run/model_stepper.hpp"
#include "gpu/run/run.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <set>

/// Matter that leaves a model and joins it between steps, against a model that was built so.
namespace fascia::edit_test {

namespace {

constexpr int kFrames = 150, kVertices = 200, kGroups = 300, kElements = 2000, kTriangles = 200;
constexpr int kNewNodes = 100, kNewGroups = 60;

class Draw {
 public:
  double number(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }
  int index(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
  Vec3d vector(double size) { return {{number(-size, size), number(-size, size), number(-size, size)}}; }
  std::vector<int> some(int count, int first, int last) {
    std::set<int> chosen;
    while (static_cast<int>(chosen.size()) < count) chosen.insert(first + index(last - first));
    return {chosen.begin(), chosen.end()};
  }

 private:
  std::mt19937 random_{7};
};

struct Group {
  std::vector<int> nodes;
  std::vector<PointSample> points;
};

/// A recipe that both models are made from.
struct Recipe {
  std::vector<AddedNode> nodes;
  std::vector<Group> groups, new_groups;
  ElementBlockSpec elements;
  std::vector<ShellElementSpec> triangles;
  Edit edit;

  Recipe() {
    Draw draw;
    const Lame lame = Lame::from_young(1e4, 0.3);
    for (int i = 0; i < kFrames + kVertices + kNewNodes; ++i) {
      AddedNode node;
      node.X = draw.vector(1);
      node.kind = i < kFrames || i >= kFrames + kVertices ? FrameKind::rigid : FrameKind::vertex;
      node.inertia = {1, {}, node.kind == FrameKind::rigid ? Mat3d::diagonal(0.1) : Mat3d{}};
      nodes.push_back(node);
    }
    const auto group = [&](std::vector<int> of, std::size_t points) {
      Group g{std::move(of), {}};
      for (std::size_t q = 0; q < points; ++q) {
        PointSample p;
        p.volume = draw.number(0.5, 1);
        static_cast<Lame&>(p) = lame;
        p.stabilization = 0.1 * lame.mu;
        for (std::size_t k = 0; k < g.nodes.size(); ++k) {
          Influence influence{draw.number(0, 0.5), draw.vector(0.5), draw.vector(0.2), {}};
          for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) influence.B(a, b) = draw.number(-0.2, 0.2);
          p.influences.push_back(influence);
        }
        g.points.push_back(p);
      }
      return g;
    };
    for (int g = 0; g < kGroups; ++g) groups.push_back(group(draw.some(4, 0, kFrames), 8));
    for (int g = 0; g < kNewGroups; ++g) {
      std::vector<int> of = draw.some(2, 0, kFrames);
      for (const int node : draw.some(3, kFrames + kVertices, kFrames + kVertices + kNewNodes)) of.push_back(node);
      new_groups.push_back(group(of, 5));
    }
    for (int e = 0; e < kElements; ++e) {
      for (const int node : draw.some(4, kFrames, kFrames + kVertices)) elements.node.push_back(node);
      Vec3d sum;
      for (int a = 0; a < 4; ++a) {
        elements.gradient.push_back(a < 3 ? draw.vector(1) : sum * -1.0);
        if (a < 3) sum += elements.gradient.back();
      }
      elements.volume.push_back(draw.number(0.5, 1));
      elements.material.push_back({{lame}, 0, 0});
    }
    for (int t = 0; t < kTriangles; ++t) {
      const std::vector<int> corner = draw.some(3, 0, kFrames);
      ShellElementSpec triangle;
      std::copy(corner.begin(), corner.end(), triangle.node.begin());
      triangle.axes = Mat3d::identity() + rotation_increment(draw.vector(1));
      triangle.constants.g[0][0] = triangle.constants.g[1][1] = 1;
      triangle.constants.g[2][0] = triangle.constants.g[2][1] = -1;
      for (int i = 0, k = 0; i < 6; ++i)
        for (int j = 0; j <= i; ++j, ++k) {
          triangle.constants.membrane[k] = i == j ? 1e4 : 1e3;
          triangle.constants.bending[k] = i == j ? 1e2 : 10;
        }
      triangles.push_back(triangle);
    }
    edit.points = draw.some(1000, 0, 8 * kGroups);
    edit.elements = {{0, draw.some(1000, 0, kElements)}};
    edit.triangles = {{0, draw.some(60, 0, kTriangles)}};
    edit.nodes.assign(nodes.begin() + kFrames + kVertices, nodes.end());
    for (const Group& g : new_groups) edit.added.push_back({g.nodes, g.points, 0.1, {}});
  }

  /// @param edited  as after the edit
  Model model(bool edited) const {
    Model m;
    PointSetBuilder points;
    const std::size_t count = edited ? nodes.size() : at(kFrames + kVertices);
    for (std::size_t i = 0; i < count; ++i) {
      m.rest_position.push_back(nodes[i].X);
      m.rest_orientation.push_back(nodes[i].orientation);
      m.frame_kind.push_back(nodes[i].kind);
      m.inertia.push_back(nodes[i].inertia);
    }
    const auto left = [&](const std::vector<int>& lost, std::size_t i) {
      return edited && std::binary_search(lost.begin(), lost.end(), static_cast<int>(i));
    };
    for (std::size_t g = 0; g < groups.size(); ++g) {
      std::vector<PointSample> kept;
      for (std::size_t q = 0; q < 8; ++q)
        if (!left(edit.points, 8 * g + q)) kept.push_back(groups[g].points[q]);
      if (!kept.empty()) points.add_points(groups[g].nodes, kept, 0.1);
    }
    if (edited)
      for (const Group& g : new_groups) points.add_points(g.nodes, g.points, 0.1);
    ElementBlockSpec kept;
    for (std::size_t e = 0; e < elements.material.size(); ++e) {
      if (left(edit.elements[0].cells, e)) continue;
      for (std::size_t a = 4 * e; a < 4 * e + 4; ++a) {
        kept.node.push_back(elements.node[a]);
        kept.gradient.push_back(elements.gradient[a]);
      }
      kept.volume.push_back(elements.volume[e]);
      kept.material.push_back(elements.material[e]);
    }
    points.add_elements(make_element_block(kept));
    std::vector<ShellElementSpec> shells;
    for (std::size_t t = 0; t < triangles.size(); ++t)
      if (!left(edit.triangles[0].cells, t)) shells.push_back(triangles[t]);
    points.add_shell(make_shell_block(shells, 0.5));
    m.points = std::move(points).finish(m.frame_kind);
    return m;
  }
};

State moved(const Model& model) {
  Draw draw;
  State state = State::at_rest(model);
  for (std::size_t i = 0; i < state.u.size(); ++i) {
    state.u[i] = draw.vector(0.05);
    if (model.frame_kind[i] == FrameKind::rigid) state.D[i] = rotation_increment(draw.vector(0.3));
  }
  return state;
}

void expect_same(const std::vector<double>& a, const std::vector<double>& b, const char* what) {
  ASSERT_EQ(a.size(), b.size());
  double largest = 0, apart = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, std::abs(b[i]));
    apart = std::max(apart, std::abs(a[i] - b[i]));
  }
  EXPECT_GT(largest, 0) << what;
  EXPECT_LE(apart, 1e-12 * largest) << what;
}

TEST(Edits, AnEditedModelIsOneThatWasBuiltSo) {
  const Recipe recipe;
  Model edited = recipe.model(false);
  apply(recipe.edit, edited);
  const Model built = recipe.model(true);
  ASSERT_EQ(edited.node_count(), built.node_count());
  const State state = moved(built);
  Draw draw;
  std::vector<double> direction(at(built.dof_count()));
  for (double& d : direction) d = draw.number(-1, 1);
  struct Evaluated {
    std::vector<double> gradient, product, by_matrix;
    double energy;
  };
  const auto evaluated = [&](const Model& model) {
    ThreadPool pool(2);
    CpuExecutor executor(model.points, pool);
    Evaluated out;
    for (auto* vector : {&out.gradient, &out.product, &out.by_matrix}) vector->resize(direction.size());
    executor.start_from(state);
    out.energy = executor.gradient(state, {}, out.gradient).total();
    Linearization lin;
    executor.linearize(state, {}, Tangent::full, lin);
    executor.multiply(lin, direction, out.product);
    BlockMatrix matrix(model.points);
    executor.assemble(lin, matrix);
    matrix.multiply(pool, direction, out.by_matrix);
    return out;
  };
  const Evaluated one = evaluated(edited), other = evaluated(built);
  EXPECT_NEAR(one.energy, other.energy, 1e-12 * other.energy);
  expect_same(one.gradient, other.gradient, "forces");
  expect_same(one.product, other.product, "product");
  expect_same(one.by_matrix, other.by_matrix, "matrix");

  const gpu::DeviceEvaluation there = gpu::evaluate_on_host(edited, state, {}, {}, direction);
  const gpu::DeviceEvaluation so_built = gpu::evaluate_on_host(built, state, {}, {}, direction);
  expect_same(there.gradient, so_built.gradient, "forces in host space");
  expect_same(there.product, so_built.product, "product in host space");
  expect_same(there.gradient, one.gradient, "forces of both");
}

/// However far nodes part, what left them makes no number that is not finite.
TEST(Edits, WhatHasLeftIsNotEvaluated) {
  Recipe recipe;
  recipe.edit.elements[0].cells.resize(kElements);
  std::iota(recipe.edit.elements[0].cells.begin(), recipe.edit.elements[0].cells.end(), 0);
  Model model = recipe.model(false);
  apply(recipe.edit, model);
  State state = moved(model);
  for (int i = kFrames; i < kFrames + kVertices; ++i) state.u[at(i)] *= -1e6;
  ThreadPool pool(1);
  CpuExecutor executor(model.points, pool);
  std::vector<double> gradient(at(model.dof_count()));
  EXPECT_TRUE(std::isfinite(executor.gradient(state, {}, gradient).total()));
  for (int i = kFrames; i < kFrames + kVertices; ++i) EXPECT_EQ(gradient[at(model.points.dofs.begin(i))], 0);
}

template <class T>
std::vector<unsigned char> bytes_of(const T& values) {
  std::vector<unsigned char> bytes(values.size() * sizeof(values[0]));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

TEST(Edits, ARefusedEditLeavesEveryBit) {
  const Recipe recipe;
  Model model = recipe.model(false);
  const PointSet& set = model.points;
  const auto all = [&] {
    return std::tuple(bytes_of(set.shape), bytes_of(set.material), set.lane_point, set.slot_node, set.node_part,
                      bytes_of(set.blocks[0].volume), bytes_of(set.blocks[0].gradient),
                      bytes_of(set.shells[0].constants), set.shells[0].node, model.node_count(), model.inertia[3].mass);
  };
  auto before = all();
  const auto refused = [&](const Edit& edit) -> std::string {
    try {
      apply(edit, model);
    } catch (const InputError& e) {
      EXPECT_TRUE(all() == before);
      return e.what();
    }
    return "";
  };
  Edit edit = recipe.edit;
  edit.points.push_back(8 * kGroups);
  EXPECT_EQ(refused(edit), "an edit takes point 2400, which is not there or has left");
  edit = recipe.edit;
  edit.points.push_back(edit.points[0]);
  EXPECT_NE(refused(edit), "");
  edit = recipe.edit;
  edit.elements[0].block = 1;
  EXPECT_EQ(refused(edit), "an edit takes elements of block 1; the model has 1");
  edit = recipe.edit;
  edit.triangles[0].cells.push_back(-1);
  EXPECT_EQ(refused(edit), "an edit takes triangle -1, which is not there or has left");
  edit = recipe.edit;
  edit.inertia = {{3, {0.6, {}, {}}}, {3, {0.6, {}, {}}}};
  EXPECT_EQ(refused(edit).substr(0, 32), "an edit leaves node 3 a mass of ");
  edit = recipe.edit;
  edit.added[0].nodes[0] = 10000;
  EXPECT_EQ(refused(edit), "an edit adds points to node 10000; the model has 450 with those that it adds");
  edit = recipe.edit;
  edit.added[0].points[0].influences.pop_back();
  EXPECT_NE(refused(edit).find("influences of 5 nodes"), std::string::npos);
  edit = recipe.edit;
  edit.added[0].rule.law = Law::mooney_rivlin;  // without its constants
  EXPECT_NE(refused(edit).find("constants of its law's own"), std::string::npos);
  EXPECT_EQ(refused(recipe.edit), "");
  before = all();
  EXPECT_EQ(refused({.points = {recipe.edit.points[0]}}).substr(0, 20), "an edit takes point ");
}

/// A beam that is cut while it swings goes on as one that was built without what was cut, from the same state.
TEST(Edits, ASteppedModelGoesOn) {
  const auto beam = [] {
    test::BlockOptions o;
    o.grid = {7, 3, 3};
    o.size = {{6, 1, 1}};
    test::BuiltModel built = test::build({test::block_spec(o)});
    FrameConstraint c;
    for (int i = 0; i < built.model.node_count(); ++i) {
      if (built.model.rest_position[at(i)][0] > 1e-9) continue;
      c.node = i;
      c.translations = c.rotations = 3;
      built.model.constraints.push_back(c);
    }
    test::add_gravity(built.model, {{0, -9.81, 0}});
    return built.model;
  };
  Edit cut;  // half of the depth in the middle of the beam
  Model model = beam();
  const PointSet& set = model.points;
  for (int group = 0; group < set.group_count(); ++group) {
    const std::span<const int> nodes = set.nodes(group);
    const auto above = [&](int node) { return model.rest_position[at(node)][1] > 0.49; };
    const auto middle = [&](int node) { return std::abs(model.rest_position[at(node)][0] - 3) < 1.01; };
    if (!std::all_of(nodes.begin(), nodes.end(), above) || !std::all_of(nodes.begin(), nodes.end(), middle)) continue;
    for (int lane = 0; lane < kGroupSize; ++lane)
      if (const int point = set.lane_point[at(group * kGroupSize + lane)]; point >= 0) cut.points.push_back(point);
  }
  ASSERT_GT(cut.points.size(), 10u);
  ThreadPool pool(2);
  SolverSettings settings;
  const SteppingSettings stepping{false, TimeScheme::newmark, 0};
  const FactorFunction factors = [](double) { return std::vector<double>{1}; };
  for (const bool device : {false, true}) {
    Model edited = beam();
    const State rest = State::at_rest(edited);
    const auto made = [&](const Model& of, const State& start) {
      return device ? gpu::make_stepper_on_host(of, start, settings, stepping)
                    : make_stepper(of, start, pool, settings, stepping);
    };
    const std::unique_ptr<ModelStepper> stepper = made(edited, rest);
    for (int step = 0; step < 5; ++step) ASSERT_EQ(stepper->step(factors, 0.02).status, RunStatus::converged);
    const State there = stepper->state();
    apply(cut, edited);
    stepper->model_changed(factors);
    Model without = beam();
    apply(cut, without);
    const std::unique_ptr<ModelStepper> fresh = made(without, there);
    const std::unique_ptr<ModelStepper> whole = made(model, there);
    for (int step = 0; step < 40; ++step)
      for (ModelStepper* each : {stepper.get(), fresh.get(), whole.get()})
        ASSERT_EQ(each->step(factors, 0.05).status, RunStatus::converged);
    const std::size_t tip = at(edited.node_count() - 1);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(stepper->state().u[tip][k], fresh->state().u[tip][k]);
    EXPECT_GT(std::abs(stepper->state().u[tip][1] / whole->state().u[tip][1] - 1), 0.02);  // it swings otherwise
  }
}

}  // namespace

}  // namespace fascia::edit_test
