#pragma once

#include "fem/element_body.hpp"
#include "fem/generate.hpp"
#include "tests/support/models.hpp"

#include <memory>

/// A unit block at x > 0 that shares nodes with a host at x < 0.
namespace fascia::test {

enum class HostKind { frames, turning, still, rigid };

struct HostOptions {
  HostKind kind = HostKind::frames;
  int cells = 2;          ///< of the host along each edge
  bool averaged = false;  ///< tetrahedra with averages about nodes
  double damping = 0;     ///< stiffness damping of tetrahedra [s]
  bool all = false;       ///< all of the host's nodes are shared, not only those of the common face
};

struct SharedModel {
  Model model;
  std::shared_ptr<ModelBody> host, body;
  std::vector<SharedFrame> shared;
  std::vector<FrameInertia> before;  ///< of the host alone
  std::vector<std::string> messages;
  PointSetBuilder points;

  void finish() { model.points = std::move(points).finish(model.frame_kind); }
};

inline void add_host(SharedModel& s, const HostOptions& o) {
  const Vec3d min{{-1, 0, 0}}, max{{0, 1, 1}};
  if (o.kind == HostKind::rigid) {
    s.model.rest_position.push_back({{-0.4, 0.6, 0.5}});
    s.model.rest_orientation.push_back(Mat3d::identity());
    s.model.frame_kind.push_back(FrameKind::rigid);
    s.model.inertia.push_back({2, {{0.1, 0, -0.2}}, Mat3d::diagonal(0.5)});
    for (int k = 0; k <= o.cells; ++k)
      for (int j = 0; j <= o.cells; ++j) {
        const Vec3d x{{0, 1.0 * j / o.cells, 1.0 * k / o.cells}};
        s.shared.push_back({0, x, x - s.model.rest_position[0], true});
      }
  } else if (o.kind == HostKind::frames) {
    BlockOptions block;
    block.grid = {o.cells + 1, o.cells + 1, o.cells + 1};
    block.translation = min;
    s.host = std::make_shared<GridBody>(block_spec(block), s.model, s.points);
  } else {
    ElementBodySpec spec;
    spec.mesh = generate_box(min, max, {o.cells, o.cells, o.cells}, {family_of(ElementShape::tet4), 1, 6});
    spec.locking = o.averaged ? ElementLocking::averaged : ElementLocking::none;
    spec.density = 1000;
    const Lame lame = Lame::from_young(1e4, o.averaged ? 0.49 : 0.3);
    spec.material = [lame, o](const Vec3d&, int) { return PointMaterialSpec{{lame}, 0, o.damping, Law::neo_hookean}; };
    s.host = std::make_shared<ElementBody>(std::move(spec), s.model, s.points);
  }
  s.before = s.model.inertia;
  if (o.kind == HostKind::rigid) return;
  for (int i = 0; i < s.model.node_count(); ++i) {
    const Vec3d& x = s.model.rest_position[at(i)];
    if (!o.all && std::abs(x[0]) > 1e-12) continue;
    s.shared.push_back({i, x, {}, o.kind != HostKind::still});
    if (o.kind == HostKind::turning) s.model.frame_kind[at(i)] = FrameKind::rigid;
  }
}

inline ScatterSpec unit_scatter(const SampleChoice& frames, ScatteredKind weights = ScatteredKind::mls) {
  ScatterSpec scatter;
  scatter.parts.solid = block_spec({}).domain;
  scatter.parts.solid->surface = box_surface({}, {{1, 1, 1}}, 8, 8, 8);
  scatter.frames = frames;
  scatter.weights = weights;
  return scatter;
}

inline void add_cloud(SharedModel& s, ScatterSpec scatter, const BlockOptions& o = {}) {
  CloudSpec spec;
  static_cast<BodyMatter&>(spec) = block_spec(o);
  scatter.shared = s.shared;
  scatter_cloud(scatter, spec, s.messages);
  s.body = std::make_shared<CloudBody>(spec, s.model, s.points);
}

inline void add_grid(SharedModel& s, const BlockOptions& o = {}) {
  GridSpec spec = block_spec(o);
  spec.shared = s.shared;
  s.body = std::make_shared<GridBody>(spec, s.model, s.points);
}

}  // namespace fascia::test
