#pragma once

#include "core/executor/executor.hpp"
#include "tests/unit/fem/element_models.hpp"

#include <array>
#include <memory>

/// Bodies with surfaces for tests of surface loads.
namespace fascia::test {

/// A model of one body.
struct Loaded {
  Model model;
  std::shared_ptr<ModelBody> body;
};

inline Loaded elements(ElementShape shape) {
  ElementOptions o;
  o.shape = shape;
  ElementModel built = element_model(o);
  return {std::move(built.model), std::shared_ptr<ModelBody>(std::move(built.body))};
}

/// @param cells  of the surface along x, y, z
inline Loaded frames(bool affine, const std::array<int, 3>& cells) {
  BlockOptions o;
  o.grid = {3, 2, 2};
  o.affine = affine;
  GridSpec spec = block_spec(o);
  spec.domain.surface = box_surface({}, o.size, cells[0], cells[1], cells[2]);
  Loaded built;
  PointSetBuilder points;
  built.body = std::make_shared<GridBody>(spec, built.model, points);
  built.model.points = std::move(points).finish(built.model.frame_kind);
  return built;
}

/// Frames of which each point of the body follows four, as do the vertices of its surface.
inline Loaded scattered() {
  CloudSpec spec;
  static_cast<BodyMatter&>(spec) = block_spec({});
  ScatterSpec scatter;
  scatter.parts.solid = block_spec({}).domain;
  scatter.parts.solid->surface = box_surface({}, {{1, 1, 1}}, 3, 3, 3);
  scatter.frames = SpacedChoice{0.3, 1};
  scatter.weights = ScatteredKind::shepard;
  scatter.neighbours = 4;
  std::vector<std::string> messages;
  scatter_cloud(scatter, spec, messages);
  Loaded built;
  PointSetBuilder points;
  built.body = std::make_shared<CloudBody>(spec, built.model, points);
  built.model.points = std::move(points).finish(built.model.frame_kind);
  return built;
}

/// Adds the forces of surface loads. @return  their potential
inline double add_surface_forces(Surfaces<PoolSpace>& loads, const Model& model, const State& state,
                                 const std::vector<double>& factors, std::vector<double>& out) {
  loads.add_forces(nodes_of(model.points), {state.u.data(), state.D.data()}, factors.data(), out.data());
  return loads.potential({loads.figures(), loads.figure_count()});
}

/// Adds the tangent of surface loads at their last forces, in a model without dependent nodes.
inline void add_surface_tangent(Surfaces<PoolSpace>& loads, const Model& model, const std::vector<double>& factors,
                                Linearization& lin) {
  SurfaceTangent<PoolSpace>& tangent = lin.loads.surface;
  lin.loads.surfaces = &loads;
  loads.linearize(nodes_of(model.points), lin.Q.data(), factors.data(), lin.tangent, tangent, lin.node_blocks.data());
  for (int t = 0; t < loads.terms(); ++t) {
    const double* g = tangent.volume_gradient(t);
    lin.loads.volumes.push_back({tangent.stiffness.data()[t], std::vector<double>(g, g + model.dof_count())});
  }
}

}  // namespace fascia::test
