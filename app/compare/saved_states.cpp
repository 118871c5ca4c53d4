#include "app/compare/saved_states.hpp"

#include "app/compare/arrays.hpp"
#include "core/base/errors.hpp"
#include "io/result_reader.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace fascia::app {
namespace {

void mix(std::vector<double>& values, const std::vector<double>& others, double fraction) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += fraction * (others[i] - values[i]);
}

}  // namespace

SavedStates::SavedStates(const std::filesystem::path& directory, const nlohmann::ordered_json& summary) {
  const std::filesystem::path pvd = collection_of(directory, summary);
  if (pvd.empty()) return;
  for (const io::CollectionEntry& entry : io::read_collection(pvd)) {
    if (std::find(bodies_.begin(), bodies_.end(), entry.body) == bodies_.end()) bodies_.push_back(entry.body);
    if (files_.empty() || entry.time != times_.back() || files_.back().contains(entry.body)) {
      times_.push_back(entry.time);
      files_.emplace_back();
    }
    files_.back()[entry.body] = directory / entry.file;
  }
  // A run that was killed may have listed a part of the bodies of its last state.
  while (!files_.empty() && files_.back().size() < bodies_.size()) {
    files_.pop_back();
    times_.pop_back();
  }
}

bool SavedStates::has(const std::string& body) const {
  return std::find(bodies_.begin(), bodies_.end(), body) != bodies_.end();
}

std::shared_ptr<const io::VisualMesh> SavedStates::state(const std::string& body, std::size_t index) {
  auto& recent = recent_[body];
  for (const auto& [kept, mesh] : recent)
    if (kept == index) return mesh;
  const auto file = files_.at(index).find(body);
  if (file == files_[index].end())
    throw InputError(fmt::format("\"{}\" has no state at the time {:.6g}; its .pvd is damaged", body, times_[index]));
  auto mesh = std::make_shared<const io::VisualMesh>(io::read_vtu(file->second));
  if (recent.size() == 2) recent.erase(recent.begin());
  recent.emplace_back(index, mesh);
  return mesh;
}

std::shared_ptr<const io::VisualMesh> SavedStates::at(const std::string& body, const TimePlace& time) {
  auto below = state(body, time.below);
  if (time.fraction == 0 || time.above == time.below) return below;
  const auto above = state(body, time.above);
  auto mixed = std::make_shared<io::VisualMesh>(*below);
  const auto same_array = [](const io::FieldArray& x, const io::FieldArray& y) {
    return x.name == y.name && x.values.size() == y.values.size();
  };
  if (below->points.size() != above->points.size() ||
      !std::equal(below->point_fields.begin(), below->point_fields.end(), above->point_fields.begin(),
                  above->point_fields.end(), same_array))
    throw InputError(
        fmt::format("\"{}\" has other points at {:.6g} than at {:.6g}", body, times_[time.below], times_[time.above]));
  for (std::size_t p = 0; p < mixed->points.size(); ++p)
    mixed->points[p] += time.fraction * (above->points[p] - mixed->points[p]);
  for (std::size_t f = 0; f < mixed->point_fields.size(); ++f)
    mix(mixed->point_fields[f].values, above->point_fields[f].values, time.fraction);
  return mixed;
}

}  // namespace fascia::app
