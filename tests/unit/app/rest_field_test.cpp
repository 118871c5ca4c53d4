// The fields of a .vtu as functions of the rest position, and the places at which two of them are compared.
#include "app/compare/body_pair.hpp"
#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "tests/unit/io/volume_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fascia::app::rest_field_test {
namespace {

using io::VisualMesh;
using samples::row_of_cubes;

constexpr double kVolume = 3;  // of row_of_cubes(3)

void add_rest_positions(VisualMesh& mesh) {
  io::FieldArray rest{"rest_position", 3, {}};
  for (const Vec3d& x : mesh.points) rest.values.insert(rest.values.end(), x.v, x.v + 3);
  mesh.point_fields = {rest};
}

VisualMesh cubes(CellType type, bool quadratic) {
  VisualMesh mesh = row_of_cubes(3, type, quadratic);
  mesh.part.clear();
  add_rest_positions(mesh);
  return mesh;
}

/// The box [0, 3] × [0, 1] × [0, 1] as a meshless body shows it: corners of the surface, a frame far away, and
/// integration points.
VisualMesh cloud() {
  VisualMesh mesh;
  for (int k = 0; k < 8; ++k) mesh.points.push_back({{3.0 * (k & 1), 1.0 * (k >> 1 & 1), 1.0 * (k >> 2)}});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  mesh.part.assign(mesh.triangles.size(), 0);
  const auto add = [&](const Vec3d& X, int part) {
    mesh.vertices.push_back(static_cast<int>(mesh.points.size()));
    mesh.points.push_back(X);
    mesh.part.push_back(part);
  };
  add({{9, 9, 9}}, 1);
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) add({{(i + 0.5) / 3, (j + 0.5) / 3, (k + 0.5) / 3}}, 2);
  add_rest_positions(mesh);
  return mesh;
}

VisualMesh square(double height) {
  VisualMesh mesh;
  mesh.points = {{{0, 0, height}}, {{1, 0, height}}, {{1, 1, height}}, {{0, 1, height}}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  add_rest_positions(mesh);
  return mesh;
}

double linear(const Vec3d& x) { return 1 + 2 * x[0] - x[1] + 3 * x[2]; }

double value(const VisualMesh& mesh, const Stencil& s) {
  double sum = 0;
  for (std::size_t k = 0; k < s.points.size(); ++k) sum += s.weights[k] * linear(mesh.points[at(s.points[k])]);
  return sum;
}

TEST(RestField, OfElementsIsThatOfTheirShapeFunctions) {
  for (const CellType type : {CellType::tetrahedron, CellType::hexahedron})
    for (const bool quadratic : {false, true}) {
      const VisualMesh mesh = cubes(type, quadratic);
      const auto field = rest_field(mesh, kVolume);
      const Vec3d X{{1.3, 0.2, 0.7}};
      const Stencil s = field->stencil_at(X);
      EXPECT_EQ(s.distance, 0);
      EXPECT_NEAR(value(mesh, s), linear(X), 1e-12);
      const Stencil beside = field->stencil_at({{3.25, 0.5, 0.5}});
      EXPECT_NEAR(beside.distance, 0.25, 1e-9);
      EXPECT_NEAR(value(mesh, beside), linear({{3, 0.5, 0.5}}), 1e-8);
    }
}

TEST(RestField, SamplesFillTheBody) {
  for (const VisualMesh& mesh : {cubes(CellType::tetrahedron, false), cubes(CellType::tetrahedron, true),
                                 cubes(CellType::hexahedron, false), cubes(CellType::hexahedron, true), cloud()}) {
    double volume = 0, squares = 0;
    for (const Sample& s : rest_field(mesh, kVolume)->samples()) {
      EXPECT_NEAR(value(mesh, s.stencil), linear(s.X), 1e-9);
      volume += s.weight;
      squares += s.weight * s.X[0] * s.X[0];
    }
    EXPECT_NEAR(volume, kVolume, 1e-12);
    EXPECT_NEAR(squares, 9, 1e-11);  // ∫ x² dV: linear fields are squared exactly
  }
}

TEST(RestField, OfAMeshlessBodyLeavesFramesOut) {
  const VisualMesh mesh = cloud();
  const auto field = rest_field(mesh, kVolume);
  EXPECT_EQ(field->dimension(), 3);
  EXPECT_NEAR(field->size(), std::sqrt(11.0), 1e-12);
  for (const Sample& s : field->samples())
    for (const int point : s.stencil.points) EXPECT_NE(point, 8);
  EXPECT_NEAR(field->stencil_at({{3.1, 0.5, 0.5}}).distance, 0.1, 1e-12);
  for (const Stencil& check : field->checks()) EXPECT_NEAR(value(mesh, check), 0, 1e-9);
}

/// The matter of a closed sheet is thin: it is sampled on its surface.
TEST(RestField, OfAClosedSheetIsASurface) {
  const auto field = rest_field(cloud(), 0.1);
  EXPECT_EQ(field->dimension(), 2);
  double area = 0;
  for (const Sample& s : field->samples()) area += s.weight;
  EXPECT_NEAR(area, 14, 1e-12);
}

TEST(RestField, OfTrianglesIsLinear) {
  const VisualMesh mesh = square(0);
  const auto field = rest_field(mesh, 0);
  const Stencil s = field->stencil_at({{0.25, 0.5, 0.125}});
  EXPECT_NEAR(s.distance, 0.125, 1e-15);
  EXPECT_NEAR(value(mesh, s), linear({{0.25, 0.5, 0}}), 1e-14);
}

TEST(RestField, RefusesWhatHoldsNoRestPositions) {
  VisualMesh mesh = square(0);
  mesh.point_fields.clear();
  EXPECT_THROW(rest_field(mesh, 0), InputError);
}

TEST(PairBodies, KnowsTheSameMesh) {
  const VisualMesh mesh = cubes(CellType::hexahedron, false);
  const BodyPair pair = pair_bodies(mesh, kVolume, mesh, kVolume);
  EXPECT_TRUE(pair.same_mesh);
  for (const SharedPlace& place : pair.places) EXPECT_EQ(place.a.points, place.b.points);
}

TEST(PairBodies, SamplesWhatHasCellsAndWhatIsThin) {
  const VisualMesh solid = cubes(CellType::tetrahedron, false), points = cloud(), sheet = square(0.5);
  EXPECT_EQ(pair_bodies(points, kVolume, solid, kVolume).sampled, 1);
  EXPECT_EQ(pair_bodies(solid, kVolume, points, kVolume).sampled, 0);
  const BodyPair pair = pair_bodies(solid, kVolume, sheet, 0.01);
  EXPECT_EQ(pair.sampled, 1);
  EXPECT_NEAR(pair.measure, 1, 1e-14);
  for (const SharedPlace& place : pair.places) {
    EXPECT_NEAR(value(solid, place.a), linear(place.X), 1e-12);
    EXPECT_NEAR(value(sheet, place.b), linear(place.X), 1e-12);
  }
}

TEST(PairBodies, TellsWhatLiesBesideTheOther) {
  const BodyPair near = pair_bodies(square(0), 0.01, square(0.01), 0.01);
  EXPECT_DOUBLE_EQ(near.beside, 1);
  EXPECT_NEAR(near.farthest, 0.01, 1e-15);
  EXPECT_EQ(near.left_out, 0);
  const BodyPair far = pair_bodies(square(0), 0.01, square(0.1), 0.01);
  EXPECT_DOUBLE_EQ(far.left_out, 1);
  EXPECT_TRUE(far.places.empty());
}

}  // namespace
}  // namespace fascia::app::rest_field_test
