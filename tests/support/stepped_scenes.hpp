#pragma once

#include "fascia/stepper.hpp"
#include "gpu/run/device_functions.hpp"

#include <cstring>
#include <string>
#include <vector>

/// Small scenes as a program describes them, and the GPU's steps on the processor.
namespace fascia::test {

/// A block of 4 x 4 x 8 cm of frames on a foot that a driver moves.
inline Scene driven_block(SolverKind kind) {
  Body block;
  block.name = "block";
  block.domain = BoxDomain{{{0, 0, 0}}, {{0.04, 0.04, 0.08}}};
  block.frames = GridFrames{{3, 3, 4}};
  block.density = 1000;
  Material tissue = elastic(20e3, 0.4);
  tissue.mass_damping = 2;
  tissue.stiffness_damping = 2e-3;
  block.materials = {{{}, tissue}};
  Constraint foot;
  foot.body = "block";
  foot.where = in_box({{-1, -1, -1e-3}}, {{1, 1, 1e-3}});
  foot.fixed.fill(true);
  foot.driver = "foot";
  Probe top;
  top.name = "top";
  top.body = "block";
  top.quantity = Quantity::position;
  top.at = {Vec3d{{0.02, 0.02, 0.08}}};
  Probe force;
  force.name = "force";
  force.body = "block";
  force.quantity = Quantity::force;
  force.where = foot.where;
  Scene scene;
  scene.world.gravity = {{0, 0, -9.81}};
  scene.bodies = {block};
  scene.constraints = {foot};
  scene.solver.kind = kind;
  scene.solver.time_step = 0.01;
  scene.probes = {top, force};
  return scene;
}

/// That block, of tetrahedra.
inline Scene driven_tetrahedra(SolverKind kind) {
  Scene scene = driven_block(kind);
  Body& block = scene.bodies[0];
  block.model = BodyModel::tetrahedra;
  block.cells = MeshCells{{2, 2, 4}};
  return scene;
}

inline std::vector<double> copied(const Rows& rows) {
  return {rows.data, rows.data + static_cast<std::ptrdiff_t>(rows.rows) * rows.columns};
}
inline bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

/// Has the space of the host stand for a device.
inline void take_host_as_device() {
  static const gpu::DeviceFunctions functions{"test",
                                              "the space of the host",
                                              [](int, std::string&) { return std::vector<int>{0}; },
                                              gpu::run_statics_on_host,
                                              gpu::run_implicit_on_host,
                                              gpu::run_explicit_on_host,
                                              gpu::make_stepper_on_host,
                                              gpu::evaluate_on_host};
  gpu::use_device_functions(functions);
}

}  // namespace fascia::test
