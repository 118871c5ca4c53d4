#include "shells/generate.hpp"

#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "shells/surface_checks.hpp"
#include "tests/unit/io/mesh_samples.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

namespace fascia::generate_test {
namespace {

using samples::input_error;

constexpr double pi = std::numbers::pi;
constexpr Turn whole{}, slit{0, 2 * pi, false};

Vec3d normal_of(const ShellMesh& mesh, std::size_t t) {
  const auto X = [&](std::size_t n) { return mesh.nodes[at(mesh.triangles[t][n])]; };
  return normalized(cross(X(1) - X(0), X(2) - X(0)));
}

/// V − E + F.
int euler_number(const ShellMesh& mesh) {
  std::set<std::pair<int, int>> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t n = 0; n < 3; ++n) edges.insert(std::minmax(t[n], t[(n + 1) % 3]));
  return static_cast<int>(mesh.nodes.size()) - static_cast<int>(edges.size()) + static_cast<int>(mesh.triangles.size());
}

/// Every node belongs to a triangle, and neighbours run along their edges in opposite directions.
void expect_sound(const ShellMesh& mesh) {
  std::vector<bool> used(mesh.nodes.size());
  std::set<std::pair<int, int>> directed;
  for (const auto& t : mesh.triangles)
    for (std::size_t n = 0; n < 3; ++n) {
      used[at(t[n])] = true;
      EXPECT_TRUE(directed.insert({t[n], t[(n + 1) % 3]}).second) << "two triangles run along an edge alike";
    }
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
  EXPECT_TRUE(mesh.messages.empty());
  EXPECT_TRUE(shell_quality(mesh).messages.empty());
}

/// The error of the area falls to a quarter where the cells are halved.
void expect_second_order(double exact, const std::function<ShellMesh(int)>& generate) {
  const double coarse = area(generate(1)) - exact, fine = area(generate(2)) - exact;
  std::printf("area %.6g: error %.3e, halved cells %.3e, order %.3f\n", exact, coarse, fine, std::log2(coarse / fine));
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.05);
}

TEST(ShellRectangle, NodesRunAlongTheFirstEdge) {
  const ShellMesh mesh = rectangle({{1, 2, 3}}, {{4, 0, 0}}, {{1, 2, 0}}, {4, 2}, Diagonal::right);
  ASSERT_EQ(mesh.nodes.size(), 15u);
  EXPECT_EQ(mesh.nodes[1], (Vec3d{{2, 2, 3}}));
  EXPECT_EQ(mesh.nodes[14], (Vec3d{{6, 4, 3}}));
  EXPECT_NEAR(area(mesh), 8, 8e-15);
  EXPECT_EQ(euler_number(mesh), 1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) EXPECT_NEAR(normal_of(mesh, t)[2], 1, 1e-15);
  expect_sound(mesh);
}

TEST(ShellRectangle, Diagonals) {
  const auto cut = [](Diagonal diagonal) {
    return rectangle({}, {{1, 0, 0}}, {{0, 1, 0}}, {2, 2}, diagonal).triangles;
  };
  using Triangles = std::vector<std::array<int, 3>>;
  EXPECT_EQ(cut(Diagonal::right),
            (Triangles{{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {3, 4, 7}, {3, 7, 6}, {4, 5, 8}, {4, 8, 7}}));
  EXPECT_EQ(cut(Diagonal::left),
            (Triangles{{0, 1, 3}, {1, 4, 3}, {1, 2, 4}, {2, 5, 4}, {3, 4, 6}, {4, 7, 6}, {4, 5, 7}, {5, 8, 7}}));
  // All four diagonals meet in the middle, node 4.
  EXPECT_EQ(cut(Diagonal::alternating),
            (Triangles{{0, 1, 4}, {0, 4, 3}, {1, 2, 4}, {2, 5, 4}, {3, 4, 6}, {4, 7, 6}, {4, 5, 8}, {4, 8, 7}}));
}

TEST(ShellAnnulus, AreaAndDirections) {
  const Vec3d center{{1, 2, 3}}, normal{{0, 0, 2}};
  expect_second_order(3 * pi, [&](int n) {
    return annulus(center, normal, 1, 2, whole, {n, 24 * n}, Diagonal::right);
  });
  for (const Diagonal diagonal : {Diagonal::right, Diagonal::left, Diagonal::alternating}) {
    const ShellMesh mesh = annulus(center, normal, 1, 2, whole, {3, 24}, diagonal);
    EXPECT_EQ(mesh.nodes.size(), 4u * 24);
    EXPECT_EQ(euler_number(mesh), 0);
    EXPECT_EQ(holes(mesh).size(), 2u);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) EXPECT_NEAR(normal_of(mesh, t)[2], 1, 1e-14);
    expect_sound(mesh);
  }
}

std::string names_of(const ShellMesh& mesh) {
  std::string names;
  for (const BodyGroup& g : mesh.groups)
    names += g.name + ":" + std::to_string(g.nodes.size()) + "/" + std::to_string(g.cells.size()) + " ";
  return names;
}

/// Nodes of a group pass a test, and no other nodes do.
template <class Test>
void expect_group(const ShellMesh& mesh, const std::string& name, const Test& test) {
  const auto group =
      std::find_if(mesh.groups.begin(), mesh.groups.end(), [&](const auto& g) { return g.name == name; });
  ASSERT_NE(group, mesh.groups.end()) << name;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    EXPECT_EQ(test(mesh.nodes[i]), std::binary_search(group->nodes.begin(), group->nodes.end(), static_cast<int>(i)))
        << name << ", node " << i;
}

TEST(ShellGenerators, EdgesAndFacesAreGroups) {
  const ShellMesh plate = rectangle({}, {{2, 0, 0}}, {{0, 1, 0}}, {4, 3}, Diagonal::left);
  EXPECT_EQ(names_of(plate), "u0:4/0 u1:4/0 v0:5/0 v1:5/0 ");
  expect_group(plate, "u1", [](const Vec3d& X) { return X[0] == 2; });
  expect_group(plate, "v0", [](const Vec3d& X) { return X[1] == 0; });
  EXPECT_EQ(names_of(annulus({}, {{0, 0, 1}}, 6, 10, whole, {4, 30}, Diagonal::right)), "inner:30/0 outer:30/0 ");
  const ShellMesh split = annulus({}, {{0, 0, 1}}, 6, 10, slit, {4, 30}, Diagonal::right);
  EXPECT_EQ(names_of(split), "inner:31/0 outer:31/0 start:5/0 end:5/0 ");
  EXPECT_EQ(split.groups[2].nodes, (std::vector<int>{0, 1, 2, 3, 4}));
  EXPECT_EQ(split.groups[3].nodes, (std::vector<int>{150, 151, 152, 153, 154}));
  const ShellMesh drum = cylinder_skin({}, {{0, 0, 3}}, 1, whole, true, {3, 6}, Diagonal::right);
  EXPECT_EQ(names_of(drum), "from:6/0 to:6/0 side:24/36 cap_to:7/6 cap_from:7/6 ");
  expect_group(drum, "cap_to", [](const Vec3d& X) { return X[2] == 3; });
  expect_group(drum, "cap_from", [](const Vec3d& X) { return X[2] == 0; });
  expect_group(drum, "to", [](const Vec3d& X) { return X[2] == 3 && norm(X) > 3.1; });
  const Turn quarter{0, pi / 2, false};
  EXPECT_EQ(names_of(cylinder_skin({}, {{0, 0, 3}}, 1, quarter, false, {3, 6}, Diagonal::right)),
            "start:4/0 end:4/0 from:7/0 to:7/0 ");
}

TEST(ShellAnnulus, ASlitHasEdgesApart) {
  const ShellMesh mesh = annulus({}, {{0, 0, 1}}, 6, 10, slit, {4, 30}, Diagonal::right);
  EXPECT_EQ(mesh.nodes.size(), 5u * 31);
  EXPECT_EQ(euler_number(mesh), 1);
  EXPECT_EQ(holes(mesh).size(), 1u);
  for (std::size_t i = 0; i < 5; ++i) {
    const Vec3d expected{{6.0 + static_cast<double>(i), 0, 0}};
    EXPECT_LT(norm(mesh.nodes[i] - expected), 1e-14);
    EXPECT_LT(norm(mesh.nodes[5 * 30 + i] - expected), 1e-14) << "the last edge lies on the first";
  }
}

TEST(ShellAnnulus, ASectorTurnsAboutTheNormal) {
  const ShellMesh mesh = annulus({}, {{0, 0, 1}}, 1, 2, {0, pi / 2, false}, {1, 2}, Diagonal::right);
  EXPECT_LT(norm(mesh.nodes[1] - Vec3d{{2, 0, 0}}), 1e-15);
  EXPECT_LT(norm(mesh.nodes[3] - Vec3d{{std::sqrt(2), std::sqrt(2), 0}}), 1e-15);
  EXPECT_LT(norm(mesh.nodes[5] - Vec3d{{0, 2, 0}}), 1e-15);
}

TEST(ShellCylinder, AnglesStartAtTheNextAxis) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) {
      Vec3d to{}, next{};
      to[axis] = 3 * sign;
      next[(axis + 1) % 3] = 1;
      EXPECT_LT(norm(angle_origin(to) - next), 1e-15);
      const ShellMesh mesh = cylinder_skin({}, to, 2, whole, false, {1, 8}, Diagonal::right);
      EXPECT_LT(norm(mesh.nodes[0] - next * 2), 1e-15);
      EXPECT_LT(norm(mesh.nodes[2] - cross(normalized(to), next) * 2), 1e-15) << "right-handed about from → to";
    }
  for (const Vec3d& axis : {Vec3d{{1, 1, 1}}, Vec3d{{-1, 2, 0.5}}, Vec3d{{1, 1 + 1e-15, 0}}}) {
    EXPECT_NEAR(dot(angle_origin(axis), axis), 0, 1e-15 * norm(axis));
    EXPECT_NEAR(norm(angle_origin(axis)), 1, 1e-15);
  }
  EXPECT_GT(angle_origin({{1, 1, 1}})[1], 0.8) << "of equally near axes the first counts";
}

TEST(ShellCylinder, OpenSkin) {
  const Vec3d from{{1, 0, -2}}, to{{3, 1, 0}};
  expect_second_order(2 * pi * 0.5 * 3, [&](int n) {
    return cylinder_skin(from, to, 0.5, whole, false, {2 * n, 16 * n}, Diagonal::alternating);
  });
  const ShellMesh mesh = cylinder_skin(from, to, 0.5, whole, false, {5, 16}, Diagonal::alternating);
  EXPECT_EQ(mesh.nodes.size(), 6u * 16);
  EXPECT_EQ(euler_number(mesh), 0);
  EXPECT_EQ(holes(mesh).size(), 2u);
  const Vec3d axis = normalized(to - from);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3d d = middle(mesh, t) - from, outward = normalized(d - dot(d, axis) * axis);
    EXPECT_GT(dot(normal_of(mesh, t), outward), 0.98);
  }
  expect_sound(mesh);
  const ShellMesh quarter = cylinder_skin(from, to, 0.5, {0.5, 0.5 + pi / 2, false}, false, {5, 16}, Diagonal::left);
  EXPECT_EQ(quarter.nodes.size(), 6u * 17);
  EXPECT_EQ(holes(quarter).size(), 1u);
  EXPECT_NEAR(area(quarter), 3 * pi / 4, 3 * pi / 4 * (pi * pi / 4 / 24 / 256 * 1.01));  // of a chord: θ²/24
}

TEST(ShellCylinder, CapsCloseIt) {
  expect_second_order(2 * pi * 3 + 2 * pi, [](int n) {
    return cylinder_skin({}, {{0, 0, 3}}, 1, whole, true, {6 * n, 16 * n}, Diagonal::right);
  });
  for (const int around : {3, 4, 5, 6, 7, 8, 9, 10, 12, 16, 17, 24, 31, 48, 64, 100}) {
    SCOPED_TRACE(around);
    const int along = std::max(1, static_cast<int>(std::lround(3 * around / (2 * pi))));
    const ShellMesh mesh = cylinder_skin({}, {{0, 0, 3}}, 1, whole, true, {along, around}, Diagonal::right);
    EXPECT_TRUE(closed(mesh));
    EXPECT_EQ(euler_number(mesh), 2);
    const double polygon = around / 2.0 * std::sin(2 * pi / around);
    const double rounding = 2.3e-16 * static_cast<double>(mesh.triangles.size());  // of a sum of as many terms
    EXPECT_NEAR(enclosed_volume(mesh) / (3 * polygon), 1, rounding);
    EXPECT_NEAR(area(mesh) / (2 * polygon + 6 * around * std::sin(pi / around)), 1, rounding) << "caps are flat";
    EXPECT_LT(shell_quality(mesh).worst_aspect, around == 3 ? 3.5 : 2.5) << "two is half a square";
    expect_sound(mesh);
  }
}

TEST(ShellEllipsoid, RoundAndClosed) {
  expect_second_order(4 * pi, [](int n) { return ellipsoid_skin({}, {{1, 1, 1}}, 16 * n); });
  // a = b = 1, c = 2: 2π (1 + c/e asin e), e² = 1 − 1/c².
  const double e = std::sqrt(0.75);
  expect_second_order(2 * pi * (1 + 2 / e * std::asin(e)), [](int n) {
    return ellipsoid_skin({{1, 2, 3}}, {{1, 1, 2}}, 24 * n);
  });
  for (const int around : {4, 8, 16, 32, 64}) {
    const ShellMesh mesh = ellipsoid_skin({{5, 0, 0}}, {{2, 2, 2}}, around);
    EXPECT_EQ(mesh.nodes.size(), static_cast<std::size_t>(around * around / 4 + 2));
    EXPECT_TRUE(closed(mesh));
    EXPECT_EQ(euler_number(mesh), 2);
    EXPECT_GT(enclosed_volume(mesh), 0);
    for (const Vec3d& X : mesh.nodes) EXPECT_NEAR(norm(X - Vec3d{{5, 0, 0}}), 2, 1e-14);
    EXPECT_LT(shell_quality(mesh).worst_aspect, 2) << "no worse than half a square, at the ends of the axes too";
    expect_sound(mesh);
  }
}

TEST(ShellGenerators, RefuseWhatIsNoSurface) {
  const Vec3d x{{1, 0, 0}}, y{{0, 1, 0}}, z{{0, 0, 1}};
  const auto right = Diagonal::right;
  EXPECT_EQ(input_error([&] {
              rectangle({}, x, x * 2, {1, 1}, right);
            }),
            "the rectangle's edges vanish or are parallel; must have two directions");
  EXPECT_EQ(input_error([&] {
              rectangle({}, x, y, {1, 0}, right);
            }),
            "cells along edge_v: 0 is out of range; must be at least 1");
  EXPECT_EQ(input_error([&] { rectangle({}, x, y, {10000, 10000}, right); }), "more than 10 million cells; give fewer");
  EXPECT_EQ(input_error([&] {
              annulus({}, z, 2, 1, whole, {1, 8}, right);
            }),
            "the annulus has no width; its radii must be 0 < inner < outer");
  EXPECT_EQ(input_error([&] {
              annulus({}, {}, 1, 2, whole, {1, 8}, right);
            }),
            "the annulus has no normal; must be a direction");
  EXPECT_EQ(input_error([&] {
              annulus({}, z, 1, 2, whole, {1, 2}, right);
            }),
            "cells around: 2 is out of range; must be at least 3");
  EXPECT_EQ(input_error([&] {
              cylinder_skin({}, z, 1, {1, 1, false}, false, {1, 8}, right);
            }),
            "an angle from 1.000000 to 1.000000 rad; must be ascending, at most a whole turn");
  EXPECT_EQ(input_error([&] {
              cylinder_skin({}, z, 1, {0, 1, true}, false, {1, 8}, right);
            }),
            "a closed turn must be a whole one");
  EXPECT_EQ(input_error([&] {
              cylinder_skin({}, z, 1, slit, true, {1, 8}, right);
            }),
            "a sector of a cylinder has no caps; leave them out");
  EXPECT_EQ(input_error([&] {
              cylinder_skin(z, z, 1, whole, true, {1, 8}, right);
            }),
            "the cylinder has no length or radius; must be above 0");
  EXPECT_EQ(input_error([&] {
              ellipsoid_skin({}, {{1, 1, 1}}, 6);
            }),
            "cells around: 6 is out of range; must be a multiple of 4");
  EXPECT_EQ(input_error([&] { ellipsoid_skin({}, {{1, 0, 1}}, 8); }), "the ellipsoid's radii must be above 0");
}

}  // namespace
}  // namespace fascia::generate_test
