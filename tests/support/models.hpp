#pragma once

#include "core/geometry/primitives.hpp"
#include "core/math/rotation.hpp"
#include "core/physics/st_venant_kirchhoff.hpp"
#include "core/run/drivers.hpp"
#include "core/structure/inertia.hpp"
#include "core/structure/model.hpp"
#include "meshless/cloud_build.hpp"
#include "meshless/grid_body.hpp"
#include "tests/support/law_constants.hpp"

#include <random>

/// Small models for tests.
namespace fascia::test {

struct BlockOptions {
  std::array<int, 3> grid{3, 3, 3};
  Vec3d size{{1, 1, 1}};
  double young = 1e4, poisson = 0.3;
  double density = 1000;
  GridWeightKind weights = GridWeightKind::trilinear;
  bool half_blend = true;
  double drilling = 0.1;  ///< of affine frames their own stabilisation
  bool affine = false;
  double stiffness_damping = 0, mass_damping = 0;
  IntegrationKind integration = IntegrationKind::automatic;
  Mat3d rotation = Mat3d::identity();
  Vec3d translation{};
  Law law = Law::st_venant_kirchhoff;
  std::shared_ptr<const Viscosity> viscosity{};
  std::shared_ptr<const ActiveStress> active{};
};

inline GridSpec block_spec(const BlockOptions& o) {
  GridSpec spec;
  spec.domain.max = o.size;
  spec.domain.volume = o.size[0] * o.size[1] * o.size[2];
  spec.grid = o.grid;
  spec.weights = o.weights;
  spec.half_blend = o.half_blend;
  spec.stabilization = o.drilling;
  spec.affine = o.affine;
  spec.integration = o.integration;
  spec.density = o.density;
  spec.rotation = o.rotation;
  spec.translation = o.translation;
  const Lame lame = Lame::from_young(o.young, o.poisson);
  spec.material = [=](const Vec3d&) {
    return PointMaterialSpec{
        {lame, own_constants(o.law, lame.mu), o.viscosity, o.active}, o.mass_damping, o.stiffness_damping, o.law};
  };
  return spec;
}

struct BuiltModel {
  Model model;
  std::vector<GridBody> bodies;
  std::vector<CloudBody> clouds;
};

inline BuiltModel build(const std::vector<GridSpec>& specs) {
  BuiltModel built;
  PointSetBuilder points;
  for (const GridSpec& spec : specs) {
    built.bodies.emplace_back(spec, built.model, points);
  }
  built.model.points = std::move(points).finish(built.model.frame_kind);
  return built;
}

/// A unit square of 2 cm or a unit line of 1 cm radius on a grid of frames.
inline CloudSpec thin_spec(const std::vector<int>& grid, const BlockOptions& o = {}) {
  CloudSpec spec;
  const GridSpec block = block_spec(o);
  static_cast<BodyMatter&>(spec) = block;
  ThinGridSpec thin;
  thin.parts.rotation = o.rotation;
  thin.parts.translation = o.translation;
  thin.grid.count = grid;
  thin.grid.edge = {Vec3d{{1, 0, 0}}};
  const double extent = grid.size() == 2 ? 0.02 : 0.01;
  thin.extent = [extent](const Vec3d&) { return extent; };
  if (grid.size() == 2) {
    thin.grid.edge.push_back({{0, 1, 0}});
    SheetPart sheet;
    sheet.surface.points = {{{0, 0, 0}}, {{1, 0, 0}}, {{1, 1, 0}}, {{0, 1, 0}}};
    sheet.surface.triangles = {{0, 1, 2}, {0, 2, 3}};
    sheet.thickness = {extent, extent};
    thin.parts.sheets.push_back(sheet);
  } else {
    thin.parts.lines.push_back({{{{0, 0, 0}}, {{1, 0, 0}}}, {{0, 1}}, extent});
  }
  grid_cloud(thin, spec);
  return spec;
}

inline BuiltModel build_cloud(const CloudSpec& spec) {
  BuiltModel built;
  PointSetBuilder points;
  built.clouds.emplace_back(spec, built.model, points);
  built.model.points = std::move(points).finish(built.model.frame_kind);
  return built;
}

/// A block filled with scattered frames.
inline CloudSpec scattered_spec(const BlockOptions& o, double spacing, int seed,
                                ScatteredKind weights = ScatteredKind::mls) {
  CloudSpec spec;
  const GridSpec block = block_spec(o);
  static_cast<BodyMatter&>(spec) = block;
  ScatterSpec scatter;
  scatter.parts.solid = block.domain;
  scatter.parts.solid->surface = box_surface({}, o.size, 8, 8, 8);
  scatter.parts.rotation = o.rotation;
  scatter.parts.translation = o.translation;
  scatter.frames = SpacedChoice{spacing, seed};
  scatter.weights = weights;
  std::vector<std::string> messages;
  scatter_cloud(scatter, spec, messages);
  return spec;
}

/// A block of trilinear hexahedra: vertices in place of frames, eight points a cell, lumped mass.
inline Model vertex_block(const BlockOptions& o = {}) {
  Model model;
  PointSetBuilder points;
  const Lame lame = Lame::from_young(o.young, o.poisson);
  const auto& n = o.grid;
  Vec3d cell;
  for (int k = 0; k < 3; ++k) cell[k] = o.size[k] / (n[at(k)] - 1);
  const double volume = cell[0] * cell[1] * cell[2] / 8;
  for (int z = 0; z < n[2]; ++z)
    for (int y = 0; y < n[1]; ++y)
      for (int x = 0; x < n[0]; ++x) model.rest_position.push_back({{x * cell[0], y * cell[1], z * cell[2]}});
  model.rest_orientation.assign(model.rest_position.size(), Mat3d::identity());
  model.frame_kind.assign(model.rest_position.size(), FrameKind::vertex);
  model.inertia.resize(model.rest_position.size());
  if (o.mass_damping > 0) model.mass_damping.resize(model.rest_position.size());
  for (int z = 0; z + 1 < n[2]; ++z)
    for (int y = 0; y + 1 < n[1]; ++y)
      for (int x = 0; x + 1 < n[0]; ++x) {
        std::vector<int> nodes;
        for (int c = 0; c < 8; ++c)
          nodes.push_back(x + (c & 1) + n[0] * (y + (c >> 1 & 1) + n[1] * (z + (c >> 2 & 1))));
        std::vector<PointSample> samples;
        for (int q = 0; q < 8; ++q) {
          PointSample p;
          p.volume = volume;
          p.lambda = lame.lambda;
          p.mu = lame.mu;
          p.stiffness_damping = o.stiffness_damping;
          double s[3];
          for (int k = 0; k < 3; ++k) s[k] = 0.5 + ((q >> k & 1) != 0 ? 0.5 : -0.5) / std::sqrt(3.0);
          p.X = model.rest_position[at(nodes[0])] + Vec3d{{s[0] * cell[0], s[1] * cell[1], s[2] * cell[2]}};
          for (int c = 0; c < 8; ++c) {
            double w[3], slope[3];
            for (int k = 0; k < 3; ++k) {
              const bool far = (c >> k & 1) != 0;
              w[k] = far ? s[k] : 1 - s[k];
              slope[k] = (far ? 1 : -1) / cell[k];
            }
            Influence influence;
            influence.w = w[0] * w[1] * w[2];
            influence.g = {{slope[0] * w[1] * w[2], w[0] * slope[1] * w[2], w[0] * w[1] * slope[2]}};
            p.influences.push_back(influence);
            model.inertia[at(nodes[at(c)])].mass += o.density * volume * influence.w;
            if (o.mass_damping > 0)
              model.mass_damping[at(nodes[at(c)])].mass += o.mass_damping * o.density * volume * influence.w;
          }
          samples.push_back(p);
        }
        points.add_points(nodes, samples, cell[0]);
      }
  model.points = std::move(points).finish(model.frame_kind);
  return model;
}

inline BuiltModel block(const BlockOptions& o = {}) { return build({block_spec(o)}); }

inline Vec3d random_vector(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> uniform(-size, size);
  return {{uniform(random), uniform(random), uniform(random)}};
}

/// Frames displaced by up to `displacement` and turned by up to about `rotation`.
inline State random_state(const Model& model, double displacement, double rotation, unsigned seed = 1) {
  std::mt19937 random(seed);
  State state = State::at_rest(model);
  for (Vec3d& u : state.u) u = random_vector(random, displacement);
  for (Mat3d& D : state.D) D = rotation_increment(random_vector(random, rotation));
  return state;
}

/// u ← u + s dx, Q ← exp(s dr) Q, A ← A + s dA.
inline State moved(const Model& model, const State& state, const std::vector<double>& direction, double s) {
  State r = state;
  for (std::size_t i = 0; i < r.u.size(); ++i) {
    const int node = static_cast<int>(i);
    const double* d = direction.data() + model.points.dofs.begin(node);
    r.u[i] += Vec3d{{d[0], d[1], d[2]}} * s;
    if (model.kind(node) == FrameKind::rigid)
      r.D[i] = compose_increments(rotation_increment(Vec3d{{d[3], d[4], d[5]}} * s), r.D[i]);
    else if (model.kind(node) == FrameKind::affine)
      r.D[i] += frame_variation(FrameKind::affine, d + 3, {}) * s;
  }
  return r;
}

inline std::vector<double> random_direction(const Model& model, unsigned seed = 2) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<double> d(static_cast<std::size_t>(model.dof_count()));
  for (double& v : d) v = uniform(random);
  return d;
}

inline double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

inline double norm(const std::vector<double>& a) { return std::sqrt(dot(a, a)); }

/// State in which every frame follows x → R x + t.
inline State rigid_state(const Model& model, const Mat3d& D, const Vec3d& t) {
  State state = State::at_rest(model);
  for (std::size_t i = 0; i < state.u.size(); ++i) {
    state.u[i] = D * model.rest_position[i] + t;
    state.D[i] = D;
  }
  return state;
}

/// At rest, moving as a rigid body: x' = v + spin × x.
inline State spinning_state(const Model& model, const Vec3d& spin, const Vec3d& v) {
  State state = State::at_rest(model);
  for (std::size_t i = 0; i < state.u.size(); ++i) {
    state.v[i] = v + cross(spin, model.rest_position[i]);
    if (model.frame_kind[i] != FrameKind::vertex) state.Q_dot[i] = skew(spin);
  }
  return state;
}

/// Momentum of all nodes, about the origin.
inline Momentum total_momentum(const Model& model, const State& state) {
  Momentum sum;
  for (std::size_t i = 0; i < state.u.size(); ++i) {
    const Momentum m = momentum_of(model.inertia[i], model.rest_position[i] + state.u[i],
                                   Mat3d::identity() + state.D[i], state.v[i], state.Q_dot[i], {});
    sum.linear += m.linear;
    sum.angular += m.angular;
    sum.kinetic_energy += m.kinetic_energy;
    sum.mass += m.mass;
    sum.first_moment += m.first_moment;
  }
  return sum;
}

/// Holds the nodes of the plane x = 0: the first so many directions (x, y, z), and rotations about z and y.
inline void hold_face(Model& model, int translations, int rotations) {
  for (int i = 0; i < model.node_count(); ++i) {
    if (std::abs(model.rest_position[at(i)][0]) > 1e-9) continue;
    FrameConstraint c;
    c.node = i;
    c.translations = translations;
    c.rotations = rotations;
    c.rotation_axes = Mat3d::from_columns({{0, 0, 1}}, {{0, 1, 0}}, {{-1, 0, 0}});
    model.constraints.push_back(c);
  }
}

/// Holds all of the frames of a plane.
inline void hold_face(Model& model, double x = 0) {
  for (int i = 0; i < model.node_count(); ++i) {
    if (std::abs(model.rest_position[static_cast<std::size_t>(i)][0] - x) > 1e-9) continue;
    FrameConstraint c;
    c.node = i;
    c.translations = c.rotations = 3;
    c.whole = true;
    model.constraints.push_back(c);
  }
}

inline void add_gravity(Model& model, const Vec3d& g) {
  DeadLoad load;
  for (int i = 0; i < model.node_count(); ++i) {
    const FrameInertia& inertia = model.inertia[static_cast<std::size_t>(i)];
    load.nodes.push_back({i, g * inertia.mass, outer(g, inertia.first), {}});
  }
  model.loads.push_back(load);
}

inline const FactorFunction kRamp = [](double t) { return std::vector<double>{t}; };
inline const FactorFunction kAlways = [](double) { return std::vector<double>{1.0}; };

}  // namespace fascia::test
