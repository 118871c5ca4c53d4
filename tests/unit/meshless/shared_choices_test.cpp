#include "core/base/errors.hpp"
#include "tests/unit/meshless/shared_models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

/// What becomes of frames where others share their nodes: which are replaced, left out or refused.
namespace fascia::shared_choices_test {
namespace {

using namespace test;

SharedModel hosted(HostKind kind, int cells = 2) {
  SharedModel s;
  HostOptions host;
  host.kind = kind;
  host.cells = cells;
  add_host(s, host);
  return s;
}

double energy_of(const Model& model, const State& state, std::vector<double>* gradient = nullptr) {
  ThreadPool pool(1);
  std::vector<double> unused(at(model.dof_count()));
  return CpuExecutor(model.points, pool).gradient(state, {}, gradient != nullptr ? *gradient : unused).total();
}

bool says(const std::vector<std::string>& messages, const std::string& part) {
  return std::any_of(messages.begin(), messages.end(),
                     [&](const std::string& m) { return m.find(part) != std::string::npos; });
}

template <class Act>
void expect_refused(const Act& act, Blame blame, const std::string& part) {
  try {
    act();
    ADD_FAILURE() << "accepted; it should name " << part;
  } catch (const InputError& e) {
    EXPECT_EQ(e.blame, blame) << e.what();
    EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
  }
}

/// A square sheet of unit width at x0 on a grid of 3 × 3 frames.
CloudSpec sheet_at(double x0, double width, int count, const std::vector<SharedFrame>& shared = {}) {
  CloudSpec spec;
  static_cast<BodyMatter&>(spec) = block_spec({});
  ThinGridSpec thin;
  thin.grid.origin = {{x0, 0, 0}};
  thin.grid.count = {count, 3};
  thin.grid.edge = {{{width, 0, 0}}, {{0, 1, 0}}};
  thin.extent = [](const Vec3d&) { return 0.02; };
  SheetPart sheet;
  sheet.surface.points = {{{x0, 0, 0}}, {{x0 + width, 0, 0}}, {{x0 + width, 1, 0}}, {{x0, 1, 0}}};
  sheet.surface.triangles = {{0, 1, 2}, {0, 2, 3}};
  sheet.thickness = {0.02, 0.02};
  thin.parts.sheets.push_back(sheet);
  thin.shared = shared;
  grid_cloud(thin, spec);
  return spec;
}

/// The energy, forces and inertia of one body are those of its halves that share their interface.
void expect_same(const Model& whole, const Model& halves) {
  ASSERT_EQ(whole.node_count(), halves.node_count());
  std::vector<int> twin;
  for (const Vec3d& x : whole.rest_position) {
    const auto same = [&](const Vec3d& y) { return norm(x - y) < 1e-12; };
    const auto found = std::find_if(halves.rest_position.begin(), halves.rest_position.end(), same);
    ASSERT_NE(found, halves.rest_position.end());
    twin.push_back(static_cast<int>(found - halves.rest_position.begin()));
  }
  const State state = random_state(whole, 0.02, 0.3);
  State mapped = State::at_rest(halves);
  for (std::size_t i = 0; i < twin.size(); ++i) {
    mapped.u[at(twin[i])] = state.u[i];
    mapped.D[at(twin[i])] = state.D[i];
  }
  std::vector<double> f(at(whole.dof_count())), g(f.size());
  const double one = energy_of(whole, state, &f), two = energy_of(halves, mapped, &g);
  EXPECT_NEAR(one, two, 1e-12 * one);
  const double scale = test::norm(f);
  for (std::size_t i = 0; i < twin.size(); ++i) {
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(f[6 * i + k], g[at(6 * twin[i]) + k], 1e-12 * scale);
    const FrameInertia &a = whole.inertia[i], &b = halves.inertia[at(twin[i])];
    EXPECT_NEAR(a.mass, b.mass, 1e-12 * a.mass);
    EXPECT_LT(norm(a.first - b.first), 1e-12 * a.mass);
    EXPECT_LT(norm(a.second - b.second), 1e-12 * a.mass);
  }
}

TEST(SharedChoices, HalvesOfAGridAreTheWhole) {
  for (const GridWeightKind weights : {GridWeightKind::trilinear, GridWeightKind::linear}) {
    BlockOptions o;
    o.weights = weights;
    o.grid = {5, 3, 3};
    o.size = {{2, 1, 1}};
    o.translation = {{-1, 0, 0}};
    const BuiltModel whole = block(o);
    SharedModel s;
    BlockOptions half;
    half.weights = weights;
    half.translation = {{-1, 0, 0}};
    s.host = std::make_shared<GridBody>(block_spec(half), s.model, s.points);
    for (int i = 26; i >= 0; --i)
      if (std::abs(s.model.rest_position[at(i)][0]) < 1e-12) s.shared.push_back({i, s.model.rest_position[at(i)]});
    half.translation = {};
    add_grid(s, half);
    s.finish();
    EXPECT_TRUE(says(s.body->choices(), "9 frames coincide with shared ones"));
    EXPECT_EQ(s.body->node_count(), 18);
    EXPECT_EQ(s.body->shared_nodes().size(), 9U);
    expect_same(whole.model, s.model);
  }
}

TEST(SharedChoices, HalvesOfASheetAreTheWhole) {
  const BuiltModel whole = build_cloud(sheet_at(-1, 2, 5));
  SharedModel s;
  const CloudBody host(sheet_at(-1, 1, 3), s.model, s.points);
  for (const int i : {8, 2, 5}) s.shared.push_back({i, s.model.rest_position[at(i)]});
  const CloudBody body(sheet_at(0, 1, 3, s.shared), s.model, s.points);
  s.finish();
  EXPECT_TRUE(says(body.choices(), "3 frames coincide with shared ones"));
  EXPECT_EQ(body.shared_nodes(), (std::vector<int>{2, 5, 8}));
  EXPECT_EQ(body.nodes_on_boundary().size(), 9U);
  expect_same(whole.model, s.model);
}

TEST(SharedChoices, ListedFramesThatCoincideAreReplaced) {
  SharedModel s = hosted(HostKind::frames);
  ListedChoice listed;
  for (const Vec3d& x : box_surface({}, {{1, 1, 1}}, 2, 2, 2).points) listed.position.push_back(x);
  listed.position.push_back({{0.5, 0.5, 0.5}});
  ASSERT_EQ(listed.position.size(), 27U);
  listed.rotation.assign(27, Vec3d{});
  listed.rotation.back() = {{0, 0, 1}};
  add_cloud(s, unit_scatter(listed));
  EXPECT_EQ(s.body->node_count(), 18);
  EXPECT_TRUE(says(s.messages, "9 frames coincide with shared ones and were replaced"));
  EXPECT_NEAR(s.model.rest_orientation.back()(1, 0), std::sin(1.0), 1e-15);
}

TEST(SharedChoices, OwnFramesStandAroundSharedOnes) {
  SharedModel s = hosted(HostKind::frames, 4);
  add_cloud(s, unit_scatter(SpacedChoice{0.3, 1}));
  for (int k = 0; k < s.body->node_count(); ++k)
    for (const SharedFrame& f : s.shared)
      EXPECT_GE(norm(s.model.rest_position[at(s.body->first_node() + k)] - f.x), 0.4 * 0.3);
  SharedModel counted = hosted(HostKind::frames, 4);
  add_cloud(counted, unit_scatter(CountedChoice{40, 1}));
  EXPECT_NEAR(counted.body->node_count(), 40, 2);
}

/// The sharing nodes are enough: the body needs none of its own.
TEST(SharedChoices, NoOwnFramesAreNeeded) {
  for (const bool listed : {false, true}) {
    SharedModel s;
    BlockOptions o;
    s.host = std::make_shared<GridBody>(block_spec(o), s.model, s.points);
    for (int i = 0; i < s.model.node_count(); ++i) s.shared.push_back({i, s.model.rest_position[at(i)]});
    add_cloud(s, unit_scatter(listed ? SampleChoice(ListedChoice{}) : SampleChoice(CountedChoice{0, 1})));
    s.finish();
    EXPECT_EQ(s.body->node_count(), 0);
    EXPECT_EQ(s.body->shared_nodes().size(), 27U);
    EXPECT_GT(energy_of(s.model, random_state(s.model, 0.01, 0)), 0);
  }
}

TEST(SharedChoices, TheOrderOfSharesDoesNotMatter) {
  for (const HostKind kind : {HostKind::turning, HostKind::still, HostKind::rigid}) {
    SharedModel s = hosted(kind), other = hosted(kind);
    std::reverse(other.shared.begin(), other.shared.end());
    std::swap(other.shared[1], other.shared[5]);
    for (SharedModel* m : {&s, &other}) {
      add_cloud(*m, unit_scatter(SpacedChoice{0.4, 1}));
      m->finish();
    }
    ASSERT_EQ(s.model.node_count(), other.model.node_count());
    const State state = random_state(s.model, 0.02, 0.2);
    const double a = energy_of(s.model, state), b = energy_of(other.model, state);
    EXPECT_NEAR(a, b, 1e-12 * a);
  }
}

TEST(SharedChoices, NodesOutOfReachAreLeftOut) {
  for (const std::optional<int> neighbours : {std::optional<int>(), std::optional<int>(8)}) {
    SharedModel s = hosted(HostKind::frames);
    s.shared.push_back({0, {{-4, 0, 0}}});
    s.shared.push_back({1, {{-4, 1, 0}}});
    ScatterSpec scatter = unit_scatter(SpacedChoice{0.34, 1});
    scatter.neighbours = neighbours;
    add_cloud(s, scatter);
    EXPECT_TRUE(says(s.messages, "2 shared nodes that reach no point of the body"));
    EXPECT_FALSE(std::binary_search(s.body->shared_nodes().begin(), s.body->shared_nodes().end(), 0));
    EXPECT_FALSE(s.body->shared_nodes().empty());
  }
}

TEST(SharedChoices, GridsRefuseNodesBesideTheirFrames) {
  SharedModel s = hosted(HostKind::frames, 3);
  expect_refused([&] { add_grid(s); }, Blame::frames, "0.167 m away); use scattered frames (poisson_disk)");
  SharedModel twice = hosted(HostKind::frames);
  twice.shared.push_back({0, twice.shared[0].x});
  expect_refused([&] { add_grid(twice); }, Blame::frames, "two shared nodes");
  expect_refused([] { sheet_at(0, 1, 3, {{0, {{0.1, 0, 0}}}}); }, Blame::frames, "0.1 m away");
}

TEST(SharedChoices, VerticesWithoutRotationNeedLinearWeights) {
  SharedModel kernel = hosted(HostKind::still);
  expect_refused(
      [&] {
        add_cloud(kernel, unit_scatter(SpacedChoice{0.34, 1}, ScatteredKind::wendland));
      },
      Blame::weights, "rotations = true");
  SharedModel s = hosted(HostKind::still);
  std::vector<SharedFrame> edge;
  for (const SharedFrame& f : s.shared)
    if (std::abs(f.x[2]) < 1e-12) edge.push_back(f);
  expect_refused([&] { const CloudBody body(sheet_at(0, 1, 3, edge), s.model, s.points); }, Blame::frames,
                 "rotations = true");
}

/// Without stabilisation nothing holds a frame whose points all follow vertices without rotation.
TEST(SharedChoices, LooseRotationsAreRefused) {
  BlockOptions o;
  o.grid = {2, 3, 3};
  SharedModel s = hosted(HostKind::still);
  add_grid(s, o);
  o.drilling = 0;
  SharedModel loose = hosted(HostKind::still);
  expect_refused([&] { add_grid(loose, o); }, Blame::frames, "nothing holds the rotation");
}

/// Rotations of vertices that only this body holds count; those of other frames do not.
TEST(SharedChoices, PointsMustHoldRotationsOfVertices) {
  for (const HostKind kind : {HostKind::frames, HostKind::turning, HostKind::still}) {
    SharedModel s = hosted(kind, 4);
    ScatterSpec scatter = unit_scatter(SpacedChoice{0.5, 1});
    scatter.points = CountedChoice{30, 1};
    if (kind == HostKind::turning)
      expect_refused([&] { add_cloud(s, scatter); }, Blame::points, "shared vertices");
    else
      add_cloud(s, scatter);
  }
}

/// A lattice of nodes finer or coarser than the body's own frames, in the midst of its matter. Of those eight times
/// finer, points cannot tell all apart, and of those four times finer not always the last few.
TEST(SharedChoices, DenseNodesMayLieInside) {
  for (const bool turns : {false, true})
    for (const double step : {0.05, 0.1, 0.4}) {
      SharedModel s;
      const int n = static_cast<int>(std::lround(0.4 / step)) + 1;
      for (int i = 0; i < n * n * n; ++i) {
        const Vec3d x{{0.3 + step * (i % n), 0.3 + step * (i / n % n), 0.3 + step * (i / (n * n))}};
        s.model.rest_position.push_back(x);
        s.model.rest_orientation.push_back(Mat3d::identity());
        s.model.frame_kind.push_back(turns ? FrameKind::rigid : FrameKind::vertex);
        s.model.inertia.push_back({1, {}, Mat3d::diagonal(1)});
        s.shared.push_back({i, x, {}, turns});
      }
      add_cloud(s, unit_scatter(SpacedChoice{step < 0.4 ? 0.4 : 0.2, 1}));
      s.finish();
      std::size_t most = 0;
      for (std::size_t q = 0; q < s.body->points().size(); ++q)
        most = std::max(most, s.body->attach_point(q).nodes.size());
      std::printf("%d nodes %g apart: %zu shared, up to %zu frames a point; %s\n", n * n * n, step,
                  s.body->shared_nodes().size(), most, s.body->quality().c_str());
      if (step < 0.1) {
        EXPECT_TRUE(says(s.messages, "denser than its points"));
      } else {
        EXPECT_GE(s.body->shared_nodes().size(), s.shared.size() * 96 / 100);
      }
      EXPECT_NEAR(energy_of(s.model, rigid_state(s.model, rotation_increment({{0.7, -1.1, 2.0}}), {})), 0, 1e-18);
    }
}

}  // namespace
}  // namespace fascia::shared_choices_test
