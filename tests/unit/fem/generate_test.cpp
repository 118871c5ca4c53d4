#include "fem/generate.hpp"

#include "tests/unit/fem/fem_samples.hpp"

#include <cmath>
#include <map>
#include <numbers>

namespace fascia::generate_test {
namespace {

using namespace samples;

constexpr double pi = std::numbers::pi;
const std::array<Vec3d, 8> tapered{
    {{{0, 0, 0}}, {{48, 44, 0}}, {{48, 60, 0}}, {{0, 44, 0}}, {{0, 0, 5}}, {{48, 44, 5}}, {{48, 60, 6}}, {{0, 44, 7}}}};

struct Named {
  std::string name;
  ElementMesh mesh;
};

std::vector<Named> every_mesh() {
  std::vector<Named> meshes;
  for (const ElementKind& kind : {hexahedra, hexahedra_2, tetrahedra, tetrahedra_2, by_five, by_five_2}) {
    const std::string name = std::to_string(node_count(element_shape(kind.family, kind.order))) + " nodes, split " +
                             std::to_string(kind.split) + ", ";
    meshes.push_back({name + "box", generate_box({{-1, 2, 0}}, {{2, 3, 1}}, {3, 2, 4}, kind)});
    meshes.push_back({name + "block", generate_block(tapered, {4, 3, 2}, kind)});
    if (kind.split == 5) continue;
    for (const int around : {4, 8, 12, 20})
      meshes.push_back({name + "cylinder " + std::to_string(around),
                        generate_cylinder({{0, 0, 1}}, {{0.3, 2, 0.5}}, 0.7, {3, around}, kind)});
    for (const int around : {4, 8, 12})
      meshes.push_back({name + "ellipsoid " + std::to_string(around),
                        generate_ellipsoid({{1, 2, 3}}, {{1, 0.6, 1.5}}, {around, around / 4}, kind)});
  }
  return meshes;
}

TEST(Generate, elements_have_volume_everywhere) {
  for (const auto& [name, mesh] : every_mesh()) {
    SCOPED_TRACE(name);
    for (std::size_t e = 0; e < mesh.size(); ++e) {
      EXPECT_GT(shape_at(mesh, e, reference_center(family_of(mesh.shape))).det_J, 0) << e;
      for (const Vec3d& xi : reference_corners(family_of(mesh.shape)))
        EXPECT_GT(shape_at(mesh, e, xi).det_J, 0) << "element " << e;
    }
  }
}

TEST(Generate, boundary_is_closed_and_every_inner_face_is_shared) {
  for (const auto& [name, mesh] : every_mesh()) {
    SCOPED_TRACE(name);
    const BoundaryFaces faces = boundary_faces(mesh);
    const TriangleMesh& s = faces.surface;
    EXPECT_EQ(faces.element.size(), s.triangles.size());
    EXPECT_EQ(faces.node.size(), s.points.size());
    // Two triangles at each edge, one in each direction, and Euler's formula: one closed surface without handles.
    std::map<std::array<int, 2>, int> edges;
    Vec3d area;
    double volume = 0;
    for (const auto& t : s.triangles) {
      for (std::size_t c = 0; c < 3; ++c) {
        const int a = t[c], b = t[(c + 1) % 3];
        edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : 100;
      }
      const Vec3d &a = s.points[at(t[0])], &b = s.points[at(t[1])], &c = s.points[at(t[2])];
      area += cross(b - a, c - a);
      volume += dot(a, cross(b, c)) / 6;
    }
    for (const auto& [edge, uses] : edges) EXPECT_EQ(uses, 101);
    EXPECT_EQ(2 * s.points.size() - s.triangles.size(), 4u);
    EXPECT_NEAR(norm(area), 0, 1e-10);
    const bool flat_faces = name.find("box") != std::string::npos || mesh.shape == ElementShape::tet4;
    EXPECT_NEAR(volume, volume_of(mesh), (flat_faces ? 1e-12 : 0.3) * volume);
  }
}

TEST(Generate, nodes_are_used_and_apart) {
  for (const auto& [name, mesh] : every_mesh()) {
    SCOPED_TRACE(name);
    std::vector<char> used(mesh.nodes.size(), 0);
    for (const int n : mesh.element_nodes) used[at(n)] = 1;
    EXPECT_EQ(std::count(used.begin(), used.end(), 0), 0);
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) EXPECT_GT(norm(mesh.nodes[i] - mesh.nodes[j]), 1e-3);
    EXPECT_EQ(mesh.node_number.size(), mesh.nodes.size());
    EXPECT_EQ(mesh.element_number.size(), mesh.size());
    EXPECT_EQ(mesh.node_number.back(), static_cast<std::int64_t>(mesh.nodes.size()));
  }
}

TEST(Generate, box_nodes_run_x_fastest_at_exact_places) {
  const ElementMesh mesh = generate_box({{0.1, 0, 0}}, {{0.4, 0.7, 1}}, {3, 7, 2}, hexahedra);
  ASSERT_EQ(mesh.nodes.size(), 4u * 8 * 3);
  EXPECT_EQ(mesh.nodes[1], (Vec3d{{0.1 + (0.4 - 0.1) * 1 / 3, 0, 0}}));
  EXPECT_EQ(mesh.nodes[3][0], 0.4);
  EXPECT_EQ(mesh.nodes[4], (Vec3d{{0.1, 0.7 * 1 / 7, 0}}));
  EXPECT_EQ(mesh.nodes[32], (Vec3d{{0.1, 0, 0.5}}));
  EXPECT_EQ(mesh.nodes.back(), (Vec3d{{0.4, 0.7, 1}}));
  EXPECT_EQ(generate_box({{0, 0, 0}}, {{1, 1, 1}}, {2, 1, 1}, tetrahedra).size(), 12u);
  EXPECT_EQ(generate_box({{0, 0, 0}}, {{1, 1, 1}}, {2, 1, 1}, by_five).size(), 10u);
}

TEST(Generate, box_volumes_are_exact) {
  for (const ElementKind& kind : {hexahedra, hexahedra_2, tetrahedra, tetrahedra_2, by_five, by_five_2})
    EXPECT_NEAR(volume_of(generate_box({{-1, 2, 0}}, {{2, 3, 1}}, {3, 2, 4}, kind)), 3, 1e-13);
}

TEST(Generate, six_tetrahedra_share_the_diagonal_of_their_box) {
  const ElementMesh mesh = generate_box({{0, 0, 0}}, {{1, 1, 1}}, {1, 1, 1}, tetrahedra);
  for (std::size_t e = 0; e < 6; ++e) {
    const auto nodes = mesh.element(e);
    EXPECT_EQ(std::count(nodes.begin(), nodes.end(), 0), 1);
    EXPECT_EQ(std::count(nodes.begin(), nodes.end(), 7), 1);
  }
}

TEST(Generate, volumes_of_round_solids_converge) {
  for (const ElementKind& kind : {hexahedra, hexahedra_2, tetrahedra, tetrahedra_2}) {
    const auto error = [&](int around) {
      const double cylinder = volume_of(generate_cylinder({{0, 0, 0}}, {{1, 2, 2}}, 0.5, {2, around}, kind));
      const double ellipsoid = volume_of(generate_ellipsoid({{0, 0, 0}}, {{1, 2, 0.5}}, {around, 2}, kind));
      return Vec3d{{std::abs(cylinder / (0.75 * pi) - 1), std::abs(ellipsoid / (4.0 / 3 * pi) - 1), 0}};
    };
    const Vec3d coarse = error(8), fine = error(16);
    const double rate = kind.order == 1 ? 3.5 : 10;
    for (int c = 0; c < 2; ++c) {
      EXPECT_GT(coarse[c] / fine[c], rate);
      EXPECT_LT(fine[c], kind.order == 1 ? 0.08 : 2e-3);
    }
  }
}

TEST(Generate, middle_nodes_lie_on_the_true_surface) {
  const Vec3d from{{0, 0, 1}}, to{{0, 3, 5}}, axis{{0, 0.6, 0.8}};
  for (const ElementKind& kind : {hexahedra_2, tetrahedra_2}) {
    const ElementMesh cylinder = generate_cylinder(from, to, 0.7, {3, 8}, kind);
    for (const Vec3d& X : boundary_faces(cylinder).surface.points) {
      const double height = dot(X - from, axis), radius = norm(X - from - axis * height);
      if (height > 1e-9 && height < 5 - 1e-9) {
        EXPECT_NEAR(radius, 0.7, 1e-12);
      }
    }
    const ElementMesh ball = generate_ellipsoid({{1, 0, 0}}, {{2, 1, 3}}, {8, 2}, kind);
    for (const Vec3d& X : boundary_faces(ball).surface.points)
      EXPECT_NEAR(norm(Vec3d{{(X[0] - 1) / 2, X[1], X[2] / 3}}), 1, 1e-12);
  }
}

TEST(Generate, wrong_input_is_refused) {
  const auto message = [](auto&& act) { return input_error(act); };
  const Vec3d o{}, e{{1, 1, 1}};
  expect_contains(message([&] { generate_box(e, o, {1, 1, 1}, hexahedra); }), "min must be below max");
  expect_contains(message([&] { generate_box(o, e, {1, 0, 1}, hexahedra); }), "cells along y: 0 is out of range");
  expect_contains(message([&] { generate_box(o, e, {1000, 1000, 1000}, hexahedra); }), "20 million");
  expect_contains(message([&] { generate_box(o, e, {1, 1, 1}, {ElementFamily::hexahedra, 3, 6}); }), "order 3");
  expect_contains(message([&] { generate_box(o, e, {1, 1, 1}, {ElementFamily::tetrahedra, 1, 4}); }), "5 or 6");
  expect_contains(message([&] { generate_cylinder(o, o, 1, {1, 4}, hexahedra); }), "ends coincide");
  expect_contains(message([&] { generate_cylinder(o, e, 0, {1, 4}, hexahedra); }), "radius must be above 0");
  expect_contains(message([&] { generate_cylinder(o, e, 1, {1, 6}, hexahedra); }), "multiple of 4");
  expect_contains(message([&] { generate_cylinder(o, e, 1, {1, 8}, by_five); }), "use 6");
  expect_contains(message([&] { generate_ellipsoid(o, e, {8, 0}, hexahedra); }), "layers of cells: 0");
  expect_contains(message([&] { generate_ellipsoid(o, {{1, -1, 1}}, {8, 1}, hexahedra); }), "radius along y");
  std::array<Vec3d, 8> corners = tapered;
  std::swap(corners[1], corners[3]);
  expect_contains(message([&] { generate_block(corners, {1, 1, 1}, hexahedra); }), "wrong way round");
}

}  // namespace
}  // namespace fascia::generate_test
