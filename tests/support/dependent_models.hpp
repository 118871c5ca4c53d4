#pragma once

#include "fem/element_body.hpp"
#include "fem/generate.hpp"
#include "shells/shell_body.hpp"
#include "tests/support/models.hpp"
#include "tests/support/shell_models.hpp"

#include <memory>
#include <string>
#include <utility>
#include <vector>

/// Small models in which nodes depend on others, for tests.
namespace fascia::test {

class CoupledModel {
 public:
  Model model;
  PointSetBuilder points;
  std::vector<std::unique_ptr<ModelBody>> bodies;

  /// A body; its nodes are those from the first returned number to before the second.
  template <class Body, class Spec>
  std::pair<int, int> add(Spec spec) {
    const int first = model.node_count();
    bodies.push_back(std::make_unique<Body>(std::move(spec), model, points));
    return {first, model.node_count()};
  }

  std::pair<int, int> add_tetrahedra(const Vec3d& corner, const Vec3d& size, std::array<int, 3> cells,
                                     double stiffness_damping = 0, double mass_damping = 0) {
    ElementBodySpec spec;
    spec.mesh = generate_box({}, size, cells, {ElementFamily::tetrahedra, 1, 6});
    std::mt19937 random(5);
    for (Vec3d& x : spec.mesh.nodes) x += corner + random_vector(random, 0.02);
    spec.density = 1000;
    const Lame lame = Lame::from_young(2e4, 0.3);
    spec.material = [=](const Vec3d&, int) { return PointMaterialSpec{{lame}, mass_damping, stiffness_damping}; };
    return add<ElementBody>(std::move(spec));
  }

  std::pair<int, int> add_grid(bool affine, double stiffness_damping = 0, double mass_damping = 0) {
    BlockOptions o;
    o.grid = {3, 2, 2};
    o.affine = affine;
    o.stiffness_damping = stiffness_damping;
    o.mass_damping = mass_damping;
    if (affine) o.drilling = 0.003;
    return add<GridBody>(block_spec(o));
  }

  /// Bent, 1 × 0.6 m.
  std::pair<int, int> add_shell(const Vec3d& corner) {
    PatchOptions o;
    o.nu = 4;
    o.nv = 2;
    o.jitter = 0.1;
    const ShellMesh mesh = patch_mesh(
        [&](double s, double t) {
          return corner + Vec3d{{0.8 * s, 0.6 * t, 0.1 * s * s + 0.05 * t}};
        },
        o);
    return add<ShellBody>(shell_spec(mesh, {}));
  }

  /// A rigid frame alone. @param mass  of a ball about it with a radius of 0.2 m
  int add_frame(const Vec3d& X, double mass) {
    const int node = model.node_count();
    model.rest_position.push_back(X);
    model.rest_orientation.push_back(Mat3d::identity());
    model.frame_kind.push_back(FrameKind::rigid);
    model.inertia.push_back({mass, {}, Mat3d::diagonal(mass * 0.2 * 0.2 / 5)});
    if (!model.mass_damping.empty()) model.mass_damping.resize(model.inertia.size());
    points.join({node}, 0.4);
    return node;
  }

  void weld(int node, int frame) {
    const Vec3d arm = model.rest_position[at(node)] - model.rest_position[at(frame)];
    points.add_dependent({node, {frame}, {1.0}, {arm}, model.kind(node) == FrameKind::rigid});
  }

  /// In the field of a body, at the node's place; off a surface, with an arm to the nearest place on it.
  /// @param turns  with the first of several hosts
  void embed(int node, const ModelBody& body, bool turns = false) {
    const Attachment place = body.attach(model.rest_position[at(node)]);
    DependentNode d{node, place.nodes, {}, {}, turns};
    Vec3d arm = model.rest_position[at(node)];
    for (std::size_t k = 0; k < place.nodes.size(); ++k)
      arm -= model.rest_position[at(place.nodes[k])] * place.influences[k].w + place.influences[k].b;
    for (const Influence& influence : place.influences) {
      d.w.push_back(influence.w);
      d.b.push_back(influence.b + arm * influence.w);
    }
    points.add_dependent(std::move(d));
  }

  void finish() {
    if (!model.mass_damping.empty()) model.mass_damping.resize(model.inertia.size());
    model.points = std::move(points).finish(model.frame_kind);
  }
};

/// Every way to depend, by name. Inertia is where it was built.
inline std::unique_ptr<CoupledModel> coupled_model(const std::string& name, double stiffness_damping = 0,
                                                   double mass_damping = 0) {
  auto built = std::make_unique<CoupledModel>();
  CoupledModel& m = *built;
  if (name == "tetrahedra on a frame") {
    const auto [first, last] = m.add_tetrahedra({}, {{1, 0.6, 0.5}}, {3, 2, 1}, stiffness_damping, mass_damping);
    const int frame = m.add_frame({{-0.3, 0.4, 0.1}}, 30);
    for (int i = first; i < last; ++i)
      if (m.model.rest_position[at(i)][0] < 0.1) m.weld(i, frame);
  } else if (name.starts_with("tetrahedra in")) {
    // Those of the lower half stick in the host.
    if (name.ends_with("tetrahedra"))
      m.add_tetrahedra({}, {{1, 1, 1}}, {1, 1, 1}, stiffness_damping, mass_damping);
    else
      m.add_grid(name.ends_with("affine grid"), stiffness_damping, mass_damping);
    const auto [first, last] =
        m.add_tetrahedra({{0.3, 0.2, 0.5}}, {{0.4, 0.5, 0.9}}, {1, 1, 3}, stiffness_damping, mass_damping);
    for (int i = first; i < last; ++i)
      if (m.model.rest_position[at(i)][2] < 0.9) m.embed(i, *m.bodies[0]);
  } else if (name == "shell on a frame") {
    const auto [first, last] = m.add_shell({});
    const int frame = m.add_frame({{-0.3, 0.4, 0.1}}, 5);
    for (int i = first; i < last; ++i)
      if (m.model.rest_position[at(i)][0] < 0.1) m.weld(i, frame);
  } else if (name.starts_with("shell in") || name.starts_with("shell turned")) {
    m.add_grid(name.ends_with("affine grid"), stiffness_damping, mass_damping);
    const auto [first, last] = m.add_shell({{0.6, 0.2, 0.5}});
    for (int i = first; i < last; ++i)
      if (m.model.rest_position[at(i)][0] < 0.95) m.embed(i, *m.bodies[0], name.starts_with("shell turned"));
  } else {  // chain: tetrahedra in a shell whose edge is on a frame
    const auto [shell, tetrahedra] = m.add_shell({});
    const auto [first, last] = m.add_tetrahedra({{0.1, 0.2, 0.02}}, {{0.4, 0.3, 0.5}}, {2, 1, 2});
    const int frame = m.add_frame({{-0.3, 0.4, 0.1}}, 5);
    for (int i = first; i < last; ++i)
      if (m.model.rest_position[at(i)][2] < 0.2) m.embed(i, *m.bodies[0]);
    for (int i = shell; i < tetrahedra; ++i)
      if (m.model.rest_position[at(i)][0] < 0.25) m.weld(i, frame);
  }
  m.finish();
  return built;
}

inline const std::vector<std::string> kWaysToDepend{"tetrahedra on a frame",
                                                    "tetrahedra in a rigid grid",
                                                    "tetrahedra in an affine grid",
                                                    "tetrahedra in tetrahedra",
                                                    "shell on a frame",
                                                    "shell in a rigid grid",
                                                    "shell in an affine grid",
                                                    "shell turned by a rigid grid",
                                                    "chain"};

}  // namespace fascia::test
