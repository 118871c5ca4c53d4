#include "app/results/results.hpp"

#include "core/base/clock.hpp"
#include "core/base/errors.hpp"
#include "core/base/index.hpp"
#include "core/base/throwing_loops.hpp"
#include "core/math/rotation.hpp"
#include "core/physics/von_mises.hpp"
#include "io/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <string_view>
#include <type_traits>

namespace fascia::app {

namespace {

/// What the fields of a .vtu are made of, at one point.
struct PointValue {
  Vec3d rest{}, u{}, rotation{};
  Mat3d axes = Mat3d::identity();
};

/// Means over the points of each cell, weighted with volume.
std::vector<PointTensors> cell_means(const ModelBody& body, std::vector<PointTensors> points) {
  std::vector<PointTensors> cells(body.cells().nodes.size() / at(body.cells().nodes_per_cell));
  if (cells.size() == points.size()) return points;
  std::vector<double> volume(cells.size());
  for (std::size_t q = 0; q < points.size(); ++q) volume[at(body.points()[q].cell)] += body.points()[q].volume;
  for (std::size_t q = 0; q < points.size(); ++q) {
    const std::size_t cell = at(body.points()[q].cell);
    add_share(cells[cell], points[q], body.points()[q].volume / volume[cell]);
  }
  return cells;
}

constexpr int kGrain = 256;  // places

/// Calls act(i) for each of so many places, on all threads.
template <class Act>
void for_each_place(ThreadPool& pool, std::size_t count, const Act& act) {
  for_throwing_ranges(pool, static_cast<int>(count), kGrain, [&](int begin, int end) {
    for (std::size_t i = at(begin); i < at(end); ++i) act(i);
  });
}

/// Collects arrays of values of one place each.
class FieldWriter {
 public:
  FieldWriter(std::vector<io::FieldArray>& fields, std::size_t count, ThreadPool& pool)
      : fields_(fields), count_(count), pool_(pool) {}

  /// @param value  of a place: a number, a vector, or a matrix by rows
  template <class Value>
  void add(const std::string& name, const Value& value) {
    using T = decltype(value(std::size_t{0}));
    io::FieldArray array{name, std::is_same_v<T, double> ? 1 : std::is_same_v<T, Vec3d> ? 3 : 9, {}};
    array.values.resize(count_ * at(array.components));
    for_each_place(pool_, count_, [&](std::size_t i) { put(value(i), &array.values[i * at(array.components)]); });
    fields_.push_back(std::move(array));
  }

  /// One of the fields that follow from tensors; false for another name.
  bool add_tensor_field(const std::string& name, const std::vector<PointTensors>& t) {
    if (name == "strain") add(name, [&](std::size_t i) { return t[i].strain; });
    if (name == "stress") add(name, [&](std::size_t i) { return t[i].stress; });
    if (name == "von_mises") add(name, [&](std::size_t i) { return von_mises(t[i].stress); });
    if (name == "energy_density") add(name, [&](std::size_t i) { return t[i].energy_density; });
    return name == "strain" || name == "stress" || name == "von_mises" || name == "energy_density";
  }

 private:
  static void put(double v, double* out) { *out = v; }
  static void put(const Vec3d& v, double* out) { std::copy_n(v.v, 3, out); }
  static void put(const Mat3d& m, double* out) {
    for (int i = 0; i < 3; ++i) put(m.row(i), out + 3 * i);
  }

  std::vector<io::FieldArray>& fields_;
  std::size_t count_;
  ThreadPool& pool_;
};

/// Threads that write a state: those of the run, where it has so many places that they are worth waking.
int threads_for(const Simulation& s) {
  constexpr std::size_t kWorthwhile = 4096;
  std::size_t places = 0;
  for (const SimulatedBody& b : s.bodies)
    places += b.nodes.size() + b.body->points().size() + b.body->surface().points.size();
  return places < kWorthwhile ? 1 : s.scene.solver.threads;
}

bool asks_for(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Some field needs strains and stresses.
bool asks_for_tensors(const std::vector<std::string>& names) {
  return std::any_of(names.begin(), names.end(),
                     [](const std::string& name) { return name != "displacement" && name != "rotation"; });
}

void set_units(std::vector<io::FieldArray>& fields) {
  for (io::FieldArray& field : fields)
    if (const std::string unit = io::name_of_field(field.name).unit; unit != "1") field.unit = unit;
}

}  // namespace

ResultFiles::ResultFiles(const Simulation& simulation, std::filesystem::path directory, std::string name,
                         std::string provenance)
    : simulation_(simulation),
      directory_(std::move(directory)),
      name_(std::move(name)),
      provenance_(std::move(provenance)),
      pool_(threads_for(simulation)),
      last_(simulation.probes.size()),
      recovery_(simulation.bodies.size()) {
  for (const SimulatedBody& b : simulation.bodies) {
    surface_.emplace_back();
    if (b.groups() != nullptr) continue;  // a mesh is written as it is
    for (std::size_t i = 0; i < b.body->surface().points.size(); ++i)
      surface_.back().push_back(b.body->attach_surface(i));
  }
}

void ResultFiles::open() {
  std::string head = "time";
  for (const ResolvedProbe& p : simulation_.probes)
    for (const std::string& column : probe_columns(p)) head += "," + column;
  head += tells_time_step() ? ",time_step\n" : "\n";
  csv_.emplace(directory_ / "probes.csv", head);
}

void ResultFiles::add_probes(double time, const ProbeValues& values, double time_step) {
  std::string row = fmt::format("{}", time);
  last_ = values;
  for (const std::vector<double>& of_probe : last_)
    for (const double value : of_probe) row += fmt::format(",{:.17g}", value);
  if (tells_time_step()) row += fmt::format(",{:.17g}", time_step);
  csv_->append(row + "\n");
}

bool ResultFiles::tells_time_step() const { return simulation_.scene.solver.time_step_automatic; }

/// What is recovered at the nodes is smooth, which the field's own gradient is not across the faces of cells.
ResultFiles::BodyTensors ResultFiles::tensors(const SimulatedBody& b, const State& state) {
  std::optional<NodalRecovery>& recovery = recovery_[static_cast<std::size_t>(&b - simulation_.bodies.data())];
  if (!recovery) recovery.emplace(b);
  std::vector<PointTensors> points = b.body->tensors(state, pool_);
  std::vector<PointTensors> nodes = recovery->at_nodes(points, pool_);
  return {std::move(points), std::move(nodes)};
}

/// Cells on the nodes, with tensors by cell and recovered at the nodes.
io::VisualMesh ResultFiles::visual_mesh(const SimulatedBody& b, const State& state) {
  const ModelBody& body = *b.body;
  const auto first = at(body.first_node());
  io::VisualMesh mesh;
  for (std::size_t i = 0; i < b.nodes.size(); ++i) mesh.points.push_back(b.nodes[i] + state.u[first + i]);
  const BodyCells& cells = body.cells();
  mesh.volumes.push_back({cells.type, cells.nodes_per_cell > node_count(cells.type), cells.nodes});
  const std::vector<std::string>& names = simulation_.scene.output.fields;
  FieldWriter of_nodes(mesh.point_fields, b.nodes.size(), pool_);
  of_nodes.add("rest_position", [&](std::size_t i) { return b.nodes[i]; });
  const bool tensor_fields = asks_for_tensors(names);
  BodyTensors t = tensor_fields ? tensors(b, state) : BodyTensors{};
  const std::vector<PointTensors> means =
      tensor_fields ? cell_means(body, std::move(t.points)) : std::vector<PointTensors>{};
  FieldWriter of_cells(mesh.cell_fields, means.size(), pool_);
  std::vector<BodyField> fields = tensor_fields ? body.own_fields(state) : std::vector<BodyField>{};
  for (const std::string& name : names) {
    if (name == "displacement") of_nodes.add(name, [&](std::size_t i) { return state.u[first + i]; });
    if (name == "rotation" && !b.vertices)
      of_nodes.add(name, [&](std::size_t i) { return rotation_vector(state.D[first + i]); });
    const bool own = std::any_of(fields.begin(), fields.end(), [&](const BodyField& f) { return f.name == name; });
    if (tensor_fields && !own && of_nodes.add_tensor_field(name, t.nodes)) of_cells.add_tensor_field(name, means);
  }
  const auto wanted = [&](const std::string& field) {
    return asks_for(names, field == "to_outer_face" ? "director" : field);
  };
  for (BodyField& f : fields) {
    if (!wanted(f.name)) continue;
    (f.of_cells ? mesh.cell_fields : mesh.point_fields).push_back({f.name, f.components, std::move(f.values)});
  }
  return mesh;
}

/// The surface or lines that a meshless body carries, its frames and its points.
io::VisualMesh ResultFiles::visual(const SimulatedBody& b, const State& state) {
  if (b.groups() != nullptr) return visual_mesh(b, state);
  const ModelBody& body = *b.body;
  const std::vector<std::string>& names = simulation_.scene.output.fields;
  const bool turns = asks_for(names, "rotation"), tensor_fields = asks_for_tensors(names);
  const BodyTensors t = tensor_fields ? tensors(b, state) : BodyTensors{};
  const std::vector<Attachment>& surface = surface_[static_cast<std::size_t>(&b - simulation_.bodies.data())];
  const std::size_t first_point = surface.size() + b.nodes.size();
  std::vector<PointValue> values(first_point + body.points().size());
  std::vector<PointTensors> tensors_of_values(tensor_fields ? values.size() : 0);
  const auto value_at = [&](const Vec3d& X, const Attachment& a) -> PointValue {
    const FieldValue f = field_at(a, state);
    const Mat3d D = turns ? polar_increment(f.D) : Mat3d{};
    return {X, f.u, turns ? rotation_vector(D) : Vec3d{}, Mat3d::identity() + D};
  };
  for_each_place(pool_, surface.size(), [&](std::size_t i) {
    values[i] = value_at(body.surface().points[i], surface[i]);
    for (std::size_t k = 0; tensor_fields && k < surface[i].nodes.size(); ++k)
      add_share(tensors_of_values[i], t.nodes[b.index_of(surface[i].nodes[k])], surface[i].influences[k].w);
  });
  for_each_place(pool_, b.nodes.size(), [&](std::size_t i) {
    const std::size_t node = at(b.node_ids[i]);
    const bool rigid = simulation_.model.frame_kind[node] == FrameKind::rigid;
    const Mat3d turn = rigid || !turns ? state.D[node] : polar_increment(state.D[node]);
    values[surface.size() + i] = {b.nodes[i], state.u[node], turns ? rotation_vector(turn) : Vec3d{},
                                  (Mat3d::identity() + state.D[node]) * simulation_.model.rest_orientation[node]};
    if (tensor_fields) tensors_of_values[surface.size() + i] = t.nodes[i];
  });
  for_each_place(pool_, body.points().size(), [&](std::size_t q) {
    values[first_point + q] = value_at(body.points()[q].X, body.attach_point(q));
    if (tensor_fields) tensors_of_values[first_point + q] = t.points[q];
  });
  io::VisualMesh mesh;
  mesh.points.resize(values.size());
  for_each_place(pool_, values.size(), [&](std::size_t i) { mesh.points[i] = values[i].rest + values[i].u; });
  mesh.triangles = body.surface().triangles;
  mesh.lines = body.segments();
  mesh.part.assign(mesh.triangles.size() + mesh.lines.size(), 0);
  for (std::size_t i = surface.size(); i < values.size(); ++i) {
    mesh.vertices.push_back(static_cast<int>(i));
    mesh.part.push_back(i < first_point ? 1 : 2);
  }
  FieldWriter fields(mesh.point_fields, values.size(), pool_);
  fields.add("rest_position", [&](std::size_t i) { return values[i].rest; });
  for (const std::string& name : names) {
    if (name == "displacement") fields.add(name, [&](std::size_t i) { return values[i].u; });
    if (name == "rotation") {
      fields.add(name, [&](std::size_t i) { return values[i].rotation; });
      for (int a = 0; a < 3; ++a)
        fields.add(std::string("axis_") + "xyz"[a], [&, a](std::size_t i) { return values[i].axes.column(a); });
    }
    fields.add_tensor_field(name, tensors_of_values);
  }
  return mesh;
}

std::string state_file(const SimulatedBody& body, std::size_t state) {
  return fmt::format("{}_{:05d}.vtu", body.name, state);
}

io::VisualMesh ResultFiles::state_mesh(const SimulatedBody& body, const State& state, double time) {
  io::VisualMesh mesh = visual(body, state);
  set_units(mesh.point_fields);
  set_units(mesh.cell_fields);
  mesh.time = time;
  mesh.provenance = provenance_;
  return mesh;
}

void ResultFiles::add_state(double time, const State& state) {
  const Clock::time_point start = Clock::now();
  std::vector<std::string> files;
  try {
    for (const SimulatedBody& body : simulation_.bodies) {
      files.push_back(state_file(body, times_.size()));
      io::write_vtu(directory_ / files.back(), state_mesh(body, state, time), &pool_);
    }
  } catch (const std::exception&) {  // the bodies that are there are no whole state
    std::error_code ignored;
    for (const std::string& file : files) std::filesystem::remove(directory_ / file, ignored);
    throw;
  }
  if (!collection_) collection_.emplace(directory_ / (name_ + ".pvd"));
  for (std::size_t b = 0; b < files.size(); ++b) collection_->add(time, simulation_.bodies[b].name, files[b]);
  times_.push_back(state.time);
  seconds_ += seconds_since(start);
}

double ResultFiles::estimated_size(const State& state) {
  constexpr double kPacked = 0.5;  // of the provenance: compressed, in base 64
  double size = kPacked * static_cast<double>(provenance_.size() * simulation_.bodies.size());
  for (const SimulatedBody& body : simulation_.bodies) size += io::estimated_size(visual(body, state));
  return size;
}

void ResultFiles::synchronise() const {
  csv_->synchronise();
  if (collection_) collection_->synchronise();
}

}  // namespace fascia::app
