#include "app/diagnosis/failure.hpp"
#include "app/results/results.hpp"
#include "app/results/run_result.hpp"
#include "core/base/index.hpp"
#include "io/result_directory.hpp"

#include <algorithm>
#include <cmath>

namespace fascia::app {

namespace {

/// A file holds finite numbers only; what is none reads 0, and is suspect.
void clear_infinite(std::vector<io::FieldArray>& fields) {
  for (io::FieldArray& field : fields)
    for (double& value : field.values)
      if (!std::isfinite(value)) value = 0;
}

/// Takes, from the points of each cell, the least volume, and whether one is suspect. Cells of what has no matter,
/// rigid bodies and surfaces, have no points: they keep their volume.
void add_marks_of_cells(const SimulatedBody& b, const FailureMarks& m, io::VisualMesh& mesh) {
  const std::size_t count = mesh.volumes[0].size();
  std::vector<double> volume(count, INFINITY), suspect(count, 0.0);
  for (std::size_t q = 0; q < m.suspect.size(); ++q) {
    const auto cell = at(b.body->points()[q].cell);
    volume[cell] = std::min(volume[cell], m.volume[q]);
    suspect[cell] = std::max(suspect[cell], static_cast<double>(m.suspect[q]));
  }
  std::replace(volume.begin(), volume.end(), static_cast<double>(INFINITY), 1.0);
  mesh.cell_fields.push_back({"suspect", 1, std::move(suspect)});
  mesh.cell_fields.push_back({"volume_ratio", 1, std::move(volume)});
  mesh.point_fields.push_back({"failure_share", 1, m.share});
}

/// Points of the file: those of the surface, then the frames, then the integration points.
void add_marks_of_points(const FailureMarks& m, io::VisualMesh& mesh) {
  const std::size_t count = mesh.points.size(), first = count - m.suspect.size(), frames = first - m.share.size();
  std::vector<double> suspect(count, 0.0), volume(count, 1.0), share(count, 0.0);
  std::copy(m.share.begin(), m.share.end(), share.begin() + static_cast<std::ptrdiff_t>(frames));
  for (std::size_t q = 0; q < m.suspect.size(); ++q) {
    suspect[first + q] = m.suspect[q];
    volume[first + q] = m.volume[q];
  }
  mesh.point_fields.push_back({"suspect", 1, std::move(suspect)});
  mesh.point_fields.push_back({"volume_ratio", 1, std::move(volume)});
  mesh.point_fields.push_back({"failure_share", 1, std::move(share)});
}

}  // namespace

std::vector<std::string> ResultFiles::add_failed(const Failure& failure) {
  std::vector<std::string> files;
  for (std::size_t index = 0; index < simulation_.bodies.size(); ++index) {
    const SimulatedBody& b = simulation_.bodies[index];
    io::VisualMesh mesh = state_mesh(b, failure.state, failure.state.time);
    clear_infinite(mesh.point_fields);
    clear_infinite(mesh.cell_fields);
    if (b.groups() != nullptr)
      add_marks_of_cells(b, failure.marks[index], mesh);
    else
      add_marks_of_points(failure.marks[index], mesh);
    files.push_back(io::failed_state_file(b.name));
    io::write_vtu(directory_ / files.back(), mesh);
  }
  return files;
}

nlohmann::ordered_json keep_failed(const Simulation& s, const State& end, bool unshown, RunReport& run,
                                   RunResult& files) {
  if (unshown || run.status == RunStatus::inverted)
    run.failed = std::make_shared<FailedState>(FailedState{end, {}, run.steps});
  if (!run.failed) return nullptr;
  Failure failure = find_failure(s, *run.failed, unshown ? s.initial : end);
  if (!failure.text.empty()) run.message += "; " + failure.text;
  const std::size_t good = files.times().size();
  failure.summary["last_good"] = nlohmann::json::array();
  for (const SimulatedBody& b : s.bodies)
    if (good > 0) failure.summary["last_good"].push_back(state_file(b, good - 1));
  failure.summary["failed"] = files.add_failed(failure);
  return failure.summary;
}

}  // namespace fascia::app
