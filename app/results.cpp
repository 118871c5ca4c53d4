#include "app/results.hpp"

#include "core/math/index.hpp"
#include "core/math/rotation.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

namespace fascia::app {

namespace {

using Clock = std::chrono::steady_clock;

/// What the fields of a .vtu are made of, at one point.
struct PointValue {
  Vec3d rest{}, u{}, rotation{};
  Mat3d axes = Mat3d::identity();
  PointTensors tensors{};
};

double von_mises(const Mat3d& s) {
  const double a = s(0, 0) - s(1, 1), b = s(1, 1) - s(2, 2), c = s(2, 2) - s(0, 0);
  const double shear = s(0, 1) * s(0, 1) + s(1, 2) * s(1, 2) + s(0, 2) * s(0, 2);
  return std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * shear);
}

/// Of the integration points, and their averages at the nodes (weighted with w v): the averages are smooth, which the
/// field's own gradient is not across the faces of cells.
struct BodyTensors {
  std::vector<PointTensors> points, nodes;
};

void add_share(PointTensors& sum, const PointTensors& t, double share) {
  sum.strain += t.strain * share;
  sum.stress += t.stress * share;
  sum.energy_density += t.energy_density * share;
}

BodyTensors tensors(const ModelBody& body, const State& state) {
  BodyTensors t{body.tensors(state), std::vector<PointTensors>(at(body.node_count()))};
  std::vector<double> weight(t.nodes.size());
  for (std::size_t q = 0; q < body.points().size(); ++q) {
    const Attachment a = body.attach_point(q);
    for (std::size_t k = 0; k < a.nodes.size(); ++k) {
      const double share = body.points()[q].volume * std::max(a.influences[k].w, 1e-3);
      const std::size_t node = at(a.nodes[k] - body.first_node());
      weight[node] += share;
      add_share(t.nodes[node], t.points[q], share);
    }
  }
  for (std::size_t i = 0; i < t.nodes.size(); ++i) {
    PointTensors mean;
    add_share(mean, t.nodes[i], 1 / weight[i]);
    t.nodes[i] = mean;
  }
  return t;
}

/// Means over the points of each cell, weighted with volume.
std::vector<PointTensors> cell_means(const ModelBody& body, const std::vector<PointTensors>& points) {
  std::vector<PointTensors> cells(body.cells().nodes.size() / at(body.cells().nodes_per_cell));
  std::vector<double> volume(cells.size());
  for (std::size_t q = 0; q < points.size(); ++q) volume[at(body.points()[q].cell)] += body.points()[q].volume;
  for (std::size_t q = 0; q < points.size(); ++q) {
    const std::size_t cell = at(body.points()[q].cell);
    add_share(cells[cell], points[q], body.points()[q].volume / volume[cell]);
  }
  return cells;
}

void add_fields(std::vector<io::FieldArray>& fields, const std::vector<PointValue>& values,
                const std::vector<std::string>& names) {
  const auto add = [&](const char* name, int components, const auto& fill) {
    io::FieldArray array{name, components, {}};
    array.values.reserve(values.size() * at(components));
    for (const PointValue& v : values) fill(v, array.values);
    fields.push_back(std::move(array));
  };
  const auto push = [](std::vector<double>& out, const Vec3d& v) { out.insert(out.end(), v.v, v.v + 3); };
  const auto push_matrix = [&](std::vector<double>& out, const Mat3d& m) {
    for (int i = 0; i < 3; ++i) push(out, m.row(i));
  };
  for (const std::string& name : names) {
    if (name == "rest_position") add("rest_position", 3, [&](const PointValue& v, auto& out) { push(out, v.rest); });
    if (name == "displacement") add("displacement", 3, [&](const PointValue& v, auto& out) { push(out, v.u); });
    if (name == "rotation") {
      add("rotation", 3, [&](const PointValue& v, auto& out) { push(out, v.rotation); });
      for (int a = 0; a < 3; ++a) {
        const std::string axis = std::string("axis_") + "xyz"[a];
        add(axis.c_str(), 3, [&](const PointValue& v, auto& out) { push(out, v.axes.column(a)); });
      }
    }
    if (name == "strain") add("strain", 9, [&](const PointValue& v, auto& out) { push_matrix(out, v.tensors.strain); });
    if (name == "stress") add("stress", 9, [&](const PointValue& v, auto& out) { push_matrix(out, v.tensors.stress); });
    if (name == "von_mises")
      add("von_mises", 1, [&](const PointValue& v, auto& out) { out.push_back(von_mises(v.tensors.stress)); });
    if (name == "energy_density")
      add("energy_density", 1, [&](const PointValue& v, auto& out) { out.push_back(v.tensors.energy_density); });
  }
}

}  // namespace

ResultFiles::ResultFiles(const Simulation& simulation, std::filesystem::path directory, std::string name)
    : simulation_(simulation),
      directory_(std::move(directory)),
      name_(std::move(name)),
      last_(simulation.probes.size()) {
  csv_ = "time";
  for (const ResolvedProbe& p : simulation.probes)
    for (const std::string& column : probe_columns(p)) csv_ += "," + column;
  csv_ += "\n";
  for (const SimulatedBody& b : simulation.bodies) {
    surface_.emplace_back();
    if (b.groups() != nullptr) continue;  // a mesh is written as it is
    for (std::size_t i = 0; i < b.body->surface().points.size(); ++i)
      surface_.back().push_back(b.body->attach_surface(i));
  }
}

void ResultFiles::add_probes(double time, const Snapshot& snap) {
  csv_ += fmt::format("{}", time);
  for (std::size_t i = 0; i < simulation_.probes.size(); ++i) {
    last_[i] = probe_values(simulation_, simulation_.probes[i], snap);
    for (const double value : last_[i]) csv_ += std::isfinite(value) ? fmt::format(",{:.17g}", value) : ",";
  }
  csv_ += "\n";
}

/// Volume cells on the nodes, with tensors by cell and averaged at the nodes.
io::VisualMesh ResultFiles::visual_mesh(const SimulatedBody& b, const State& state) const {
  const ModelBody& body = *b.body;
  const BodyTensors t = tensors(body, state);
  std::vector<PointValue> values;
  io::VisualMesh mesh;
  for (std::size_t i = 0; i < b.nodes.size(); ++i) {
    values.push_back({b.nodes[i], state.u[at(body.first_node()) + i], {}, {}, t.nodes[i]});
    mesh.points.push_back(values.back().rest + values.back().u);
  }
  const BodyCells& cells = body.cells();
  const bool quadratic = cells.nodes_per_cell > node_count(cells.type);
  mesh.volumes.push_back({cells.type, quadratic, cells.nodes});
  std::vector<std::string> of_nodes{"rest_position"}, of_cells;
  for (const std::string& name : simulation_.scene.output.fields) {
    if (name == "rotation") continue;  // nodes have none
    of_nodes.push_back(name);
    if (name != "displacement") of_cells.push_back(name);
  }
  add_fields(mesh.point_fields, values, of_nodes);
  std::vector<PointValue> means;
  for (const PointTensors& mean : cell_means(body, t.points)) means.push_back({{}, {}, {}, {}, mean});
  add_fields(mesh.cell_fields, means, of_cells);
  return mesh;
}

io::VisualMesh ResultFiles::visual(const SimulatedBody& b, const State& state) const {
  if (b.groups() != nullptr) return visual_mesh(b, state);
  const ModelBody& body = *b.body;
  const BodyTensors t = tensors(body, state);
  const std::vector<Attachment>& surface = surface_[static_cast<std::size_t>(&b - simulation_.bodies.data())];
  std::vector<PointValue> values;
  const auto at_field = [&](const Vec3d& X, const Attachment& a) {
    const FieldValue f = field_at(a, state);
    const Mat3d D = polar_increment(f.D);
    return PointValue{X, f.u, rotation_vector(D), Mat3d::identity() + D, {}};
  };
  for (std::size_t i = 0; i < surface.size(); ++i) {
    PointValue v = at_field(body.surface().points[i], surface[i]);
    for (std::size_t k = 0; k < surface[i].nodes.size(); ++k) {
      const std::size_t frame = at(surface[i].nodes[k] - body.first_node());
      const double w = surface[i].influences[k].w;
      add_share(v.tensors, t.nodes[frame], w);
    }
    values.push_back(v);
  }
  for (int i = 0; i < body.node_count(); ++i) {
    const auto node = at(body.first_node() + i);
    const Mat3d turn =
        simulation_.model.frame_kind[node] == FrameKind::rigid ? state.D[node] : polar_increment(state.D[node]);
    values.push_back({b.nodes[at(i)], state.u[node], rotation_vector(turn),
                      (Mat3d::identity() + state.D[node]) * simulation_.model.rest_orientation[node], t.nodes[at(i)]});
  }
  for (std::size_t q = 0; q < body.points().size(); ++q) {
    PointValue v = at_field(body.points()[q].X, body.attach_point(q));
    v.tensors = t.points[q];
    values.push_back(v);
  }
  io::VisualMesh mesh;
  for (const PointValue& v : values) mesh.points.push_back(v.rest + v.u);
  mesh.triangles = body.surface().triangles;
  mesh.lines = body.segments();
  mesh.part.assign(mesh.triangles.size() + mesh.lines.size(), 0);
  for (std::size_t i = surface.size(); i < values.size(); ++i) {
    mesh.vertices.push_back(static_cast<int>(i));
    mesh.part.push_back(i < surface.size() + b.nodes.size() ? 1 : 2);
  }
  std::vector<std::string> names = simulation_.scene.output.fields;
  names.insert(names.begin(), "rest_position");
  add_fields(mesh.point_fields, values, names);
  return mesh;
}

void ResultFiles::add_state(double time, const State& state) {
  const Clock::time_point start = Clock::now();
  for (const SimulatedBody& body : simulation_.bodies) {
    const std::string file = fmt::format("{}_{:05d}.vtu", body.name, saved_);
    io::write_vtu(directory_ / file, visual(body, state));
    entries_.push_back({time, body.name, file});
  }
  ++saved_;
  seconds_ += std::chrono::duration<double>(Clock::now() - start).count();
}

void ResultFiles::finish() {
  io::write_pvd(directory_ / (name_ + ".pvd"), entries_);
  io::write_text(directory_ / "probes.csv", csv_);
}

}  // namespace fascia::app
