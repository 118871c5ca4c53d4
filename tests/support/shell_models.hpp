#pragma once

#include "core/physics/st_venant_kirchhoff.hpp"
#include "shells/shell_body.hpp"
#include "tests/support/models.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <random>

/// Small shells for tests.
namespace fascia::test {

enum class Diagonals { right, left, alternating };

struct PatchOptions {
  int nu = 4, nv = 4;
  Diagonals diagonals = Diagonals::right;
  double jitter = 0;  ///< of the nodes, in parts of a cell; those of an edge stay on it, corners stay
  bool closed_u = false;
};

using SurfaceMap = std::function<Vec3d(double, double)>;

/// The unit square by a map.
inline ShellMesh patch_mesh(const SurfaceMap& map, const PatchOptions& o) {
  ShellMesh mesh;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-o.jitter, o.jitter);
  const int columns = o.closed_u ? o.nu : o.nu + 1;
  for (int j = 0; j <= o.nv; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double du = uniform(random), dv = uniform(random);
      const bool inner_u = i > 0 && i<o.nu, inner_v = j> 0 && j < o.nv;
      mesh.nodes.push_back(map((i + (inner_u ? du : 0.0)) / o.nu, (j + (inner_v ? dv : 0.0)) / o.nv));
    }
  }
  for (int j = 0; j < o.nv; ++j) {
    for (int i = 0; i < o.nu; ++i) {
      const int a = i + columns * j, b = (i + 1) % columns + columns * j, c = b + columns, d = a + columns;
      const bool right = o.diagonals == Diagonals::right || (o.diagonals == Diagonals::alternating && (i + j) % 2 == 0);
      if (right) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
      } else {
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({b, c, d});
      }
    }
  }
  return mesh;
}

struct ShellMatter {
  double young = 1e4, poisson = 0.3, thickness = 0.05, density = 1000;
  double stiffness_damping = 0, mass_damping = 0;
  std::shared_ptr<const Viscosity> viscosity{};
};

struct ShellModel {
  Model model;
  std::unique_ptr<ShellBody> body;
};

inline ShellBodySpec shell_spec(ShellMesh mesh, const ShellMatter& m) {
  ShellBodySpec spec;
  const Lame lame = Lame::from_young(m.young, m.poisson);
  spec.thickness.assign(mesh.triangles.size(), m.thickness);
  spec.material.assign(mesh.triangles.size(), {{lame, {}, m.viscosity}, m.mass_damping, m.stiffness_damping});
  spec.density = m.density;
  spec.mesh = std::move(mesh);
  return spec;
}

inline ShellModel shell_model(ShellBodySpec spec) {
  ShellModel built;
  PointSetBuilder points;
  built.body = std::make_unique<ShellBody>(std::move(spec), built.model, points);
  built.model.points = std::move(points).finish(built.model.frame_kind);
  return built;
}

inline ShellModel shell_model(ShellMesh mesh, const ShellMatter& m) {
  return shell_model(shell_spec(std::move(mesh), m));
}

/// Holds directions of the frames that a test picks: a string of x y z and X Y Z (rotations about them).
template <class Pick>
void hold(Model& model, const Pick& pick, const std::string& what) {
  for (int i = 0; i < model.node_count(); ++i) {
    if (!pick(model.rest_position[at(i)])) continue;
    auto found = std::find_if(model.constraints.begin(), model.constraints.end(),
                              [&](const FrameConstraint& c) { return c.node >= i; });
    if (found == model.constraints.end() || found->node != i) {
      FrameConstraint c;
      c.node = i;
      found = model.constraints.insert(found, c);
    }
    // Axes along the world's: rows in order of what is held first.
    const auto extend = [](const char* names, const std::string& wanted, Mat3d& axes, int& count) {
      std::array<bool, 3> held{};
      for (int r = 0; r < count; ++r)
        for (std::size_t k = 0; k < 3; ++k) held[k] = held[k] || axes(r, static_cast<int>(k)) != 0;
      for (std::size_t k = 0; k < 3; ++k) held[k] = held[k] || wanted.find(names[k]) != std::string::npos;
      axes = {};
      count = 0;
      int row = 0;
      for (const bool first : {true, false})
        for (int k = 0; k < 3; ++k)
          if (held[at(k)] == first) {
            axes(row++, k) = 1;
            count += first ? 1 : 0;
          }
    };
    extend("xyz", what, found->translation_axes, found->translations);
    extend("XYZ", what, found->rotation_axes, found->rotations);
  }
}

inline int node_at(const Model& model, const Vec3d& X) {
  int best = 0;
  for (int i = 1; i < model.node_count(); ++i)
    if (norm(model.rest_position[at(i)] - X) < norm(model.rest_position[at(best)] - X)) best = i;
  return best;
}

inline void add_node_load(Model& model, int node, const Vec3d& force, const Vec3d& torque = {}) {
  DeadLoad load;
  load.nodes.push_back({node, force, {}, torque});
  model.loads.push_back(load);
}

/// A dead force per area of the middle surface.
inline void add_area_load(ShellModel& built, const Vec3d& traction) {
  DeadLoad load;
  for (int i = 0; i < built.model.node_count(); ++i) load.nodes.push_back({i, {}, {}, {}});
  for (const FacePoint& p : built.body->face_points())
    for (std::size_t k = 0; k < p.attachment.nodes.size(); ++k)
      load.nodes[at(p.attachment.nodes[k])].force += traction * (p.area * p.attachment.influences[k].w);
  built.model.loads.push_back(load);
}

/// Displacements under loads so small that they are linear, over their factor.
inline State small_response(const Model& model, double factor = 1e-6) {
  ThreadPool pool(1);
  SolverSettings settings;
  settings.linear = LinearMethod::cholesky;
  MechanicalSystem system(model, pool, settings);
  State state = State::at_rest(model);
  const RunReport report =
      run_statics(system, state, [&](double t) { return std::vector<double>(zero_factors(model).size(), t * factor); },
                  settings, {1}, {});
  EXPECT_EQ(report.status, RunStatus::converged) << report.message;
  for (Vec3d& u : state.u) u = u * (1 / factor);
  return state;
}

}  // namespace fascia::test
