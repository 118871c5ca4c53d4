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
  Mat3d axes = Mat3d::identity(), strain{}, stress{};
  double energy_density = 0;
};

double von_mises(const Mat3d& s) {
  const double a = s(0, 0) - s(1, 1), b = s(1, 1) - s(2, 2), c = s(2, 2) - s(0, 0);
  const double shear = s(0, 1) * s(0, 1) + s(1, 2) * s(1, 2) + s(0, 2) * s(0, 2);
  return std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * shear);
}

/// Strain, stress and energy density at the integration points, and their averages at the frames (weighted with w v):
/// the averages are smooth, which the field's own gradient is not across the faces of cells.
struct Tensors {
  std::vector<Mat3d> strain, stress;
  std::vector<double> energy_density;
};

struct BodyTensors {
  Tensors points, frames;
};

BodyTensors tensors(const MeshlessBody& body, const State& state) {
  BodyTensors t;
  const auto n = at(body.frame_count());
  t.frames.strain.resize(n);
  t.frames.stress.resize(n);
  t.frames.energy_density.resize(n);
  std::vector<double> weight(n);
  for (std::size_t q = 0; q < body.points().size(); ++q) {
    const BodyPoint& p = body.points()[q];
    const Attachment a = body.attach_point(q);
    const Mat3d H = field_at(a, state).H, Hv = body.selective() ? field_at(body.attach_volumetric(a), state).H : H;
    const Mat3d E = green_strain(H), stress = cauchy_stress(H, Hv, p);
    const double tr = trace(green_strain(Hv));
    const double density =
        p.law == Law::solid ? 0.5 * p.lambda * tr * tr + p.mu * contract(E, E) : energy_density(stress_material(p), E);
    t.points.strain.push_back(E);
    t.points.stress.push_back(stress);
    t.points.energy_density.push_back(density);
    for (std::size_t k = 0; k < a.nodes.size(); ++k) {
      const double share = p.volume * std::max(a.influences[k].w, 1e-3);
      const std::size_t frame = at(a.nodes[k] - body.first_frame());
      weight[frame] += share;
      t.frames.strain[frame] += E * share;
      t.frames.stress[frame] += stress * share;
      t.frames.energy_density[frame] += density * share;
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    t.frames.strain[i] *= 1 / weight[i];
    t.frames.stress[i] *= 1 / weight[i];
    t.frames.energy_density[i] /= weight[i];
  }
  return t;
}

void add_fields(io::VisualMesh& mesh, const std::vector<PointValue>& values, const std::vector<std::string>& names) {
  const auto add = [&](const char* name, int components, const auto& fill) {
    io::FieldArray array{name, components, {}};
    array.values.reserve(values.size() * at(components));
    for (const PointValue& v : values) fill(v, array.values);
    mesh.point_fields.push_back(std::move(array));
  };
  const auto push = [](std::vector<double>& out, const Vec3d& v) { out.insert(out.end(), v.v, v.v + 3); };
  const auto push_matrix = [&](std::vector<double>& out, const Mat3d& m) {
    for (int i = 0; i < 3; ++i) push(out, m.row(i));
  };
  add("rest_position", 3, [&](const PointValue& v, auto& out) { push(out, v.rest); });
  for (const std::string& name : names) {
    if (name == "displacement") add("displacement", 3, [&](const PointValue& v, auto& out) { push(out, v.u); });
    if (name == "rotation") {
      add("rotation", 3, [&](const PointValue& v, auto& out) { push(out, v.rotation); });
      for (int a = 0; a < 3; ++a) {
        const std::string axis = std::string("axis_") + "xyz"[a];
        add(axis.c_str(), 3, [&](const PointValue& v, auto& out) { push(out, v.axes.column(a)); });
      }
    }
    if (name == "strain") add("strain", 9, [&](const PointValue& v, auto& out) { push_matrix(out, v.strain); });
    if (name == "stress") add("stress", 9, [&](const PointValue& v, auto& out) { push_matrix(out, v.stress); });
    if (name == "von_mises")
      add("von_mises", 1, [&](const PointValue& v, auto& out) { out.push_back(von_mises(v.stress)); });
    if (name == "energy_density")
      add("energy_density", 1, [&](const PointValue& v, auto& out) { out.push_back(v.energy_density); });
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
    for (const Vec3d& X : b.meshless->surface().points) surface_.back().push_back(b.meshless->attach(X));
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

io::VisualMesh ResultFiles::visual(const SimulatedBody& b, const State& state) const {
  const MeshlessBody& body = *b.meshless;
  const BodyTensors t = tensors(body, state);
  const std::vector<Attachment>& surface = surface_[static_cast<std::size_t>(&b - simulation_.bodies.data())];
  std::vector<PointValue> values;
  const auto at_field = [&](const Vec3d& X, const Attachment& a) {
    const FieldValue f = field_at(a, state);
    const Mat3d D = polar_increment(f.D);
    return PointValue{X, f.u, rotation_vector(D), Mat3d::identity() + D, {}, {}, 0};
  };
  for (std::size_t i = 0; i < surface.size(); ++i) {
    PointValue v = at_field(body.surface().points[i], surface[i]);
    for (std::size_t k = 0; k < surface[i].nodes.size(); ++k) {
      const std::size_t frame = at(surface[i].nodes[k] - body.first_frame());
      const double w = surface[i].influences[k].w;
      v.strain += t.frames.strain[frame] * w;
      v.stress += t.frames.stress[frame] * w;
      v.energy_density += t.frames.energy_density[frame] * w;
    }
    values.push_back(v);
  }
  for (int i = 0; i < body.frame_count(); ++i) {
    const auto node = at(body.first_frame() + i);
    const Mat3d turn =
        simulation_.model.frame_kind[node] == FrameKind::rigid ? state.D[node] : polar_increment(state.D[node]);
    values.push_back({b.frames[at(i)], state.u[node], rotation_vector(turn),
                      (Mat3d::identity() + state.D[node]) * simulation_.model.rest_orientation[node],
                      t.frames.strain[at(i)], t.frames.stress[at(i)], t.frames.energy_density[at(i)]});
  }
  for (std::size_t q = 0; q < body.points().size(); ++q) {
    PointValue v = at_field(body.points()[q].X, body.attach_point(q));
    v.strain = t.points.strain[q];
    v.stress = t.points.stress[q];
    v.energy_density = t.points.energy_density[q];
    values.push_back(v);
  }
  io::VisualMesh mesh;
  for (const PointValue& v : values) mesh.points.push_back(v.rest + v.u);
  mesh.triangles = body.surface().triangles;
  mesh.lines = body.segments();
  mesh.part.assign(mesh.triangles.size() + mesh.lines.size(), 0);
  for (std::size_t i = surface.size(); i < values.size(); ++i) {
    mesh.vertices.push_back(static_cast<int>(i));
    mesh.part.push_back(i < surface.size() + b.frames.size() ? 1 : 2);
  }
  add_fields(mesh, values, simulation_.scene.output.fields);
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
