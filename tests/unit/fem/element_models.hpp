#pragma once

#include "fem/element_body.hpp"
#include "fem/generate.hpp"
#include "tests/support/law_constants.hpp"
#include "tests/support/models.hpp"

/// Small models of finite elements for tests.
namespace fascia::test {

struct ElementOptions {
  ElementShape shape = ElementShape::tet4;
  ElementFormulation formulation = ElementFormulation::large_strain;
  Law law = Law::st_venant_kirchhoff;
  ElementLocking locking = ElementLocking::none;
  double penalty = 0, stiffness_damping = 0, mass_damping = 0;
  double young = 1e4, poisson = 0.3, density = 1000;
  std::array<int, 3> cells{2, 2, 1};
  double distortion = 0.05;  ///< of inner and outer nodes alike [m]
  std::shared_ptr<const Viscosity> viscosity{};
  std::shared_ptr<const ActiveStress> active{};
};

/// A slab of 1 × 0.8 × 0.5 m whose nodes are moved at random.
inline ElementMesh distorted_mesh(const ElementOptions& o) {
  ElementMesh mesh = generate_box({}, {{1, 0.8, 0.5}}, o.cells, {family_of(o.shape), order_of(o.shape), 6});
  std::mt19937 random(5);
  for (Vec3d& x : mesh.nodes) x += random_vector(random, o.distortion * (order_of(o.shape) == 2 ? 0.5 : 1));
  return mesh;
}

struct ElementModel {
  Model model;
  std::unique_ptr<ElementBody> body;
};

inline ElementModel element_model(ElementBodySpec spec) {
  ElementModel built;
  PointSetBuilder points;
  built.body = std::make_unique<ElementBody>(std::move(spec), built.model, points);
  built.body->blocks = points.take_body();
  built.model.points = std::move(points).finish(built.model.frame_kind);
  return built;
}

inline ElementModel element_model(const ElementOptions& o, ElementMesh mesh) {
  ElementBodySpec spec;
  spec.mesh = std::move(mesh);
  spec.formulation = o.formulation;
  spec.locking = o.locking;
  spec.penalty = o.penalty;
  spec.density = o.density;
  const Lame lame = Lame::from_young(o.young, o.poisson);
  spec.material = [=](const Vec3d&, int) {
    return PointMaterialSpec{
        {lame, own_constants(o.law, lame.mu), o.viscosity, o.active}, o.mass_damping, o.stiffness_damping, o.law};
  };
  return element_model(std::move(spec));
}

inline ElementModel element_model(const ElementOptions& o) { return element_model(o, distorted_mesh(o)); }

}  // namespace fascia::test
